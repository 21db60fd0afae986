"""The judge's ladder: element size and order, refined at the fillets or not."""

from __future__ import annotations

import time
from dataclasses import dataclass

from cranktopo.accuracy.machine import PeakMemory
from cranktopo.accuracy.rung import BENDING, TORSION, Rung
from cranktopo.evaluate.elasticity import Order
from cranktopo.evaluate.evaluation import RATIO, Judged, default_element_size_mm, judge
from cranktopo.evaluate.targets import Target

COST_GROWTH = 1.9
"""How much more a mesh costs than one 1.5 times coarser (`python -m tests.benchmarks.judge_meshes`)."""


@dataclass(frozen=True)
class JudgeModel:
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
    JudgeModel(3, False),
    JudgeModel(2, False),
    JudgeModel(2, True, 1),
    JudgeModel(1, False),
    JudgeModel(0, True, 1),
    JudgeModel(0, False),
    JudgeModel(2, True),
    JudgeModel(1, True),
    JudgeModel(0, True),
    JudgeModel(-1, True),
    JudgeModel(-2, True),
    JudgeModel(-3, True),
)
"""In the order of their cost."""


def relative_cost(model: JudgeModel) -> float:
    """Cost of a rung over that of the default mesh, before anything was timed.

    Unknowns grow a little slower than the square of the fineness, because the refined rings hold most of
    them; a mesh without them has a third of the unknowns, and linear elements an eighth.
    """
    share = 1.0 if model.graded else 0.3
    return float(share * (0.4 if model.order == 1 else 1.0) * COST_GROWTH**-model.steps)


def climb_judge(target: Target, model: JudgeModel) -> Rung:
    """Solve one rung.

    Args:
        target: what is judged.
        model: the rung.

    Raises:
        CranktopoError: impossible geometry or a failed solve.
    """
    memory, began = PeakMemory(), time.perf_counter()
    found = judge(target, model.size_mm(target), graded=model.graded, order=model.order)
    seconds = time.perf_counter() - began
    size = found.stiffness.element_size_mm
    return Rung(
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


def stiffnesses(found: Judged) -> dict[str, float]:
    """Both stiffnesses with the supports of the design, by the names of the tables."""
    supports = found.target.scene.supports
    torsion, bending = found.stiffness.torsion[supports.torsion], found.stiffness.bending[supports.bending]
    return {name: v for name, v in ((TORSION, torsion), (BENDING, bending)) if v is not None}
