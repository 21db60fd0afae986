"""A goal in words, with what each optimiser makes of it."""

from __future__ import annotations

from cranktopo.design.goal.limit import Goal, Limit
from cranktopo.design.goal.quantities import QUANTITIES, Optimiser


def goal_text(goal: Goal, optimiser: Optimiser) -> str:
    """What is wanted, in a line or two: the goal, its limits, and those left to the evaluation."""
    most = "least" if goal.sense == "minimise" else "largest"
    kept = [limit for limit in goal.limits if optimiser in QUANTITIES[limit.quantity].optimisers]
    left = [limit for limit in goal.limits if limit not in kept]
    lines = [f"goal: {most} {QUANTITIES[goal.quantity].label}; {_listed(kept) or 'no limits'}"]
    if left:
        lines.append(f"not known to the {optimiser} optimisation, left to the evaluation: {_listed(left)}")
    return "\n".join(lines)


def _listed(limits: list[Limit]) -> str:
    """Limits in one phrase; percent is explained once."""
    text = ", ".join(str(limit) for limit in limits)
    return f"{text} (% of the original web)" if any(limit.percent for limit in limits) else text
