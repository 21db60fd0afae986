"""The density optimisation in memory: scene -> plan -> load cases -> domain -> density.

A fine optimisation begins with the design of cells twice as large, an eighth of the work. The filter, whose
radius stays that of the fine cells, keeps designs alike on both; the fine cells repeat the last stages.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.notes import at_work, note
from cranktopo.bodies.cells.domain import Domain, build_domain, on_cells
from cranktopo.bodies.cells.outside import outside_envelope, outside_words
from cranktopo.bodies.envelope_file import symmetrised
from cranktopo.bodies.memory import WALL_CELLS, available_memory_MiB, check_resolution, thinnest_wall_mm
from cranktopo.design.goal.limit import goal_text
from cranktopo.design.goal.scene_goal import check_known, goal_of
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.schema import Scene
from cranktopo.engine.load_case import LoadCase
from cranktopo.engine.load_type import load_type
from cranktopo.engine.performance import note_pressure
from cranktopo.engine.plan.effect import PhysicsPlan
from cranktopo.engine.plan.planning import left_off, note_left_off, plan
from cranktopo.engine.plan.simulated import apply_physics_plan
from cranktopo.engine.states import load_cases
from cranktopo.tasks.density import loop
from cranktopo.tasks.density.build import build_problem
from cranktopo.tasks.density.manufacturing import (
    LEAST_CELLS,
    check_lengths,
    filter_radius_mm,
    length_notice,
    unreachable_share,
)
from cranktopo.tasks.density.problem import USUAL_SOLVING, DensityProblem, Progress, SolverSettings
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
    """Return the first state: a design from larger cells where they will do, else a uniform one.

    Call inside `double_precision()`; `progress` is called after every iteration on the larger cells.
    """
    coarser = coarse_scene(scene, domain)
    if coarser is None:
        return loop.init(problem)
    began, schedule = time.perf_counter(), problem.schedule
    there = build_domain(coarser, coarser.optimise.resolution_mm)
    coarse = build_problem(coarser, there, cases, problem.solving)
    state = loop.init(coarse)
    while not state.done:
        with at_work(f"iteration {len(state.history) + 1} on larger cells"):
            state = loop.step(coarse, state)
        progress(coarse, state)
    x = interpolated(state.x, np.asarray(coarse.density_chain.design_fraction), there, domain)
    coarse_start = CoarseStart(there.grid.largest_edge_mm, len(state.history), time.perf_counter() - began)
    beta = max(schedule.projection_first, schedule.projection_last / 2**_SOFTER)
    start = replace(loop.init(problem), x=x, evaluated=x, beta=beta)
    return replace(start, initial_N_mm=state.initial_N_mm, coarse_start=coarse_start)


def interpolated(x: Array, design: Array, there: Domain, here: Domain) -> Array:
    """Return the design variables on other cells, trilinear between the centres of cells that have any.

    Args:
        x, design: variables and designable fractions of the web's cells (nx, ny, nw) of `there`.
    """
    weighted, weight = np.moveaxis(on_cells(there, np.stack([x * design, design], axis=-1), here), -1, 0)
    return np.clip(np.divide(weighted, weight, out=np.zeros_like(weight), where=weight > 0), 0.0, 1.0)


_WORTH_SAYING = 1e-3
"""Share of the design space below which a lost part of it is left unsaid."""


@dataclass(frozen=True)
class Prepared:
    """A validated scene with everything the optimisation needs, before anything is written.

    Attributes:
        scene: the scene as it is simulated, without what the plan leaves out.
        notices: what a user may not expect, in sentences.
    """

    scene: Scene
    plan: PhysicsPlan
    cases: tuple[LoadCase, ...]
    domain: Domain
    notices: tuple[str, ...] = ()


def prepare(scene: DesignLike) -> Prepared:
    """Check a scene for optimisation and build its load cases and domain."""
    scene = as_scene(scene, whole=False)
    goal = goal_of(scene)
    if goal is not None:
        check_known(goal, "density")
    effects = plan(scene, goal=goal)
    scene = apply_physics_plan(scene, effects)
    cases = load_cases(scene, effects.enabled)
    resolution = scene.optimise.resolution_mm
    check_resolution(scene, resolution, len(cases), available_memory_MiB())
    check_lengths(scene)
    domain = build_domain(scene, resolution)
    return Prepared(scene, effects, cases, domain, notices(scene, domain))


@dataclass(frozen=True)
class Optimum:
    """A finished density optimisation."""

    problem: DensityProblem
    state: State
    design: loop.WebDensities


def optimise_density(
    prepared: Prepared, solving: SolverSettings = USUAL_SOLVING, progress: Progress = lambda *_: None
) -> Optimum:
    """Optimise the web of a prepared scene in memory; call inside `double_precision()`.

    Raises:
        CranktopoError: solver failure.
    """
    problem = build_problem(prepared.scene, prepared.domain, prepared.cases, solving)
    first = first_state(problem, prepared.scene, prepared.domain, prepared.cases, progress)
    state = iterate(problem, first, progress)
    return Optimum(problem, state, loop.final_design(problem, state))


def iterate(problem: DensityProblem, state: State, progress: Progress = lambda *_: None) -> State:
    """Return the state at the end of the optimisation; `progress` is called after every iteration."""
    while not state.done:
        with at_work(f"iteration {len(state.history) + 1}"):
            state = loop.step(problem, state)
        progress(problem, state)
    return state


def note_model(prepared: Prepared) -> None:
    """Pass on what is going to be solved, for what goal, and what a user may not expect of it."""
    scene = prepared.scene
    note(_model_text(prepared))
    goal = goal_of(scene)
    if goal is not None:
        note(goal_text(goal, "density"))
    note_left_off(scene.name, left_off(scene, prepared.plan))
    note_pressure(scene.name, scene)
    for notice in prepared.notices:
        note(f"note: {notice}.")


def _model_text(prepared: Prepared) -> str:
    """Return one line about the model: cells, cell size, padding, symmetry, load cases."""
    grid = prepared.domain.grid
    sizes = " x ".join(f"{step.max():.3g}" for step in grid.steps_mm)
    nx, ny, nz = grid.cells
    loads = ", ".join(_load_text(case) for case in prepared.cases)
    coarser = coarse_scene(prepared.scene, prepared.domain)
    first = "" if coarser is None else f"; first on cells of {coarser.optimise.resolution_mm:.3g} mm"
    return (
        f"{prepared.scene.name}: {prepared.domain.extent} model, {nx} x {ny} x {nz} cells of {sizes} mm, "
        f"padded by {grid.padding[0]}, {grid.padding[1]}, {grid.padding[2]} cells for {grid.levels} "
        f"multigrid levels{first}; {loads}"
    )


def _load_text(case: LoadCase) -> str:
    if load_type(case.kind).turns:
        return f"{case.name} {case.torque_Nm:,.1f} N m"
    return f"{case.name} {(case.radial_N or case.tangential_N) / 1000:,.2f} kN"


def notices(scene: Scene, domain: Domain) -> tuple[str, ...]:
    """Return sentences about the envelope, the die, the filter and the web that gains are measured against.

    Args:
        scene: as it is simulated, without what the plan leaves out.
        domain: its cells.
    """
    outside = outside_words(outside_envelope(scene))
    found = (
        _sides(scene),
        _die(scene, domain),
        length_notice(scene, domain),
        baseline_notice(scene),
        outside,
    )
    return tuple(sentence for sentence in found if sentence)


def _sides(scene: Scene) -> str:
    envelope = scene.envelope
    if envelope is None or envelope.shape != "stl" or not envelope.symmetric:
        return ""
    return symmetrised(Path(envelope.file))


def _die(scene: Scene, domain: Domain) -> str:
    if scene.effects.manufacturing_constraint != "on":
        return ""
    share = unreachable_share(scene, domain)
    if share < _WORTH_SAYING:
        return ""
    return (
        f"{scene.optimise.process}: {100 * share:.1f} % of the envelope's volume is left out, because voids "
        "of the envelope lie between it and the parting plane x = 0 (only holes right through along the "
        "crank axis are drilled afterwards)"
    )


def baseline_notice(scene: Scene) -> str:
    """Say what "original" means where it is a body from CAD, or the envelope is one; else empty."""
    if scene.original is not None:
        return f"the original web is that of the body in '{Path(scene.original.file).name}' ([original])"
    if scene.envelope is None or scene.envelope.shape != "stl":
        return ""
    return (
        "the original web is that of [web] in the design, not the body in "
        f"'{Path(scene.envelope.file).name}', which is the envelope only; [original] file = ... names a body"
    )
