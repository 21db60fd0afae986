"""The cell size of an optimisation for an accuracy or a time."""

from __future__ import annotations

from dataclasses import dataclass
from statistics import median

import numpy as np

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.bodies.cells.domain import laterally_symmetric
from cranktopo.bodies.memory import (
    available_memory_MiB,
    check_resolution,
    estimated_cells,
    optimiser_memory_MiB,
)
from cranktopo.design.goal.wanted import wanted
from cranktopo.design.schema import Scene
from cranktopo.engine.cases import load_cases
from cranktopo.engine.plan.cost import CostRates, ExpectedWork, effort
from cranktopo.engine.plan.planning import plan
from cranktopo.engine.plan.simulated import simulated_scene
from cranktopo.tasks.accuracy.optimiser_levels import cell_sizes
from cranktopo.tasks.density.assessment import model_error_percent
from cranktopo.tasks.fea.error_target import expected_seconds
from cranktopo.tasks.fea.level import OPTIMISER
from cranktopo.tasks.fea.levels import EvaluationMesh
from cranktopo.tasks.fea.stored_studies import StoredStudy
from cranktopo.tasks.fea.study_result import LevelResult

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
    """The coarsest cells for a largest error of the printed stiffnesses, or the finest for a wall time.

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
    """Usable cell sizes, coarsest first; at least one.

    Raises:
        CranktopoError: the walls ask for finer cells than there are, or none fit into the memory.
    """
    effects = plan(scene, goal=wanted(scene))
    simulated = simulated_scene(scene, effects)
    quarter, cases = laterally_symmetric(simulated, "envelope"), len(load_cases(simulated, effects.enabled))
    sizes, available = cell_sizes(simulated), available_memory_MiB()
    usable = [cell for cell in sizes if optimiser_memory_MiB(simulated, cell, quarter, cases) <= available]
    if not usable:
        nearest = sizes[0] if sizes else scene.optimise.resolution_mm
        check_resolution(simulated, nearest, quarter, cases, available)
    found, todo = [], effort(simulated)
    for cell in usable:
        cells = estimated_cells(simulated, cell, quarter)
        error = max(model_error_percent(simulated, cell).values())
        seconds, source = _seconds(cells, cases * todo.designs, todo, measured)
        found.append(CellChoice(cell, error, seconds + _evaluating_s(todo, measured), source))
    return found


def _evaluating_s(todo: ExpectedWork, measured: StoredStudy | None) -> float:
    """Expected wall time of the body-fitted evaluations, which have elements of the default size."""
    each = expected_seconds(EvaluationMesh(0, graded=True), measured, triangles=True)
    return todo.evaluation_seconds if each is None else todo.evaluations * each


def _seconds(
    cells: float, solves: int, todo: ExpectedWork, measured: StoredStudy | None
) -> tuple[float, str]:
    """Expected wall time of the optimiser and what it is taken from.

    Args:
        solves: load cases times designs of an iteration.
    """
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
    """Cells times load cases times designs of a measured level; its seconds with the iterations to come."""
    settings = level.settings
    work = settings["cells"] * settings["load_cases"] * settings.get("designs", 1)  # older studies have one
    return work, level.seconds * (1 + todo.more_iterations / settings["iterations"])
