"""The optimisation as init / step, and when the projection gets steeper and the optimisation ends.

All are pure functions from state to state.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import jax
import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.numerics.device_arrays import on_device
from cranktopo.numerics.grid.equilibrium import Solution
from cranktopo.numerics.optimisers.mma import Asymptotes
from cranktopo.tasks.density.material import (
    PLAIN,
    MaterialInterpolation,
    dilated_density,
    eroded_density,
    greyness,
    physical_density,
    relative_moduli,
    smooth_density,
    solid_fraction,
    volume_fraction,
)
from cranktopo.tasks.density.model import case_forces
from cranktopo.tasks.density.problem import DensityProblem
from cranktopo.tasks.density.response import compliances, solve
from cranktopo.tasks.density.responses import Design, on_material
from cranktopo.tasks.density.state import ARRAY_FIELDS, MovedBounds, Record, State, damaged

# A stage has settled, and the last one converged, when the objective changes by less over the window.
STAGE_PLATEAU, FINAL_PLATEAU = 5e-3, 1e-3
_WINDOW = 3
# The volume may differ by the first, as a share of the design space; a limit may be broken by the second.
FEASIBILITY, LIMIT_FEASIBILITY = 1e-3, 2e-3
_GREYNESS_LIMIT = 0.15
# No design is found for all limits when over so many iterations the worst comes no nearer than by this
# share; another start may find one, so it is no proof that they exclude each other. Below the last, a matter
# of the steps alone.
STUCK_WINDOW, STUCK, STUCK_LEAST = 6, 0.8, 1e-2


def _advance(problem: DensityProblem, state: State, new_x: Array) -> State:
    """Return the next design, its projection, and whether the evaluated one ends the run."""
    schedule, last = problem.schedule, state.last
    in_stage = len(state.history) - state.stage_start
    plateau = _plateau(state, in_stage) if in_stage > _WINDOW else np.inf
    beta, stage_start = state.beta, state.stage_start
    if beta < schedule.projection_last and (plateau < STAGE_PLATEAU or in_stage >= schedule.stage_iterations):
        beta, stage_start = min(2 * beta, schedule.projection_last), len(state.history)
    following = replace(state, x=new_x, beta=beta, stage_start=stage_start)
    settled = last.beta >= schedule.projection_last and plateau < FINAL_PLATEAU
    if settled and _feasible(problem, last) and last.greyness <= _GREYNESS_LIMIT:
        reason = (
            f"objective changed by less than {100 * FINAL_PLATEAU:g} % over {_WINDOW} iterations, "
            f"{_kept(problem)}, greyness {last.greyness:.3f} at most {_GREYNESS_LIMIT:g}"
        )
        return replace(following, status="converged", reason=reason)
    if _stuck(problem, state, in_stage):
        reason = (
            f"no design was found that meets every limit, the last one breaks {_violations(problem, last)}"
        )
        return replace(following, status="infeasible", reason=reason)
    if len(state.history) >= problem.max_iterations:
        reason = f"iteration limit {problem.max_iterations} reached before the objective settled"
        violations = _violations(problem, last)
        reason += f"; limits not met: {violations}" if violations else ""
        return replace(following, status="stopped", reason=reason)
    return following


def _feasible(problem: DensityProblem, last: Record) -> bool:
    full = problem.target is None or abs(last.volume_fraction - problem.target) <= FEASIBILITY
    return full and last.broken <= LIMIT_FEASIBILITY


def _kept(problem: DensityProblem) -> str:
    if problem.target is not None:
        return f"volume fraction within {FEASIBILITY:g} of its target"
    return f"every limit within {100 * LIMIT_FEASIBILITY:g} %"


def _violations(problem: DensityProblem, last: Record) -> str:
    pairs = zip(problem.optimisation.limits, last.limits, strict=False)
    texts = [
        f"{limit}: reached {limit.value_text(value)}"
        for limit, value in pairs
        if limit.constraint.violation(value) > LIMIT_FEASIBILITY
    ]
    return ", ".join(texts)


def _stuck(problem: DensityProblem, state: State, in_stage: int) -> bool:
    """Tell whether broken limits have come no nearer during two windows at the final projection."""
    last = state.last
    if last.beta < problem.schedule.projection_last or last.broken <= STUCK_LEAST:
        return False
    recent = [row.broken for row in state.history[-in_stage:]]
    if len(recent) < 2 * STUCK_WINDOW:
        return False
    return min(recent[-STUCK_WINDOW:]) > STUCK * min(recent[:-STUCK_WINDOW])


def with_limit(problem: DensityProblem, state: State) -> State:
    """Set a stopped state running again when the problem's iteration limit allows more."""
    if state.status == "stopped" and len(state.history) < problem.max_iterations:
        return replace(state, status="running", reason="")
    return state


