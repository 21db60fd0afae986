"""A web and its evaluation on the default mesh, the judge of every search; factors of coarser meshes."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from cranktopo.base.notes import note, silent
from cranktopo.base.progress import Json, Work
from cranktopo.base.side_by_side import LazyFuture, side_by_side
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import HistoryKind
from cranktopo.engine.plan.planning import planned_scene
from cranktopo.engine.plan.simulated import Feature
from cranktopo.tasks.fatigue.needs import check_inputs
from cranktopo.tasks.fatigue.safety_field import fatigue_field
from cranktopo.tasks.fea.evaluation import evaluate, evaluate_on_mesh
from cranktopo.tasks.fea.quantities import goal_values
from cranktopo.tasks.fea.result import EvaluationResult
from cranktopo.tasks.fea.targets import Target
from cranktopo.tasks.shaft.stage import with_throw_stiffness
from cranktopo.tasks.shape.bearing_films import film_values
from cranktopo.tasks.shape.start import kept_features


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
    fatigue: HistoryKind | None,
    element_size_mm: float | None,
    name: str,
    work: Work,
) -> EvaluatedWeb:
    """Evaluate a scene's web with its fillets.

    Args:
        fatigue: load states over which the fatigue safety is found as well, which takes longest; None
            without it.
        name: under which the work keeps the evaluation.

    Raises:
        CranktopoError: impossible geometry, or a failed solve.
    """
    target = _target(scene)

    def make() -> Json:
        note(_told(target, fatigue))
        if not fatigue:
            with silent():
                return evaluate(target, element_size_mm).result.as_json()
        # One is meshed while the other is solved; the longer one in this thread, which Ctrl-C ends at once.
        with silent():
            safety, found = side_by_side(
                lambda: _safety(target, fatigue), lambda: evaluate(target, element_size_mm)
            )
        return {**found.result.as_json(), **safety}

    began = time.perf_counter()
    evaluation = EvaluationResult.of_json(work.once(name, make), f"evaluation '{name}'")
    return EvaluatedWeb(scene, evaluation, time.perf_counter() - began)


def evaluated_original(
    scene: Scene,
    fatigue: HistoryKind | None,
    element_size_mm: float | None,
    work: Work,
    file: Path | None = None,
) -> tuple[EvaluatedWeb, Callable[[], EvaluatedWeb]]:
    """Evaluate a scene's own web, or the body of a file, and find its fatigue safety while others go on.

    Returns:
        The web without its safety, and what waits for that and returns the web with it; that raises
        CranktopoError where its mesh or its solve fails.

    Raises:
        CranktopoError: impossible geometry, or a failed solve.
    """
    target, began = _target(scene, file), time.perf_counter()

    def make() -> Json:
        note(_told(target, fatigue))
        with silent():
            return evaluate(target, element_size_mm).result.as_json()

    found = EvaluationResult.of_json(work.once("original", make), "evaluation 'original'")
    web, safety = EvaluatedWeb(scene, found, time.perf_counter() - began), "original-fatigue"
    with silent():
        ahead = LazyFuture(lambda: _safety(target, fatigue or "extremes"))
        if fatigue and safety not in work.kept:
            check_inputs(target, "lsa", fatigue)
            ahead.begin()

    def judged() -> EvaluatedWeb:
        waited = time.perf_counter()
        whole = found.model_copy(update=work.once(safety, ahead.result)) if fatigue else found
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
    return {**shares, **{f"{name}_per_mass": share for name, share in shares.items()}}


def _target(scene: Scene, file: Path | None = None) -> Target:
    kept: tuple[Feature, ...] = ("bores", "fillets") if file else kept_features(scene)
    return Target(scene.name, planned_scene(scene, kept), file)


def _told(target: Target, fatigue: HistoryKind | None) -> str:
    return f"{target.name}: evaluation{' and fatigue' if fatigue else ''} on the default mesh"


def _safety(target: Target, loads: HistoryKind) -> Json:
    found = fatigue_field(with_throw_stiffness(target), "lsa", loads)
    return {"fatigue_safety": float(found.critical.safety)}
