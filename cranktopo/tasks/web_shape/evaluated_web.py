"""A web and its evaluation on the default mesh, the judge of every search; factors of coarser meshes."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from cranktopo.base.notes import note, silent
from cranktopo.base.progress import Json, StageMemory
from cranktopo.base.side_by_side import LazyFuture, side_by_side
from cranktopo.design.goal.scene_goal import asks_for
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import Loads, WebLoads, loads_name
from cranktopo.engine.plan.planning import planned_scene
from cranktopo.engine.plan.simulated import Feature
from cranktopo.tasks.shaft.stage import with_throw_stiffness
from cranktopo.tasks.throw_fatigue.largest_stress import largest_of_field_MPa, largest_stress_MPa
from cranktopo.tasks.throw_fatigue.needs import check_inputs, check_loads
from cranktopo.tasks.throw_fatigue.remarks import safety_remarks
from cranktopo.tasks.throw_fatigue.safety_field import FatigueField
from cranktopo.tasks.throw_fatigue.stress_mesh import RULE_FRACTION
from cranktopo.tasks.throw_fatigue.target_safety import fatigue_field, web_field
from cranktopo.tasks.throw_fea.evaluation import evaluate, evaluate_on_mesh
from cranktopo.tasks.throw_fea.quantities import goal_values
from cranktopo.tasks.throw_fea.result import EvaluationResult
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.vibration.stage import first_frequency_Hz
from cranktopo.tasks.web_shape.bearing_films import film_values
from cranktopo.tasks.web_shape.shaft_frequency import NAME, frequency_of
from cranktopo.tasks.web_shape.start import kept_features


@dataclass(frozen=True)
class Judging:
    """Evaluation of stresses: load states, and the size of elements in a fillet over its radius."""

    loads: Loads = "extremes"
    fillet_fraction: float = RULE_FRACTION


_USUAL = Judging()


@dataclass(frozen=True)
class EvaluatedWeb:
    """A web with its evaluation on the default mesh, fillets included, and the time that took now."""

    scene: Scene
    evaluation: EvaluationResult
    seconds: float

    @cached_property
    def values(self) -> dict[str, float]:
        """Its quantities by name, in the units of the goal's limits."""
        return {**goal_values(self.scene, self.evaluation), **film_values(self.scene)}


def evaluated_web(
    scene: Scene,
    stressed: Collection[str],
    element_size_mm: float | None,
    name: str,
    work: StageMemory,
    judging: Judging = _USUAL,
) -> EvaluatedWeb:
    """Evaluate a scene's web with its fillets.

    Args:
        stressed: quantities of the stresses to be found as well, which takes longest.
        name: under which the work keeps the evaluation.
        judging: of those.

    Raises:
        CranktopoError: impossible geometry, or a failed solve.
    """
    target = _target(scene)

    def make() -> Json:
        note(_task_words(target, stressed))
        with silent():
            if not stressed:
                return _evaluated(target, element_size_mm)
            # One is meshed while the other is solved; the longer one is here, where Ctrl-C ends it at once.
            safety, found = side_by_side(
                lambda: _stressed(target, stressed, judging), lambda: _evaluated(target, element_size_mm)
            )
        return {**found, **safety}

    began = time.perf_counter()
    evaluation = EvaluationResult.of_json(work.once(name, make), f"evaluation '{name}'")
    return EvaluatedWeb(scene, evaluation, time.perf_counter() - began)


def evaluated_original(
    scene: Scene,
    stressed: Collection[str],
    element_size_mm: float | None,
    work: StageMemory,
    file: Path | None = None,
    judging: Judging = _USUAL,
    then: Callable[[], None] = lambda: None,
) -> tuple[EvaluatedWeb, Callable[[], EvaluatedWeb]]:
    """Evaluate a scene's own web, or the body of a file, and find its stresses while others go on.

    Args:
        stressed, judging: as of `evaluated_web`.
        then: called in the thread of the stresses, if any are asked for, once they are known.

    Returns:
        The web without `stressed` quantities, and what waits for those and returns the web with them; that
        raises CranktopoError where its mesh or its solve fails.

    Raises:
        CranktopoError: impossible geometry, or a failed solve.
    """
    target, began = _target(scene, file), time.perf_counter()

    def make() -> Json:
        note(_task_words(target, stressed))
        with silent():
            return _evaluated(target, element_size_mm)

    def solved() -> Json:
        stresses = _stressed(target, stressed, judging)
        then()
        return stresses

    found = EvaluationResult.of_json(work.once("original", make), "evaluation 'original'")
    web, safety = EvaluatedWeb(scene, found, time.perf_counter() - began), "original-fatigue"
    with silent():
        ahead = LazyFuture(solved)
        if stressed and safety not in work.kept:
            _check(target, stressed, judging)
            ahead.begin()

    def judged() -> EvaluatedWeb:
        waited = time.perf_counter()
        more = work.once(safety, ahead.result) if stressed else {}
        whole = EvaluationResult.of_json(found.as_json() | more, "evaluation 'original'")
        return EvaluatedWeb(scene, whole, web.seconds + time.perf_counter() - waited)

    return web, judged


