"""The loop's last step: the shape optimiser goes on with the web of the best step, for the design's goal."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.near_ties import clearly_more
from cranktopo.base.notes import indented
from cranktopo.bodies.solid.files import coarse_facet_mm, surface_of
from cranktopo.design.goal.limit import Goal
from cranktopo.design.goal.outcome import GoalOutcome, GoalWords, goal_outcome
from cranktopo.design.goal.scene_goal import goal_of, with_goal
from cranktopo.design.loading import stored_scene
from cranktopo.design.schema import Scene
from cranktopo.runs.directories import RunStore
from cranktopo.runs.kind import SHAPE
from cranktopo.tasks.extraction.text import release_text
from cranktopo.tasks.iterate.one_step import transition_mm
from cranktopo.tasks.iterate.result import LoopStep, Settings, ShapeOutcome
from cranktopo.tasks.web_shape.result import ShapeResult
from cranktopo.tasks.web_shape.run import shape_in, shape_settings
from cranktopo.tasks.web_shape.search import HELD
from cranktopo.tasks.web_shape.shaft_text import less_safe_in_shaft, shaft_lines


class ShapeStep(NamedTuple):
    """The shape optimisation and its web; None where no web that keeps the limits was found."""

    row: LoopStep | None
    outcome: ShapeOutcome


def shape_scene(scene: Scene) -> Scene:
    """Return the design with the goal of its last step: its own, else torsional stiffness per mass."""
    return scene if scene.goal is not None else with_goal(scene, maximise="torsion_per_mass")


def shape_step(
    run: RunStore,
    scene: Scene,
    best: LoopStep | None,
    number: int,
    begun: Scene | None,
    settings: Settings,
) -> ShapeStep:
    """Optimise the dimensions of the best web in `shape/`, or read what was done; the loop stands anyway.

    `number` is that of the row in the table of steps. Without `begun` the design's own web is the first.
    """
    searched = shape_scene(scene)
    goal = goal_of(searched)
    assert goal is not None
    goal_words = GoalWords.model_validate({goal.sense: goal.quantity})
    try:
        with indented():
            own = replace(shape_settings(searched, settings.limits), element_size_mm=settings.element_size_mm)
            data = shape_in(run.path / SHAPE, searched, own, ["cranktopo", "iterate"], begun)
    except CranktopoError as error:
        if error.code == ExitCode.INTERRUPTED:
            raise
        return _none(str(error), goal_words)
    if not data.makeable:
        return _none(release_text(data.undercuts), data.goal)
    if not data.held:
        return _none(data.stop_reason, data.goal)
    row = _row(number, data, stored_scene(run.path / SHAPE / data.files.design))
    return _compared(row, best, goal, data)


def _row(number: int, data: ShapeResult, web: Scene) -> LoopStep:
    found = data.result
    return LoopStep(
        number=number,
        throw_kg=found.mass_kg.throw,
        web_kg=found.mass_kg.web,
        torsion_Nm_per_rad=found.torsion_Nm_per_rad,
        bending_N_per_mm=found.bending_N_per_mm,
        torsion_error_percent=found.error_estimate_percent["torsion"],
        bending_error_percent=found.error_estimate_percent["bending"],
        transition_mm=transition_mm(surface_of(web, "web", coarse_facet_mm(web)), web),
        overlap_percent=None,
        removed_percent=None,
        seconds=data.seconds["total"],
        undercuts=data.undercuts,
    )


def _compared(row: LoopStep, best: LoopStep | None, goal: Goal, data: ShapeResult) -> ShapeStep:
    """Compare both: a step is better only where it keeps the limits and is so clearly."""
    if best is None:
        return ShapeStep(row, _outcome(data, better_than_best_step=True))
    original, shaped, own = data.values.original, data.values.result, _values(best)
    outcomes = goal_outcome(goal, own, original, HELD).limits
    unknown = tuple(dict.fromkeys(o.quantity for o in outcomes if o.holds is None))
    violated = any(outcome.holds is False for outcome in outcomes)
    name = goal.quantity
    percent = 100 * own[name] / original[name] if name in own else None
    step_wins = not violated and name in own and _clearly_better(own[name], shaped[name], goal)
    found = _outcome(
        data,
        better_than_best_step=not step_wins,
        best_step_percent=percent,
        not_judged_of_steps=list(unknown),
    )
    return ShapeStep(row, found)


def _none(reason: str, goal: GoalOutcome | GoalWords) -> ShapeStep:
    return ShapeStep(None, ShapeOutcome(found=False, reason=reason, goal=goal))


def _outcome(data: ShapeResult, **compared: Any) -> ShapeOutcome:
    return ShapeOutcome(
        found=True,
        reason=data.stop_reason,
        goal=data.goal,
        left_off=data.left_off,
        loads=data.loads,
        less_safe=less_safe_in_shaft(data) or None,
        in_shaft="; ".join(shaft_lines(data)) or None,
        **compared,
    )


def _clearly_better(value: float, other: float, goal: Goal) -> bool:
    return clearly_more(other, value) if goal.sense == "minimise" else clearly_more(value, other)


def _values(step: LoopStep) -> dict[str, float]:
    """Return what the loop knows of a step, in the units of the goal's limits."""
    return {
        "mass": step.throw_kg,
        "torsion": step.torsion_Nm_per_rad,
        "bending": step.bending_N_per_mm,
        "torsion_per_mass": step.torsion_per_kg,
        "bending_per_mass": step.bending_per_kg,
    }
