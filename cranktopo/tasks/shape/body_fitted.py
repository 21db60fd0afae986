"""A web by the body-fitted evaluation, which has the last word on every limit."""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from cranktopo.base.progress import Json, Work
from cranktopo.base.side_by_side import side_by_side
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.planning import planned_scene
from cranktopo.engine.plan.simulated import Feature
from cranktopo.tasks.fatigue.safety_field import fatigue_field
from cranktopo.tasks.fea.evaluation import evaluate
from cranktopo.tasks.fea.quantities import goal_values
from cranktopo.tasks.fea.result import EvaluationResult
from cranktopo.tasks.fea.targets import Target
from cranktopo.tasks.shape.free_bores import kept_features

_WITH_BODY: tuple[Feature, ...] = ("bores", "fillets")


@dataclass(frozen=True)
class EvaluatedWeb:
    """A web with its evaluation on the default mesh, fillets included.

    Attributes:
        evaluation: with the fatigue safety where that is asked for.
        seconds: what it took now; next to nothing where it was kept.
    """

    scene: Scene
    evaluation: EvaluationResult
    seconds: float

    @cached_property
    def values(self) -> dict[str, float]:
        """Its quantities by name, in the units of the goal's limits."""
        return goal_values(self.scene, self.evaluation)


def evaluated_web(
    scene: Scene,
    fatigue: bool,
    element_size_mm: float | None,
    name: str,
    work: Work,
    file: Path | None = None,
) -> EvaluatedWeb:
    """Evaluate a scene's web with its fillets, or the body of a file that stands for it.

    Args:
        fatigue: whether the fatigue safety is wanted as well, which takes longest.
        name: under which the work keeps the evaluation.

    Raises:
        CranktopoError: impossible geometry, or a failed solve.
    """
    kept = _WITH_BODY if file else kept_features(scene)
    target = Target(scene.name, planned_scene(scene, kept), file)

    def make() -> Json:
        work.info(f"{target.name}: evaluation{' and fatigue' if fatigue else ''} on the default mesh")
        if not fatigue:
            return evaluate(target, element_size_mm).result.as_json()
        # One is meshed while the other is solved; the longer one in this thread, which Ctrl-C ends at once.
        field, found = side_by_side(
            lambda: fatigue_field(target, "lsa"), lambda: evaluate(target, element_size_mm)
        )
        return {**found.result.as_json(), "fatigue_safety": float(field.critical.safety)}

    began = time.perf_counter()
    evaluation = EvaluationResult.of_json(work.once(name, make), f"evaluation '{name}'")
    return EvaluatedWeb(scene, evaluation, time.perf_counter() - began)
