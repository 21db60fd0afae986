"""Levels of the optimiser, and the cell size for an accuracy or a time.

Levels differ in cell size, solver tolerance and precision, iterations, kind of hexahedron. Every level is a
whole optimisation; the stiffness of its shape is from the body-fitted evaluation, on the same meshes for all.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from statistics import median

import numpy as np

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.machine import forget_peak_memory, peak_memory_MiB
from cranktopo.base.notes import silent
from cranktopo.bodies.cells.domain import laterally_symmetric
from cranktopo.bodies.memory import (
    WALL_CELLS,
    available_memory_MiB,
    check_resolution,
    estimated_cells,
    optimiser_memory_MiB,
    thinnest_wall_mm,
)
from cranktopo.design.goal.scene_goal import goal_of
from cranktopo.design.halves import default_element_size_mm
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.cost import CostRates, ExpectedWork, effort
from cranktopo.engine.plan.planning import plan
from cranktopo.engine.plan.simulated import apply_physics_plan
from cranktopo.engine.states import load_cases
from cranktopo.numerics.precision import CompileClock, double_precision
from cranktopo.numerics.surfaces.files import write_stl
from cranktopo.numerics.tetrahedra.mesh import RATIO
from cranktopo.tasks.density import loop, stage
from cranktopo.tasks.density.assess import assess
from cranktopo.tasks.density.problem import Assessment, SolverSettings, model_error_percent
from cranktopo.tasks.extraction.checked_surface import checked_surface
from cranktopo.tasks.throw_fea.evaluation import evaluate
from cranktopo.tasks.throw_fea.levels import EvaluationMesh, expected_seconds
from cranktopo.tasks.throw_fea.studies import (
    BENDING,
    NAME_OF_CASE,
    OPTIMISER,
    TORSION,
    Level,
    LevelResult,
    PlannedLevel,
    StoredStudy,
)
from cranktopo.tasks.throw_fea.targets import Target

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
    """Return sizes that double the number of cells; after three of them every other setting at the second.

    Walls so thin that only the finest cells hold them leave one size or none, and no second one.
    """
    sizes = cell_sizes(scene)
    plain = [OptimiserModel(size) for size in sizes]
    return (*plain[:3], *(_settings(sizes[1]) if len(sizes) > 1 else ()), *plain[3:])


def cell_sizes(scene: Scene) -> list[float]:
    """Return sizes that double the number of cells, coarsest first, from the coarsest that walls allow, mm.

    The scene's own resolution is one of them where the walls allow it.
    """
    coarsest = thinnest_wall_mm(scene) / WALL_CELLS
    sizes = [scene.optimise.resolution_mm * 2 ** (step / 3) for step in range(_STEPS, -_STEPS, -1)]
    return [size for size in sizes if size <= coarsest]


def _settings(cell_mm: float) -> tuple[OptimiserModel, ...]:
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
    """A finished optimisation; its target is None where the density is too grey for a surface."""

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
    """Return the levels of a scene that has an envelope, in the order of `optimiser_models`."""

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
        with silent():
            shape = found.target and evaluate(
                found.target, default_element_size_mm(found.target.scene) * RATIO
            )
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


_START_S = 13.0
"""Compiling and writing files where nothing was measured, roughly."""


@dataclass(frozen=True)
class CellChoice:
    """A largest cell edge, the error bound of both stiffnesses, the expected wall time and its source."""

    cell_mm: float
    error_percent: float
    seconds: float
    source: str

    def __str__(self) -> str:
        return (
            f"cells of {self.cell_mm:.3g} mm: stiffness +-{self.error_percent:.2g} %, about "
            f"{self.seconds:.2g} s ({self.source})"
        )


def choose_cells(
    scene: Scene, percent: float | None, budget_s: float | None, measured: StoredStudy | None = None
) -> CellChoice:
    """Return the coarsest cells for a largest error of the stiffnesses, or the finest for a wall time.

    Raises:
        CranktopoError: out of reach of the memory, the budget, or both together.
    """
    choices = _choices(scene, measured)
    if percent is not None:
        choice = _for_accuracy(choices, percent)
        if budget_s is not None and choice.seconds > budget_s:
            within = _for_budget(choices, budget_s)
            raise CranktopoError(
                f"--accuracy {percent:g}% takes about {choice.seconds:.2g} s, --budget is {budget_s:g} s.",
                hint=f"That is enough for {within.error_percent:.2g} % with {within}.",
                code=ExitCode.USAGE,
            )
        return choice
    assert budget_s is not None, "one of the two is asked for"
    return _for_budget(choices, budget_s)


def _for_accuracy(choices: list[CellChoice], percent: float) -> CellChoice:
    fit = [choice for choice in choices if choice.error_percent <= percent]
    if not fit:
        best = choices[-1]
        raise CranktopoError(
            f"--accuracy {percent:g}%: the finest cells that fit into the memory, {best.cell_mm:.3g} mm, "
            f"give {best.error_percent:.2g} %.",
            hint="Evaluate the result with 'cranktopo evaluate RUN --accuracy', which is more exact.",
            code=ExitCode.USAGE,
        )
    return fit[0]


def _for_budget(choices: list[CellChoice], budget_s: float) -> CellChoice:
    fit = [choice for choice in choices if choice.seconds <= budget_s]
    if not fit:
        raise CranktopoError(
            f"--budget {budget_s:g}s: the coarsest cells, {choices[0].cell_mm:.3g} mm, take about "
            f"{choices[0].seconds:.2g} s ({choices[0].source}).",
            hint="Give more time.",
            code=ExitCode.USAGE,
        )
    return fit[-1]


def _choices(scene: Scene, measured: StoredStudy | None) -> list[CellChoice]:
    """Return the usable cell sizes, coarsest first; CranktopoError where walls or memory allow none."""
    effects = plan(scene, goal=goal_of(scene))
    simulated = apply_physics_plan(scene, effects)
    quarter, cases = laterally_symmetric(simulated, "envelope"), len(load_cases(simulated, effects.enabled))
    sizes, available = cell_sizes(simulated), available_memory_MiB()
    usable = [cell for cell in sizes if optimiser_memory_MiB(simulated, cell, quarter, cases) <= available]
    if not usable:
        nearest = sizes[0] if sizes else scene.optimise.resolution_mm
        check_resolution(simulated, nearest, cases, available)
    found, todo = [], effort(simulated)
    for cell in usable:
        cells = estimated_cells(simulated, cell, quarter)
        error = max(model_error_percent(simulated, cell).values())
        seconds, source = _seconds(cells, cases * todo.designs, todo, measured)
        found.append(CellChoice(cell, error, seconds + _evaluating_s(todo, measured), source))
    return found


def _evaluating_s(todo: ExpectedWork, measured: StoredStudy | None) -> float:
    each = expected_seconds(EvaluationMesh(0, graded=True), measured, triangles=True)
    return todo.evaluation_seconds if each is None else todo.evaluations * each


def _seconds(
    cells: float, solves: int, todo: ExpectedWork, measured: StoredStudy | None
) -> tuple[float, str]:
    """Return the wall time of the optimiser for load cases times designs of an iteration, and its source."""
    levels = [r for r in measured.levels(OPTIMISER) if r.family == "cells"] if measured else []
    if measured is None or not levels:
        iterations = todo.iterations + todo.more_iterations
        seconds = _START_S + iterations * solves * CostRates().solve_s(cells)
        return seconds, "not measured here: run cranktopo accuracy"
    work = cells * solves
    sizes, times = np.array(sorted(_timed(level, todo) for level in levels)).T
    inside = float(np.exp(np.interp(np.log(work), np.log(sizes), np.log(times))))
    beyond = max(1.0, work / float(sizes[-1]))
    compiling = median(level.compile_seconds for level in levels)
    return measured.slowdown * (inside * beyond + compiling), f"measured on {measured.design}"


def _timed(level: LevelResult, todo: ExpectedWork) -> tuple[float, float]:
    settings = level.settings
    work = settings["cells"] * settings["load_cases"] * settings.get("designs", 1)  # older studies have one
    return work, level.seconds * (1 + todo.more_iterations / settings["iterations"])
