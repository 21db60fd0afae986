"""The web of a search whose throw stands alone, judged in its shaft when it is found, beside the original."""

from __future__ import annotations

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import note, silent
from cranktopo.base.progress import Json, StageMemory
from cranktopo.design.checks.engine import speed_range_rpm
from cranktopo.design.goal.limit import Goal
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import WebLoads
from cranktopo.engine.plan.planning import plan_for_stress
from cranktopo.tasks.web_shape.each_web.loaded_shaft import ShaftFigures, loaded_shaft
from cranktopo.tasks.web_shape.in_shaft import (
    EFFECT,
    STRESS_ALONE,
    in_its_shaft,
    least_in_shaft,
    without_shaft,
)
from cranktopo.tasks.web_shape.optimum import ShapeSettings
from cranktopo.tasks.web_shape.result import ShaftCheck
from cranktopo.tasks.web_shape.stage import stresses_in

FILLET_FRACTION = 0.5
"""Element size in a fillet over its radius. Of both webs the safety is 2.1 to 4.3 % less than on the mesh of
an evaluation, what the result has over the original 0.2 % off, in a third of the time."""


def judged_in_shaft(
    scene: Scene, web: Scene, goal: Goal, settings: ShapeSettings, work: StageMemory
) -> tuple[ShaftCheck | None, str]:
    """Return the safety of all webs in their shaft with the web that was found, and with the original.

    Else why there is none, in words; empty where the search has the loads of the shaft itself, the goal asks
    for no stress, or a single throw is its shaft. A shaft that fails costs no search.

    Raises:
        CranktopoError: interruption.
    """
    if isinstance(settings.loads, WebLoads) or not stresses_in(goal.quantities):
        return None, ""
    if scene.engine is None or scene.engine.throws == 1:
        return None, ""
    if why := _unjudged(scene, goal):
        return None, why
    try:
        return _shaft_check(scene, web, goal, settings, work), ""
    except CranktopoError as error:
        if error.code == ExitCode.INTERRUPTED:
            raise
        return None, error.message


def _unjudged(scene: Scene, goal: Goal) -> str:
    """Return why a web is judged as a throw alone only; empty where it is not."""
    effect = plan_for_stress(scene)[EFFECT]
    if effect.estimate_percent is None:
        return effect.reason
    if scene.effects.continuous_shaft == "off":
        return f"effects.{EFFECT} is off, 'auto' judges it there; {effect.reason.split('; ')[-1]}"
    return without_shaft(scene) if "fatigue_safety" in goal.quantities else STRESS_ALONE


def _shaft_check(
    scene: Scene, web: Scene, goal: Goal, settings: ShapeSettings, work: StageMemory
) -> ShaftCheck:
    note(f"{scene.name}: original and result in their shaft, where the search did not have them")
    fraction = max(FILLET_FRACTION, settings.fillet_fraction)
    original, result = (
        _figures(own, name, fraction, work)
        for name, own in (("shaft-check-original", scene), ("shaft-check-result", web))
    )
    least = least_in_shaft(goal, original, result)
    return ShaftCheck(**vars(least), speeds_rpm=speed_range_rpm(scene), fillet_fraction=fraction)


def _figures(scene: Scene, name: str, fillet_fraction: float, work: StageMemory) -> ShaftFigures:
    def solved() -> Json:
        with silent():
            return loaded_shaft(in_its_shaft(scene), fillet_fraction).figures.as_json()

    return ShaftFigures.of_json(work.once(name, solved), "shaft of the run")
