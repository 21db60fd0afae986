"""A fine optimisation that begins with the design of cells twice as large, an eighth of the work.

The filter, whose radius stays that of the fine cells, keeps designs alike on both. The design variables are
interpolated, and the fine cells repeat the last stages.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.bodies.cells.domain import Domain, build_domain, on_cells
from cranktopo.bodies.memory import WALL_CELLS, thinnest_wall_mm
from cranktopo.design.schema import Scene
from cranktopo.engine.load_case import LoadCase
from cranktopo.tasks.density import loop
from cranktopo.tasks.density.build import build_problem
from cranktopo.tasks.density.length_scale import LEAST_CELLS, filter_radius_mm
from cranktopo.tasks.density.problem import DensityProblem, Progress
from cranktopo.tasks.density.state import CoarseStart, State

# Below so many cells the programs of a second grid take longer to compile than they save.
_FINE_CELLS = 200_000
# Radius of the filter over the large cells: with less, they would see another problem.
_LEAST_RADIUS = 1.5
# Doublings by which the projection is softer again where the fine cells begin: with fewer the objective may
# end more than 0.1 % worse, with more it gains little (`python -m tests.benchmarks.coarse_start`).
_SOFTER = 2


def coarse_scene(scene: Scene, domain: Domain) -> Scene | None:
    """Return scene on cells twice as large; None where few cells or a short length leave nothing to gain."""
    cell, radius = 2 * scene.optimise.resolution_mm, filter_radius_mm(scene, domain)
    lengths = (scene.optimise.min_member_mm, scene.optimise.min_gap_mm)
    fits = (
        domain.design_fraction.size >= _FINE_CELLS
        and cell * _LEAST_RADIUS <= radius
        and cell * WALL_CELLS <= thinnest_wall_mm(scene)
        and all(length is None or cell * LEAST_CELLS <= length for length in lengths)
    )
    return scene.with_optimise(resolution_mm=cell, filter_radius_mm=radius) if fits else None


def first_state(
    problem: DensityProblem,
    scene: Scene,
    domain: Domain,
    cases: Sequence[LoadCase],
    progress: Progress = lambda *_: None,
) -> State:
    """Return state before the first iteration: a design from larger cells where they will do, else uniform.

    Call inside `double_precision()`.

    Args:
        progress: called after every iteration on the larger cells.

    Raises:
        CranktopoError: solver failure.
    """
    coarser = coarse_scene(scene, domain)
    if coarser is None:
        return loop.init(problem)
    began, schedule = time.perf_counter(), problem.schedule
    there = build_domain(coarser, coarser.optimise.resolution_mm)
    coarse = build_problem(coarser, there, cases, problem.solving)
    state = loop.init(coarse)
    while not state.done:
        state = loop.step(coarse, state)
        progress(coarse, state)
    x = interpolated(state.x, np.asarray(coarse.density_chain.design_fraction), there, domain)
    told = CoarseStart(there.grid.largest_edge_mm, len(state.history), time.perf_counter() - began)
    beta = max(schedule.projection_first, schedule.projection_last / 2**_SOFTER)
    start = replace(loop.init(problem), x=x, evaluated=x, beta=beta)
    return replace(start, initial_N_mm=state.initial_N_mm, coarse_start=told)


def interpolated(x: Array, design: Array, there: Domain, here: Domain) -> Array:
    """Return the design variables on other cells, trilinear between the centres of cells that have any.

    Args:
        x, design: variables and designable fractions of the web's cells (nx, ny, nw) of `there`.
    """
    weighted, weight = np.moveaxis(on_cells(there, np.stack([x * design, design], axis=-1), here), -1, 0)
    return np.clip(np.divide(weighted, weight, out=np.zeros_like(weight), where=weight > 0), 0.0, 1.0)
