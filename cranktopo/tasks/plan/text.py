"""The effects plan as text for the terminal."""

from __future__ import annotations

from cranktopo.engine.plan.effect import PhysicsPlan
from cranktopo.report.result_table import text_table


def plan_text(plan: PhysicsPlan) -> str:
    """Return one row per effect: state, estimate, cost, reason, and what leaving it out changes."""
    rows = []
    for effect in plan.effects:
        size = "-" if effect.estimate_percent is None else f"{effect.estimate_percent:.3g} %"
        rows.append([effect.name, effect.state, size, str(effect.cost), effect.reason, effect.changes])
    header = ("effect", "state", "size", "costs", "because", "leaving it out changes")
    return text_table("llrlll", header, rows)