def with_bounds(state: State, bounds: Sequence[float]) -> State:
    """Set a converged state running again at the same projection, its limits at new bounds."""
    now = MovedBounds(state.last.iteration, tuple(bounds))
    return replace(
        state, status="running", reason="", stage_start=len(state.history), rounds=(*state.rounds, now)
    )


def iterations_left(problem: DensityProblem, state: State) -> int:
    """Return the upper estimate of the iterations still needed, for the progress display."""
    schedule = problem.schedule
    stages = 1 + math.ceil(math.log2(schedule.projection_last / state.beta))
    in_stage = len(state.history) - state.stage_start
    left = max(1, stages * schedule.stage_iterations - in_stage)
    return min(problem.max_iterations - len(state.history), left)


def _plateau(state: State, in_stage: int) -> float:
    recent = [row.objective for row in state.history[-min(_WINDOW + 1, in_stage) :]]
    return (max(recent) - min(recent)) / abs(recent[-1])


@dataclass(frozen=True)
class WebDensities:
    """Densities on the cells of the web's layers (nx, ny, nw), 0 outside the design space.

    `filtered` is smooth, before the projection; `physical` is projected and has stiffness and mass.
    """

    filtered: Array
    physical: Array


def init(problem: DensityProblem) -> State:
    """Return the uniform start design."""
    x = np.full(problem.density_chain.design_fraction.shape, problem.start)
    cases, *nodes = problem.model.forces.shape
    displacements = np.zeros((cases if problem.density_chain.projection == PLAIN else 2 * cases, *nodes))
    return State(x=x, evaluated=x, displacements=displacements, beta=problem.schedule.projection_first)


def check_fits(problem: DensityProblem, state: State) -> None:
    """Check that a stored state is one of this problem; raises CranktopoError."""
    first, limits = init(problem), len(problem.optimisation.limits)
    arrays = [(getattr(state, name), getattr(first, name)) for name in ARRAY_FIELDS]
    arrays += [(state.memory.get(name), first.x) for name in Asymptotes._fields[:-1] if state.memory]
    if state.memory:
        several = problem.optimisation.worst_of_several
        margins = np.zeros(len(problem.optimisation.functions) - (not several))
        arrays += [(state.memory.get("margins"), margins)]
    rows = [(len(row.compliance_N_mm), len(row.limits)) for row in state.history]
    if any(found is None or found.shape != own.shape for found, own in arrays):
        raise damaged("its arrays are those of another design")
    counted = state.stage_start <= len(rows) and len(state.bounds) in (0, limits)
    alike = set(rows) in ({(len(problem.model.cases), limit_count)} for limit_count in (0, limits))
    if not counted or not alike:
        raise damaged("its history is that of another design")


