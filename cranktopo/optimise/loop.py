"""The optimisation as init / step: pure functions from state to state."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from cranktopo.fem.equilibrium import Solution
from cranktopo.fem.model import case_forces
from cranktopo.fem.response import compliances, solve
from cranktopo.optimise.continuation import advance, tolerance_at
from cranktopo.optimise.material import (
    Interpolation,
    eroded_density,
    greyness,
    physical_density,
    relative_moduli,
    smooth_density,
    solid_fraction,
    volume_fraction,
)
from cranktopo.optimise.problem import DensityProblem
from cranktopo.optimise.responses import Design, on_material
from cranktopo.optimise.state import Record, State

Array = NDArray[np.float64]


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
    """The uniform start design."""
    x = np.full(problem.chain.design.shape, problem.start)
    displacements = np.zeros(problem.model.forces.shape)
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
    design, solution, volume, grey = _solved(problem, state)
    proposal = problem.method(problem, state, design)
    record = Record(
        iteration=len(state.history) + 1,
        beta=state.beta,
        objective=proposal.objective,
        compliance_N_mm=tuple(float(c) for c in design.works),
        volume_fraction=volume,
        greyness=grey,
        change=float(np.abs(proposal.x - state.x).max()),
        cg_iterations=int(solution.iterations),
        seconds=time.perf_counter() - started,
        notice=solution.notice,
        goals=proposal.goals,
        limits=proposal.limits,
        broken=proposal.broken,
    )
    advanced = replace(
        state,
        evaluated=state.x,
        displacements=np.asarray(solution.displacements),
        initial_N_mm=tuple(float(c) for c in design.first_works),
        history=(*state.history, record),
        memory=dict(proposal.memory),
    )
    return advance(problem, advanced, proposal.x)


def _solved(problem: DensityProblem, state: State) -> tuple[Design, Solution, float, float]:
    """The state's design under its loads, how it was solved, its volume fraction and greyness."""
    model = problem.model
    moduli, solid, volume, grey = _design(problem.chain, jnp.asarray(state.x), jnp.asarray(state.beta))
    forces = case_forces(model, solid)
    solution = solve(
        model,
        moduli,
        forces=forces,
        guess=jnp.asarray(state.displacements),
        tolerance=tolerance_at(problem, state.beta),
        precision=problem.solving.precision,
    )
    works = compliances(model, solution.displacements, forces)
    first = jnp.asarray(state.initial_N_mm) if state.initial_N_mm else works
    u = on_material(solution.displacements, moduli)
    return Design(moduli, solid, works, first, u), solution, float(volume), float(grey)


def final_design(problem: DensityProblem, state: State) -> WebDensities:
    """Densities of the last design evaluated."""
    return design_of(problem.chain, state.evaluated, state.last.beta)


def design_of(chain: Interpolation, x: Array, beta: float) -> WebDensities:
    """Densities of design variables at a projection steepness."""
    filtered, physical = _densities(chain, jnp.asarray(x), jnp.asarray(beta))
    return WebDensities(filtered=np.asarray(filtered), physical=np.asarray(physical))


@jax.jit
def _densities(chain: Interpolation, x: jax.Array, beta: jax.Array) -> tuple[jax.Array, jax.Array]:
    return smooth_density(chain, x) * (chain.design > 0), physical_density(chain, x, beta)


@jax.jit
def _design(
    chain: Interpolation, x: jax.Array, beta: jax.Array
) -> tuple[jax.Array, jax.Array, jax.Array, jax.Array]:
    density = physical_density(chain, x, beta)
    moduli = relative_moduli(chain, eroded_density(chain, x, beta))
    solid = solid_fraction(chain, density)
    return moduli, solid, volume_fraction(chain, density), greyness(chain, density)