def coarse_shares(scene: Scene, element_size_mm: float, original: Mapping[str, float]) -> Json:
    """Return factors by quantity that bring the original web on a coarse mesh to its finer evaluation."""
    with silent():
        found, supports = evaluate_on_mesh(_target(scene), element_size_mm).stiffness, scene.supports
    torsion, bending = found.torsion[supports.torsion], found.bending[supports.bending]
    assert torsion is not None
    assert bending is not None
    shares = {"torsion": original["torsion"] / torsion, "bending": original["bending"] / bending}
    per_mass = {f"{name}_per_mass": share for name, share in shares.items()}
    shaft = frequency_of(scene, {"torsion": torsion, "inertia": original["inertia"]})
    return {**shares, **per_mass, **({NAME: original[NAME] / shaft.frequency_Hz} if shaft else {})}


def kept_safety(work: StageMemory, name: str, scene: Scene, judging: Judging) -> float:
    """Return the safety of `web_safety`, a part of a long work."""
    return float(work.once(name, lambda: {"safety": web_safety(scene, judging)})["safety"])


def web_safety(scene: Scene, judging: Judging) -> float:
    """Return the least fatigue safety of a scene's web.

    Raises:
        CranktopoError: missing loads or strengths, impossible geometry, or a failed solve.
    """
    with silent():
        return float(_stressed(_target(scene), {"fatigue_safety"}, judging)["fatigue_safety"])


def _target(scene: Scene, file: Path | None = None) -> Target:
    kept: tuple[Feature, ...] = ("bores", "fillets") if file else kept_features(scene)
    return Target(scene.name, planned_scene(scene, kept), file)


def _task_words(target: Target, stressed: Collection[str]) -> str:
    more = " and fatigue" if "fatigue_safety" in stressed else " and stress" if stressed else ""
    return f"{target.name}: evaluation{more} on the default mesh"


def _evaluated(target: Target, element_size_mm: float | None) -> Json:
    """Return the evaluation of a target, with the first natural frequency of its shaft where that counts."""
    found = evaluate(target, element_size_mm).result
    if asks_for(target.scene, NAME):
        frequency = first_frequency_Hz(target, element_size_mm)
        found = found.model_copy(update={"natural_frequency_Hz": frequency})
    return found.as_json()


def _check(target: Target, stressed: Collection[str], judging: Judging) -> None:
    if "fatigue_safety" in stressed:
        check_inputs(target, "lsa", judging.loads)
    else:
        check_loads(target, judging.loads)


def _stressed(target: Target, stressed: Collection[str], judging: Judging) -> Json:
    """Return the quantities of the stresses as an evaluation has them; of both one mesh is solved."""
    loads, fraction = judging.loads, judging.fillet_fraction
    if isinstance(loads, WebLoads):
        return _least(web_field(target, "lsa", loads, fraction), loads)
    target = with_throw_stiffness(target)
    if "fatigue_safety" not in stressed:
        return {"stress_MPa": largest_stress_MPa(target, loads, fraction)}
    field = fatigue_field(target, "lsa", loads, fraction)
    more = {"stress_MPa": largest_of_field_MPa(field)} if "stress" in stressed else {}
    return {**_least(field, loads), **more}


def _least(field: FatigueField, loads: Loads) -> Json:
    remarks = safety_remarks(field)
    return {
        "fatigue_safety": float(field.critical.safety),
        "fatigue_place": field.critical.place,
        "fatigue_loads": loads_name(loads),
        **({"fatigue_remarks": remarks} if remarks else {}),
    }
