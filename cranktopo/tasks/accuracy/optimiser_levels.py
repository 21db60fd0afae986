"""Levels of the optimiser: cell size, solver tolerance and precision, iterations, kind of hexahedron.

Every level is a whole optimisation; the stiffness of its shape is from the body-fitted evaluation, on
the same meshes for all.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.machine import forget_peak_memory, peak_memory_MiB
from cranktopo.bodies.memory import WALL_CELLS, thinnest_wall_mm
from cranktopo.design.scale import default_element_size_mm
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.cost import effort
from cranktopo.numerics.precision import CompileClock, double_precision
from cranktopo.numerics.surfaces.files import write_stl
from cranktopo.tasks.density import loop, stage
from cranktopo.tasks.density.assess import assess
from cranktopo.tasks.density.assessment import Assessment
from cranktopo.tasks.density.problem import SolverSettings
from cranktopo.tasks.extraction.checked_surface import checked_surface
from cranktopo.tasks.fea.evaluation import RATIO, evaluate
from cranktopo.tasks.fea.level import BENDING, NAME_OF_CASE, OPTIMISER, TORSION, Level, PlannedLevel
from cranktopo.tasks.fea.targets import Target

_STEPS = 9


@dataclass(frozen=True)
class OptimiserModel:
    """An optimisation with cells of at most `cell_mm`; `label` says what else differs from the defaults."""

    cell_mm: float
    label: str = ""
    solving: SolverSettings = field(default_factory=SolverSettings)
    max_iterations: int | None = None

    @property
    def name(self) -> str:
        """As printed."""
        return f"cells {self.cell_mm:.3g} mm" + (f", {self.label}" if self.label else "")

    def scene(self, scene: Scene) -> Scene:
        """Return a scene with this cell size, and at most its own number of iterations."""
        most = scene.optimise.max_iterations
        limit = most if self.max_iterations is None else min(self.max_iterations, most)
        return scene.with_optimise(resolution_mm=self.cell_mm, max_iterations=limit)


def optimiser_models(scene: Scene) -> Sequence[OptimiserModel]:
    """Cell sizes that double the number of cells; after three of them every other setting at the second.

    Walls so thin that only the finest cells hold them leave one size or none, and no second one.
    """
    sizes = cell_sizes(scene)
    plain = [OptimiserModel(size) for size in sizes]
    return (*plain[:3], *(_settings(sizes[1]) if len(sizes) > 1 else ()), *plain[3:])


def cell_sizes(scene: Scene) -> list[float]:
    """Cell sizes that double the number of cells, coarsest first, from the coarsest that walls allow, mm.

    The scene's own resolution is one of them where the walls allow it.
    """
    coarsest = thinnest_wall_mm(scene) / WALL_CELLS
    sizes = [scene.optimise.resolution_mm * 2 ** (step / 3) for step in range(_STEPS, -_STEPS, -1)]
    return [size for size in sizes if size <= coarsest]


def _settings(cell_mm: float) -> tuple[OptimiserModel, ...]:
    """Return one model for each setting beside the cell size."""
    tight = SolverSettings(tolerance_early=1e-8, tolerance=1e-8)
    double = replace(tight, precision="float64")
    return (
        OptimiserModel(cell_mm, "10 iterations", max_iterations=10),
        OptimiserModel(cell_mm, "tolerance 1e-2", SolverSettings(tolerance=1e-2)),
        OptimiserModel(cell_mm, "tolerance 1e-8", tight),
        OptimiserModel(cell_mm, "tolerance 1e-8, float64", double),
        OptimiserModel(cell_mm, "plain hexahedra", SolverSettings(incompatible_modes=False)),
    )


@dataclass(frozen=True)
class Optimised:
    """A finished optimisation.

    Attributes:
        target: its surface on the disk; None where the density is too grey for one.
        own: stiffnesses by the optimiser's model.
        unknowns: degrees of freedom of one solve.
    """

    target: Target | None
    own: Assessment
    unknowns: int
    cells: int
    load_cases: int
    iterations: int
    compile_seconds: float


def optimise_once(scene: Scene, model: OptimiserModel, folder: Path) -> Optimised:
    """Optimise a scene without a run directory; the surface goes into `folder`.

    Raises:
        CranktopoError: an impossible scene or a failed solve.
    """
    with double_precision():
        clock = CompileClock()
        ready = stage.prepare(model.scene(scene))
        found = stage.optimise_density(ready, model.solving)
        problem = found.problem
        own = assess(problem, ready.scene, ready.domain, found.design.physical)
        target = _surface(ready, found.design, folder)
        unknowns, cases = problem.model.forces[0].size, len(problem.model.cases)
        nx, ny, nz = ready.domain.grid.cells
        iterations = len(found.state.history)
        return Optimised(target, own, unknowns, nx * ny * nz, cases, iterations, clock.compile_s)


def _surface(ready: stage.Prepared, design: loop.WebDensities, folder: Path) -> Target | None:
    try:
        checked = checked_surface(ready.scene, ready.domain, design)
    except CranktopoError as error:
        if error.code != ExitCode.CRITERION_NOT_MET:
            raise
        return None
    path = folder / "web.stl"
    write_stl(path, checked.surface.half_throw)
    return Target(f"{ready.scene.name}, optimised", ready.scene, path)


def optimiser_levels(scene: Scene) -> list[PlannedLevel]:
    """Levels of a scene that has an envelope, in the order of `optimiser_models`."""

    def planned(model: OptimiserModel) -> PlannedLevel:
        return PlannedLevel(model.name, model.cell_mm**-3, lambda: _solve(scene, model))

    return [planned(model) for model in optimiser_models(scene)]


def _solve(scene: Scene, model: OptimiserModel) -> Level:
    """Optimise, and evaluate the shape on elements 1.5 times as large as by default."""
    forget_peak_memory()
    began = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        found = optimise_once(scene, model, Path(folder))
        seconds, peak = time.perf_counter() - began, peak_memory_MiB()
        shape = found.target and evaluate(found.target, default_element_size_mm(found.target.scene) * RATIO)
    return Level(
        study=OPTIMISER,
        name=model.name,
        family=model.label or "cells",
        settings={
            "cell_mm": model.cell_mm,
            **asdict(model.solving),
            "max_iterations": model.max_iterations,
            "iterations": found.iterations,
            "cells": found.cells,
            "load_cases": found.load_cases,
            "designs": effort(scene).designs,
        },
        size_mm=model.cell_mm,
        unknowns=found.unknowns,
        seconds=seconds - found.compile_seconds,
        peak_memory_MiB=peak,
        values={TORSION: shape.torsion_Nm_per_rad, BENDING: shape.bending_N_per_mm} if shape else {},
        band_percent=shape.error_percent if shape else 0.0,
        compile_seconds=found.compile_seconds,
        model={
            NAME_OF_CASE[c.name]: c.stiffness
            for c in found.own.cases
            if c.name in NAME_OF_CASE and c.stiffness is not None
        },
    )
