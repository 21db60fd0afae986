"""The judge's ladder: element size and order, refined at the fillets or not."""

from __future__ import annotations

import time
from dataclasses import dataclass

from cranktopo.accuracy.level import BENDING, TORSION, Level
from cranktopo.accuracy.machine import PeakMemory
from cranktopo.evaluate.elasticity import Order
from cranktopo.evaluate.evaluation import RATIO, MeshResult, default_element_size_mm, evaluate_on_mesh
from cranktopo.evaluate.targets import Target

COST_GROWTH = 1.9
"""How much more a mesh costs than one 1.5 times coarser (`python -m tests.benchmarks.evaluation_meshes`)."""


@dataclass(frozen=True)
class EvaluationMesh:
    """A mesh of the judge.

    Attributes:
        steps: how many times 1.5 its elements are coarser than by default.
        graded: refined at fillets and sharp rings.
        order: degree of the displacements.
    """

    steps: int
    graded: bool
    order: Order = 2

    @property
    def family(self) -> str:
        """Meshes that converge together."""
        kind = "graded" if self.graded else "uniform"
        return kind if self.order == 2 else f"linear {kind}"

    def size_mm(self, target: Target) -> float:
        """General element size."""
        return default_element_size_mm(target.scene) * RATIO**self.steps


LADDER = (
    EvaluationMesh(3, False),
    EvaluationMesh(2, False),
    EvaluationMesh(2, True, 1),
    EvaluationMesh(1, False),
    EvaluationMesh(0, True, 1),
    EvaluationMesh(0, False),
    EvaluationMesh(2, True),
    EvaluationMesh(1, True),
    EvaluationMesh(0, True),
    EvaluationMesh(-1, True),
    EvaluationMesh(-2, True),
    EvaluationMesh(-3, True),
)
"""In the order of their cost."""


def relative_cost(model: EvaluationMesh) -> float:
    """Cost of a rung over that of the default mesh, before anything was timed.

    Unknowns grow a little slower than the square of the fineness, because the refined rings hold most of
    them; a mesh without them has a third of the unknowns, and linear elements an eighth.
    """
    share = 1.0 if model.graded else 0.3
    return float(share * (0.4 if model.order == 1 else 1.0) * COST_GROWTH**-model.steps)


def solve_level(target: Target, model: EvaluationMesh) -> Level:
    """Solve one rung.

    Args:
        target: what is judged.
        model: the rung.

    Raises:
        CranktopoError: impossible geometry or a failed solve.
    """
    memory, began = PeakMemory(), time.perf_counter()
    found = evaluate_on_mesh(target, model.size_mm(target), graded=model.graded, order=model.order)
    seconds = time.perf_counter() - began
    size = found.stiffness.element_size_mm
    return Level(
        ladder="judge",
        name=f"{model.family} {size:.3g} mm",
        family=model.family,
        settings={
            "element_size_mm": size,
            "steps": model.steps,
            "graded": model.graded,
            "order": model.order,
        },
        size_mm=size,
        unknowns=3 * found.stiffness.nodes,
        seconds=seconds,
        peak_memory_MiB=memory.MiB,
        values=stiffnesses(found),
        spent_seconds=seconds,
    )


def stiffnesses(found: MeshResult) -> dict[str, float]:
    """Both stiffnesses with the supports of the design, by the names of the tables."""
    supports = found.target.scene.supports
    torsion, bending = found.stiffness.torsion[supports.torsion], found.stiffness.bending[supports.bending]
    return {name: v for name, v in ((TORSION, torsion), (BENDING, bending)) if v is not None}
