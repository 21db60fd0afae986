"""Error bounds of the body-fitted evaluation against true errors, on built-in designs and random throws.

The true error is against the limit of two finer meshes, extrapolated with order 1.3.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from cranktopo.effects import planned_scene
from cranktopo.errors import CranktopoError
from cranktopo.evaluate.evaluation import (
    RATIO,
    MeshResult,
    default_element_size_mm,
    evaluate_on_mesh,
    evaluation,
)
from cranktopo.evaluate.targets import Target
from cranktopo.scene import load_scene
from cranktopo.scene.loading import builtin_designs
from tests.random_throws import random_throw

SEEDS = range(8)
STEPS = (2, 1, 0)
"""How many times 1.5 the meshes are coarser than the default."""
_ORDER = 1.3
_RANDOM = "random-"


def limit(coarse: float, fine: float) -> float:
    """What two meshes, the finer one by a factor of 1.5, converge to with order 1.3."""
    return fine + (fine - coarse) / (RATIO**_ORDER - 1)


@dataclass(frozen=True, kw_only=True)
class Bounded:
    """A stiffness of a design, the bound of its error, and its true error, %."""

    design: str
    quantity: str
    bound_percent: float
    error_percent: float

    @property
    def holds(self) -> bool:
        """Whether the bound is one."""
        return abs(self.error_percent) <= self.bound_percent


def held_text(rows: Sequence[Bounded]) -> str:
    """How many bounds hold."""
    held = sum(row.holds for row in rows)
    return f"\n{held} of {len(rows)} within their bound: {100 * held / len(rows):.1f} %"


@dataclass(frozen=True, kw_only=True)
class EvaluationError(Bounded):
    """A stiffness on one mesh of the evaluation."""

    steps: int
    size_mm: float


def target_of(name: str) -> Target:
    """A built-in design, or random-SEED."""
    random = name.startswith(_RANDOM)
    scene = random_throw(int(name[len(_RANDOM) :])) if random else load_scene(name)
    return Target(scene.name, planned_scene(scene))


def every_name(seeds: Sequence[int] = SEEDS) -> list[str]:
    """The built-in designs and random throws."""
    return [*builtin_designs(), *(f"{_RANDOM}{seed}" for seed in seeds)]


def evaluation_errors(
    target: Target, steps: Sequence[int] = STEPS, finest: int = -2
) -> Iterator[EvaluationError]:
    """Bounds and true errors of a design.

    Args:
        steps: meshes, coarse to fine; left out where the web is too thin for elements so large.
        finest: steps of the finest mesh of the truth; the other one is 1.5 times coarser.
    """
    size = default_element_size_mm(target.scene)
    needed = sorted({*steps, *(step + 1 for step in steps), finest, finest + 1}, reverse=True)
    tried = {step: _on_mesh(target, size * RATIO**step) for step in needed}
    found = {step: result for step, result in tried.items() if result}
    known = {step: evaluation(found.get(step + 1, found[step]), found[step], 0.0) for step in found}

    for quantity in ("torsion_Nm_per_rad", "bending_N_per_mm"):
        name = quantity.split("_")[0]
        true = limit(*(float(getattr(known[step], quantity)) for step in (finest + 1, finest)))
        for step in (step for step in steps if step + 1 in found):
            error = 100 * (getattr(known[step], quantity) / true - 1)
            bound = getattr(known[step], f"{name}_error_percent")
            yield EvaluationError(
                design=target.name,
                quantity=name,
                bound_percent=bound,
                error_percent=error,
                steps=step,
                size_mm=size * RATIO**step,
            )


def _on_mesh(target: Target, size_mm: float) -> MeshResult | None:
    """A target on one mesh; None where the web is too thin for elements so large."""
    try:
        return evaluate_on_mesh(target, size_mm)
    except CranktopoError as error:
        if "thinnest parts" not in str(error):
            raise
        return None
