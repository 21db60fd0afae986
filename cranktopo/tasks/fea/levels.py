"""Levels of the body-fitted evaluation: element size and order, refined at the fillets or not."""

from __future__ import annotations

from dataclasses import dataclass

from cranktopo.base.machine import forget_peak_memory, peak_memory_MiB
from cranktopo.design.halves import default_element_size_mm
from cranktopo.numerics.tetrahedra.elasticity import Order
from cranktopo.tasks.fea.evaluation import RATIO, MeshResult, evaluate_on_mesh
from cranktopo.tasks.fea.level import BENDING, EVALUATION, TORSION, Level, PlannedLevel
from cranktopo.tasks.fea.targets import Target

_COST_GROWTH = 1.9
"""Cost of a mesh over that of one 1.5 times coarser (`python -m tests.benchmarks.evaluation_meshes`)."""


@dataclass(frozen=True)
class EvaluationMesh:
    """A mesh whose elements are `steps` times a factor of 1.5 coarser than by default.

    Attributes:
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

    @property
    def relative_cost(self) -> float:
        """Cost over that of the default mesh, before anything was timed.

        Unknowns grow a little slower than the square of the fineness, because the refined rings hold most of
        them; a mesh without them has a third of the unknowns, and linear elements an eighth.
        """
        share = 1.0 if self.graded else 0.3
        return float(share * (0.4 if self.order == 1 else 1.0) * _COST_GROWTH**-self.steps)

    def size_mm(self, target: Target) -> float:
        """General element size."""
        return default_element_size_mm(target.scene) * RATIO**self.steps


MESHES = (
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


def evaluation_levels(target: Target) -> list[PlannedLevel]:
    """Levels of a target, cheapest first; surface files are always meshed graded."""

    def planned(mesh: EvaluationMesh) -> PlannedLevel:
        name = f"{mesh.family} {mesh.size_mm(target):.3g} mm"
        return PlannedLevel(name, mesh.relative_cost, lambda: _solve(target, mesh))

    return [planned(mesh) for mesh in MESHES if target.file is None or mesh.graded]


def _solve(target: Target, mesh: EvaluationMesh) -> Level:
    forget_peak_memory()
    found = evaluate_on_mesh(target, mesh.size_mm(target), graded=mesh.graded, order=mesh.order)
    size = found.stiffness.element_size_mm
    settings = {"element_size_mm": size, "steps": mesh.steps, "graded": mesh.graded, "order": mesh.order}
    return Level(
        study=EVALUATION,
        name=f"{mesh.family} {size:.3g} mm",
        family=mesh.family,
        settings=settings,
        size_mm=size,
        unknowns=3 * found.stiffness.nodes,
        seconds=found.seconds,
        peak_memory_MiB=peak_memory_MiB(),
        values=stiffnesses(found),
    )


def stiffnesses(found: MeshResult) -> dict[str, float]:
    """Return both stiffnesses with the supports of the design, by the names of the tables."""
    supports = found.target.scene.supports
    torsion, bending = found.stiffness.torsion[supports.torsion], found.stiffness.bending[supports.bending]
    return {name: v for name, v in ((TORSION, torsion), (BENDING, bending)) if v is not None}
