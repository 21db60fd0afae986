"""The optimiser's ladder: cell size, solver tolerance and precision, iterations, kind of hexahedron.

Every rung is a whole optimisation; the stiffness of its shape is the judge's, on the same meshes for all.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

from cranktopo.accuracy.level import BENDING, NAME_OF_CASE, TORSION, Level
from cranktopo.accuracy.machine import PeakMemory
from cranktopo.domain.resolution import WALL_CELLS, thinnest_wall_mm
from cranktopo.errors import CranktopoError, ExitCode
from cranktopo.evaluate.evaluation import RATIO, Evaluation, default_element_size_mm, evaluate
from cranktopo.evaluate.targets import Target
from cranktopo.fem.precision import CompileClock, double_precision
from cranktopo.optimise import loop, stage
from cranktopo.optimise.assess import Assessment, assess
from cranktopo.scene import Scene
from cranktopo.surface.checked_surface import checked_surface
from cranktopo.triangles.surface_files import write_stl

_JUDGED_STEPS = 1
"""How many times 1.5 the elements are larger than by default on which shapes are judged, all alike."""
_STEPS = 9


@dataclass(frozen=True)
class OptimiserModel:
    """An optimisation as a rung.

    Attributes:
        cell_mm: largest cell edge.
        label: what differs from the default settings, empty for them.
        solving: how exactly the equations are solved.
        max_iterations: limit on designs evaluated, None for the design's own.
    """

    cell_mm: float
    label: str = ""
    solving: loop.Solving = field(default_factory=loop.Solving)
    max_iterations: int | None = None

    @property
    def name(self) -> str:
        """Shown."""
        return f"cells {self.cell_mm:.3g} mm" + (f", {self.label}" if self.label else "")

    def scene(self, scene: Scene) -> Scene:
        """A scene with this rung's cell size and limit."""
        most = scene.optimise.max_iterations
        limit = most if self.max_iterations is None else min(self.max_iterations, most)
        return scene.with_optimise(resolution_mm=self.cell_mm, max_iterations=limit)


def optimiser_study(scene: Scene) -> Sequence[OptimiserModel]:
    """Cell sizes that double the number of cells; after three of them every other setting at the second.

    Walls so thin that only the finest cells hold them leave one size or none, and no second one.

    Args:
        scene: its own resolution is one of the sizes.
    """
    sizes = cell_sizes(scene)
    plain = [OptimiserModel(size) for size in sizes]
    settings = settings_rungs(sizes[1]) if len(sizes) > 1 else ()
    return (*plain[:3], *settings, *plain[3:])


def cell_sizes(scene: Scene) -> list[float]:
    """Cell sizes that double the number of cells, coarsest first, from the coarsest that walls allow, mm.

    Args:
        scene: its own resolution is one of the sizes where that is allowed.
    """
    coarsest = thinnest_wall_mm(scene) / WALL_CELLS
    steps = range(_STEPS, -_STEPS, -1)
    sizes = [scene.optimise.resolution_mm * 2 ** (step / 3) for step in steps]
    return [size for size in sizes if size <= coarsest]


def settings_rungs(cell_mm: float) -> tuple[OptimiserModel, ...]:
    """One rung for each setting beside the cell size.

    Args:
        cell_mm: largest cell edge of all.
    """
    tight = loop.Solving(tolerance_early=1e-8, tolerance=1e-8)
    double = replace(tight, precision="float64")
    return (
        OptimiserModel(cell_mm, "10 iterations", max_iterations=10),
        OptimiserModel(cell_mm, "tolerance 1e-2", loop.Solving(tolerance=1e-2)),
        OptimiserModel(cell_mm, "tolerance 1e-8", tight),
        OptimiserModel(cell_mm, "tolerance 1e-8, float64", double),
        OptimiserModel(cell_mm, "plain hexahedra", loop.Solving(plain=True)),
    )


@dataclass(frozen=True)
class Optimised:
    """A finished optimisation and its surface on the disk.

    Attributes:
        target: the surface, for the judge; None where the density has none worth judging.
        own: what the optimiser's model says.
        unknowns: degrees of freedom of one solve.
        cells: number of cells.
        load_cases: solved together.
        iterations: designs evaluated.
        compile_seconds: JAX's compilation.
    """

    target: Target | None
    own: Assessment
    unknowns: int
    cells: int
    load_cases: int
    iterations: int
    compile_seconds: float


def optimise_once(scene: Scene, model: OptimiserModel, folder: Path) -> Optimised:
    """Optimise a scene as a rung says, without a run directory.

    Args:
        scene: the design.
        model: the rung.
        folder: for the surface.

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
        return Optimised(
            target, own, unknowns, nx * ny * nz, cases, len(found.state.history), clock.compile_s
        )


def solve_optimiser_level(scene: Scene, model: OptimiserModel) -> Level:
    """Optimise as a rung says, and judge the shape.

    Args:
        scene: the design.
        model: the rung.

    Raises:
        CranktopoError: an impossible scene or a failed solve.
    """
    memory, began = PeakMemory(), time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        found = optimise_once(scene, model, Path(folder))
        seconds, peak = time.perf_counter() - began, memory.MiB
        judged = _evaluated(found.target) if found.target else None
    return Level(
        ladder="optimiser",
        name=model.name,
        family="cells" if not model.label else model.label,
        settings={
            "cell_mm": model.cell_mm,
            **asdict(model.solving),
            "max_iterations": model.max_iterations,
            "iterations": found.iterations,
            "cells": found.cells,
            "load_cases": found.load_cases,
        },
        size_mm=model.cell_mm,
        unknowns=found.unknowns,
        seconds=seconds - found.compile_seconds,
        peak_memory_MiB=peak,
        values=_values(judged) if judged else {},
        band_percent=judged.error_percent if judged else 0.0,
        compile_seconds=found.compile_seconds,
        model={
            NAME_OF_CASE[c.name]: c.stiffness
            for c in found.own.cases
            if c.name in NAME_OF_CASE and c.stiffness is not None
        },
        spent_seconds=time.perf_counter() - began,
    )


def _evaluated(target: Target) -> Evaluation:
    size = default_element_size_mm(target.scene) * RATIO**_JUDGED_STEPS
    return evaluate(target, size)


def _values(found: Evaluation) -> dict[str, float]:
    """Both stiffnesses with the supports of the design, by the names of the tables."""
    return {TORSION: found.torsion_Nm_per_rad, BENDING: found.bending_N_per_mm}


def _surface(ready: stage.Prepared, design: loop.Design, folder: Path) -> Target | None:
    """The surface on the disk, or None where the density is too grey for one."""
    try:
        skin = checked_surface(ready.scene, ready.domain, design)
    except CranktopoError as error:
        if error.code != ExitCode.CRITERION_NOT_MET:
            raise
        return None
    path = folder / "web.stl"
    write_stl(path, skin.surface.half_throw)
    return Target(f"{ready.scene.name}, optimised", ready.scene, path)
