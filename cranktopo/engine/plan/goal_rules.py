"""What a goal asks of the plan: the load cases that it and its limits are read off, and no others."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from cranktopo.base.errors import invalid
from cranktopo.design.goal.limit import Goal
from cranktopo.design.goal.quantities import QUANTITIES
from cranktopo.engine.load_case import LoadKind
from cranktopo.engine.plan.context import PlanningContext
from cranktopo.engine.plan.cost import Cost
from cranktopo.engine.plan.estimate import Estimate

_NEGLIGIBLE = 1e-9
"""Unbalance over mass times throw radius that is nothing but rounding."""


def as_wanted(estimate: Estimate, goal: Goal, kind: LoadKind) -> Estimate:
    """Return the estimate of a load case whose need a goal decides, not its size."""
    users = [f"{goal.sense} {goal.quantity}"] if QUANTITIES[goal.quantity].load_case == kind else []
    users += [str(limit) for limit in goal.limits if QUANTITIES[limit.quantity].load_case == kind]
    if not users:
        return replace(estimate, changes="nothing", absent="neither goal nor limits need it", needed="")
    needed = f"the goal needs it: {', '.join(users)}"
    changes = f"{', '.join(users)} cannot be told"
    return replace(estimate, changes=changes, absent="", needed=needed, indispensable=needed)


def wants_safety(goal: Goal | None) -> str:
    """Why the goal needs the fatigue safety; empty when it does not."""
    if goal is None:
        return ""
    limits = [str(limit) for limit in goal.limits_of("fatigue_safety")]
    users = [f"{goal.sense} {goal.quantity}"] if goal.quantity == "fatigue_safety" else limits
    return f"the goal needs it: {', '.join(users)}" if users else ""


def bound(context: PlanningContext) -> Estimate:
    """Return what no web of the envelope can beat: wanted beside every result that it can be told of."""
    absent = "the scene has no [envelope]" if context.scene.envelope is None else ""
    if context.goal is not None and context.goal.quantity == "fatigue_safety":
        absent = "nothing is proven about stress"
    return Estimate(
        None,
        "",
        "how far a result is from the best possible web",
        Cost() if absent else context.costing.bound(),
        absent=absent,
        needed="" if absent else "it tells when to stop",
        impossible=absent,
    )


def check_goal_cases(context: PlanningContext, goal: Goal, cases: Collection[str]) -> None:
    """Check that a load case is on and that no limit is in percent of nothing.

    Raises:
        CranktopoError: no stiffness is asked for, or the original is balanced.
    """
    if not cases:
        raise invalid(
            f"goal.{goal.sense}",
            goal.quantity,
            "no load case is on: neither goal nor limits speak of a stiffness",
            "Limit torsion or bending.",
        )
    original = context.balance.throw_unbalance_kg_mm
    size = context.balance.mass_kg * context.scene.throw.radius_mm
    for limit in goal.limits_of("unbalance"):
        if limit.percent and original < _NEGLIGIBLE * size:
            raise invalid(
                "goal.limits.unbalance",
                limit.condition,
                f"percent of the original's unbalance, which is {original:.3g} kg mm",
                "Give the limit in kg mm.",
            )