def step(problem: DensityProblem, state: State) -> State:
    """Evaluate the state's design, record it and update the design.

    Converged or stopped states keep the design that was evaluated last.
    """
    started = time.perf_counter()
    problem = problem.with_bounds(state.bounds)
    design, eroded, solutions, volume, grey = _solved(problem, state)
    proposal = problem.method(problem, state, design, eroded)
    record = Record(
        iteration=len(state.history) + 1,
        beta=state.beta,
        objective=proposal.objective,
        compliance_N_mm=tuple(np.asarray(design.compliances).tolist()),
        volume_fraction=volume,
        greyness=grey,
        change=float(np.abs(proposal.x - state.x).max()),
        cg_iterations=sum(int(solution.iterations) for solution in solutions),
        seconds=time.perf_counter() - started,
        notice=next((solution.notice for solution in solutions if solution.notice), ""),
        goals=proposal.goals,
        limits=proposal.limits,
        broken=proposal.violation,
    )
    advanced = replace(
        state,
        evaluated=state.x,
        displacements=np.concatenate([np.asarray(solution.displacements) for solution in solutions]),
        initial_N_mm=tuple(np.asarray(design.reference_compliances).tolist()),
        history=(*state.history, record),
        memory=dict(proposal.memory),
    )
    return _advance(problem, advanced, proposal.x)


class _Solved(NamedTuple):
    """The design as it is made, its eroded and dilated form, and how they were solved."""

    design: Design
    eroded: Design
    solutions: tuple[Solution, ...]
    volume_fraction: float
    greyness: float


def _solved(problem: DensityProblem, state: State) -> _Solved:
    """Return the state's design under its loads; also the eroded and dilated one where it is another."""
    density_chain, x, beta = problem.density_chain, state.x, state.beta
    moduli, solid, volume, grey = _nominal(density_chain, x, beta)
    cases = len(problem.model.cases)
    design, solution = _loaded(problem, state, moduli, solid, state.displacements[:cases])
    if density_chain.projection == PLAIN:
        return _Solved(design, design, (solution,), float(volume), float(grey))
    moduli, solid = _eroded(density_chain, x, beta)
    eroded, other = _loaded(problem, state, moduli, solid, state.displacements[cases:])
    eroded = eroded._replace(reference_compliances=design.reference_compliances)
    return _Solved(design, eroded, (solution, other), float(volume), float(grey))


def _loaded(
    problem: DensityProblem, state: State, moduli: jax.Array, solid: jax.Array, guess: Array
) -> tuple[Design, Solution]:
    model = problem.model
    forces = case_forces(model, solid)
    solution = solve(
        model,
        moduli,
        forces=forces,
        guess=on_device(guess),
        tolerance=problem.tolerance_at(state.beta),
        precision=problem.solving.precision,
    )
    found = compliances(model, solution.displacements, forces)
    first = on_device(state.initial_N_mm) if state.initial_N_mm else found
    u = on_material(solution.displacements, moduli)
    return Design(moduli, solid, found, first, u), solution


def final_design(problem: DensityProblem, state: State) -> WebDensities:
    """Return the densities of the last design evaluated."""
    return design_of(problem.density_chain, state.evaluated, state.last.beta)


def design_of(density_chain: MaterialInterpolation, x: Array, beta: float) -> WebDensities:
    """Return the densities of design variables at a projection steepness."""
    filtered, physical = _densities(density_chain, x, beta)
    return WebDensities(filtered=np.asarray(filtered), physical=np.asarray(physical))


@jax.jit
def _densities(
    density_chain: MaterialInterpolation, x: jax.Array, beta: jax.Array
) -> tuple[jax.Array, jax.Array]:
    return smooth_density(density_chain, x) * (density_chain.design_fraction > 0), physical_density(
        density_chain, x, beta
    )


@jax.jit
def _nominal(
    density_chain: MaterialInterpolation, x: jax.Array, beta: jax.Array
) -> tuple[jax.Array, jax.Array, jax.Array, jax.Array]:
    """Return the moduli, solid fraction, volume fraction and greyness of the design itself."""
    density = physical_density(density_chain, x, beta)
    moduli, solid = relative_moduli(density_chain, density), solid_fraction(density_chain, density)
    return moduli, solid, volume_fraction(density_chain, density), greyness(density_chain, density)


@jax.jit
def _eroded(
    density_chain: MaterialInterpolation, x: jax.Array, beta: jax.Array
) -> tuple[jax.Array, jax.Array]:
    """Return the moduli of the eroded design and solid fraction of the dilated one."""
    moduli = relative_moduli(density_chain, eroded_density(density_chain, x, beta))
    return moduli, solid_fraction(density_chain, dilated_density(density_chain, x, beta))
