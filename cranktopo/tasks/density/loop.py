"""The optimisation as init / step: pure functions from state to state."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.numerics.grid.equilibrium import Solution
from cranktopo.tasks.density.continuation import advance, tolerance_at
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
from cranktopo.tasks.density.state import Record, State


@dataclass(frozen=True)
class WebDensities:
    """Densities of a design on the cells of the web's layers (nx, ny, nw), 0 outside the design space.

    Attributes:
        filtered: smooth density before the projection.
        physical: projected density, which has stiffness and mass.
    """

    filtered: Array
    physical: Array


def init(problem: DensityProblem) -> State:
    """Return the uniform start design."""
    x = np.full(problem.density_chain.design_fraction.shape, problem.start)
    cases, *nodes = problem.model.forces.shape
    displacements = np.zeros((cases if problem.density_chain.projection == PLAIN else 2 * cases, *nodes))
    return State(x=x, evaluated=x, displacements=displacements, beta=problem.schedule.projection_first)


def step(problem: DensityProblem, state: State) -> State:
    """Evaluate the state's design, record it and update the design.

    Returns:
        The next state; converged or stopped ones keep the design that was evaluated last.

    Raises:
        CranktopoError: the linear solve failed.
    """
    started = time.perf_counter()
    problem = problem.with_bounds(state.bounds)
    design, eroded, solutions, volume, grey = _solved(problem, state)
    proposal = problem.method(problem, state, design, eroded)
    record = Record(
        iteration=len(state.history) + 1,
        beta=state.beta,
        objective=proposal.objective,
        compliance_N_mm=tuple(float(c) for c in design.compliances),
        volume_fraction=volume,
        greyness=grey,
        change=float(np.abs(proposal.x - state.x).max()),
        cg_iterations=sum(int(solution.iterations) for solution in solutions),
        seconds=time.perf_counter() - started,
        notice=next((solution.notice for solution in solutions if solution.notice), ""),
        goals=proposal.goals,
        limits=proposal.limits,
        broken=proposal.broken,
    )
    advanced = replace(
        state,
        evaluated=state.x,
        displacements=np.concatenate([np.asarray(solution.displacements) for solution in solutions]),
        initial_N_mm=tuple(float(c) for c in design.reference_compliances),
        history=(*state.history, record),
        memory=dict(proposal.memory),
    )
    return advance(problem, advanced, proposal.x)


class _Solved(NamedTuple):
    """The design as it is made, its eroded and dilated form, and how they were solved."""

    design: Design
    eroded: Design
    solutions: tuple[Solution, ...]
    volume_fraction: float
    greyness: float


def _solved(problem: DensityProblem, state: State) -> _Solved:
    """Return the state's design under its loads; also the eroded and dilated one where it is another."""
    density_chain, x, beta = problem.density_chain, jnp.asarray(state.x), jnp.asarray(state.beta)
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
    """Return a design under its loads, and how it was solved."""
    model = problem.model
    forces = case_forces(model, solid)
    solution = solve(
        model,
        moduli,
        forces=forces,
        guess=jnp.asarray(guess),
        tolerance=tolerance_at(problem, state.beta),
        precision=problem.solving.precision,
    )
    found = compliances(model, solution.displacements, forces)
    first = jnp.asarray(state.initial_N_mm) if state.initial_N_mm else found
    u = on_material(solution.displacements, moduli)
    return Design(moduli, solid, found, first, u), solution


def final_design(problem: DensityProblem, state: State) -> WebDensities:
    """Return the densities of the last design evaluated."""
    return design_of(problem.density_chain, state.evaluated, state.last.beta)


def design_of(density_chain: MaterialInterpolation, x: Array, beta: float) -> WebDensities:
    """Return the densities of design variables at a projection steepness."""
    filtered, physical = _densities(density_chain, jnp.asarray(x), jnp.asarray(beta))
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
