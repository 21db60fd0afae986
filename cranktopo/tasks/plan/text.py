"""The effects plan as text for the terminal."""

from __future__ import annotations

from collections.abc import Sequence

from cranktopo.bodies.cells.outside import outside_words
from cranktopo.design.goal.limit import goal_text
from cranktopo.design.goal.scene_goal import goal_of
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.effect import Effect
from cranktopo.report.result_table import text_table
from cranktopo.tasks.plan.result import DesignPlan


def plan_text(design_plan: DesignPlan, scene: Scene) -> str:
    """Return threshold, goal, what evaluations it takes and what lies outside; then the effects."""
    goal, todo = goal_of(scene), design_plan.evaluations
    lines = [f"{design_plan.design}, threshold {100 * scene.effects.threshold:g} %"]
    if goal is not None:
        lines.append(goal_text(goal, "density"))
    if todo.number:
        lines.append(
            f"limits by the evaluation: about {todo.number} evaluations of original and surfaces, "
            f"+{todo.seconds:.0f} s"
        )
    if words := outside_words(design_plan.outside_envelope):
        lines.append(words)
    return "\n".join([*lines, "", _effects_text(design_plan.effects)])


def _effects_text(effects: Sequence[Effect]) -> str:
    """Return one row per effect: state, estimate, cost, reason, and what leaving it out changes."""
    rows = []
    for effect in effects:
        size = "-" if effect.estimate_percent is None else f"{effect.estimate_percent:.3g} %"
        rows.append([effect.name, effect.state, size, str(effect.cost), effect.reason, effect.changes])
    header = ("effect", "state", "size", "costs", "because", "leaving it out changes")
    return text_table("llrlll", header, rows)
