"""The physics plan of a design, with its goal and what it leaves out; nothing is solved."""

from __future__ import annotations

from cranktopo.bodies.cells.outside import outside_envelope
from cranktopo.design.assumed import ENVELOPE, GOAL, LOADS, SUPPORTS, THROW, VIBRATION, assumptions
from cranktopo.design.checks.engine import shaft_warnings
from cranktopo.design.goal.outcome import stated_goal
from cranktopo.design.goal.scene_goal import goal_of
from cranktopo.design.opened_fillets import bore_remarks
from cranktopo.design.schema import Scene
from cranktopo.design.strength import strength_remarks
from cranktopo.engine.performance import pressure_warnings
from cranktopo.engine.plan.cost import effort
from cranktopo.engine.plan.planning import plan
from cranktopo.engine.vibration.end_chain import tip_remarks
from cranktopo.tasks.plan.result import DesignPlan, PlannedEvaluations


def design_plan(scene: Scene) -> DesignPlan:
    """Return the effects of a design by closed forms, with what each would cost."""
    goal, todo = goal_of(scene), effort(scene)
    return DesignPlan(
        design=scene.name,
        goal=None if goal is None else stated_goal(goal),
        effects=plan(scene, goal=goal).effects,
        evaluations=PlannedEvaluations(number=todo.evaluations, seconds=todo.evaluation_seconds),
        outside_envelope=outside_envelope(scene),
        assumed=assumptions(scene, (THROW, LOADS, VIBRATION, SUPPORTS, ENVELOPE, GOAL)),
    )


def plan_warnings(scene: Scene) -> list[str]:
    """Return what a user should know of material, bores, pressure and shaft before anything is solved."""
    material = [f"material: {remark}" for remark in strength_remarks(scene)]
    shaft = [*shaft_warnings(scene), *tip_remarks(scene)] if scene.shaft else []
    return [*material, *bore_remarks(scene), *pressure_warnings(scene), *shaft]
