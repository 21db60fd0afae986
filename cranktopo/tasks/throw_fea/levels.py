"""Levels of the body-fitted evaluation, and evaluation to an error or within a time."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

from cranktopo.base.machine import forget_peak_memory, peak_memory_MiB
from cranktopo.base.notes import silent
from cranktopo.design.halves import default_element_size_mm
from cranktopo.numerics.tetrahedra.mesh import RATIO
from cranktopo.tasks.throw_fea.evaluation import Evaluation, MeshResult, evaluate_on_mesh, evaluation
from cranktopo.tasks.throw_fea.studies import (
    BENDING,
    EVALUATION,
    TORSION,
    Level,
    LevelResult,
    PlannedLevel,
    StoredStudy,
)
from cranktopo.tasks.throw_fea.targets import Target

if TYPE_CHECKING:
    from cranktopo.numerics.tetrahedra.elasticity import Order

_COST_GROWTH = 1.9
"""Cost of a mesh over that of one 1.5 times coarser (`python -m tests.benchmarks.evaluation_meshes`)."""


@dataclass(frozen=True)
class EvaluationMesh:
    """A mesh whose elements are `steps` times a factor of 1.5 coarser than by default."""

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
        """Return the general element size."""
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
    """Return the levels of a target, cheapest first; surface files are always meshed graded."""

    def planned(mesh: EvaluationMesh) -> PlannedLevel:
        name = f"{mesh.family} {mesh.size_mm(target):.3g} mm"
        return PlannedLevel(name, mesh.relative_cost, lambda: _solve(target, mesh))

    return [planned(mesh) for mesh in MESHES if target.file is None or mesh.graded]


def _solve(target: Target, mesh: EvaluationMesh) -> Level:
    forget_peak_memory()
    with silent():
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
        own_bounds_percent=_own_bounds(found),
    )


def stiffnesses(level: MeshResult) -> dict[str, float]:
    """Return both stiffnesses with the supports of the design, by the names of the tables."""
    supports = level.target.scene.supports
    torsion, bending = level.stiffness.torsion[supports.torsion], level.stiffness.bending[supports.bending]
    return {name: v for name, v in ((TORSION, torsion), (BENDING, bending)) if v is not None}


def _own_bounds(level: MeshResult) -> dict[str, float]:
    """Return the bounds by the mesh itself; none for triangles, whose surface the mesh moves."""
    if level.target.triangles:
        return {}
    supports, stiffness = level.target.scene.supports, level.stiffness
    bounds = (
        (TORSION, stiffness.torsion_error_percent.get(supports.torsion)),
        (BENDING, stiffness.bending_error_percent.get(supports.bending)),
    )
    return {name: bound for name, bound in bounds if bound is not None}


LEVELS = tuple(EvaluationMesh(steps, graded=True) for steps in (2, 1, 0, -1, -2, -3))
"""Meshes of an evaluation, cheapest first; triangles need one with elements 1.5 times as large beside it."""
_EXPECTED_PERCENT = (1.6, 1.01, 0.65, 0.42, 0.27, 0.17)
"""Bounds to be expected before anything is measured: medians of `tests.benchmarks.error_estimates`.

The second and third are of 14 and 24 random throws; the others continue their trend.
"""


@dataclass(frozen=True)
class ErrorTarget:
    """Largest error of torsional and bending stiffness, wall time to use, or both."""

    percent: float | None = None
    budget_s: float | None = None


def evaluate_to(
    target: Target, error_target: ErrorTarget, measured: StoredStudy | None = None
) -> tuple[Evaluation, bool]:
    """Return the last evaluation on ever finer meshes, and whether it has the accuracy.

    Starts on the cheapest mesh that should do. A budget ends the refinement before a mesh that would not fit.

    Raises:
        CranktopoError: impossible geometry or a failed solve.
    """
    began = time.perf_counter()
    solved: dict[EvaluationMesh, MeshResult] = {}
    found: Evaluation | None = None
    for fine in LEVELS[first_level(error_target, measured, target.triangles) :]:
        meshes = _meshes(fine, target.triangles)
        todo = [mesh for mesh in meshes if mesh not in solved]
        if found is not None and _too_long(error_target, time.perf_counter() - began, todo, solved):
            break
        for mesh in todo:
            size = mesh.size_mm(target)
            solved[mesh] = evaluate_on_mesh(target, size, graded=mesh.graded)
        coarse = solved[meshes[0]] if target.triangles else None
        found = evaluation(solved[fine], coarse, time.perf_counter() - began)
        if error_target.percent is not None and found.error_percent <= error_target.percent:
            return found, True
    assert found is not None, "the first level is always solved"
    return found, error_target.percent is None


def first_level(error_target: ErrorTarget, measured: StoredStudy | None, triangles: bool) -> int:
    """Return the number of the level to start on."""
    first_levels = []
    if error_target.percent is not None:
        enough = [n for n in range(len(LEVELS)) if _expected_percent(n, measured) <= error_target.percent]
        first_levels.append(enough[0] if enough else len(LEVELS) - 1)
    if error_target.budget_s is not None:
        seconds = [expected_seconds(level, measured, triangles) for level in LEVELS]
        fit = [n for n, s in enumerate(seconds) if s is not None and s <= error_target.budget_s]
        first_levels.append(fit[-1] if fit else 0)
    return min(first_levels, default=0)


def _meshes(fine: EvaluationMesh, triangles: bool) -> list[EvaluationMesh]:
    return [*([EvaluationMesh(fine.steps + 1, fine.graded)] if triangles else []), fine]


def _expected_percent(number: int, measured: StoredStudy | None) -> float:
    level = _stored_level(LEVELS[number], measured)
    bound = None if level is None else level.bound_percent
    return _EXPECTED_PERCENT[number] if bound is None else bound


def expected_seconds(fine: EvaluationMesh, measured: StoredStudy | None, triangles: bool) -> float | None:
    """Return the wall time of an evaluation; None where one of its meshes was never measured."""
    levels = [_stored_level(mesh, measured) for mesh in _meshes(fine, triangles)]
    if measured is None or None in levels:
        return None
    return measured.slowdown * sum(level.seconds for level in levels if level)


def _stored_level(mesh: EvaluationMesh, measured: StoredStudy | None) -> LevelResult | None:
    settings = {"steps": mesh.steps, "graded": mesh.graded, "order": mesh.order}
    levels = measured.levels(EVALUATION) if measured else []
    return next((level for level in levels if settings.items() <= level.settings.items()), None)


def _too_long(
    error_target: ErrorTarget,
    spent: float,
    todo: list[EvaluationMesh],
    solved: dict[EvaluationMesh, MeshResult],
) -> bool:
    if error_target.budget_s is None:
        return False
    mesh, last = list(solved.items())[-1]
    rate = last.seconds / mesh.relative_cost
    return spent + sum(rate * mesh.relative_cost for mesh in todo) > error_target.budget_s
