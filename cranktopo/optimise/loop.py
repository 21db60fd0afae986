"""The optimisation as init / step: pure functions from state to state."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from cranktopo.fem.model import ThrowModel, case_forces
from cranktopo.fem.response import (
    compliance_gradients,
    compliance_gradients_by_solid,
    compliances,
    solve,
)
from cranktopo.optimise.continuation import BETA_FIRST, advance, largest_move, tolerance_at
from cranktopo.optimise.material import (
    Interpolation,
    greyness,
    physical_density,
    relative_moduli,
    smooth_density,
    solid_fraction,
    volume_fraction,
)
from cranktopo.optimise.optimality_criteria import update
from cranktopo.optimise.problem import DensityProblem
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
    x = np.full(problem.chain.design.shape, problem.target)
    return State(x=x, evaluated=x, displacements=np.zeros(problem.model.forces.shape), beta=BETA_FIRST)


def step(problem: DensityProblem, state: State) -> State:
    """Evaluate the state's design, record it and update the design.

    Returns:
        The next state; converged or stopped ones keep the design that was evaluated last.

    Raises:
        CranktopoError: the linear solve failed.
    """
    started = time.perf_counter()
    model = problem.model
    beta = jnp.asarray(state.beta)
    x = jnp.asarray(state.x)
    moduli, solid, volume, grey = _design(problem.chain, x, beta)
    forces = case_forces(model, solid)
    guess = jnp.asarray(state.displacements)
    tolerance, precision = tolerance_at(problem.solving, state.beta), problem.solving.precision
    solution = solve(model, moduli, forces=forces, guess=guess, tolerance=tolerance, precision=precision)
    values = tuple(float(c) for c in compliances(model, solution.displacements, forces))
    initial = state.initial_N_mm or values
    factors = jnp.asarray([w / c for w, c in zip(problem.weights, initial, strict=True)])
    factors = factors / sum(problem.weights)
    by_moduli, by_solid = _slopes(model, solution.displacements, solid, factors)
    limits = jnp.asarray(problem.target), jnp.asarray(largest_move(state.beta))
    new_x = np.asarray(_update(problem.chain, x, beta, by_moduli, *limits, by_solid))
    record = Record(
        iteration=len(state.history) + 1,
        beta=state.beta,
        objective=float(jnp.dot(factors, jnp.asarray(values))),
        compliance_N_mm=values,
        volume_fraction=float(volume),
        greyness=float(grey),
        change=float(np.abs(new_x - state.x).max()),
        cg_iterations=int(solution.iterations),
        seconds=time.perf_counter() - started,
        notice=solution.notice,
    )
    advanced = replace(
        state,
        evaluated=state.x,
        displacements=np.asarray(solution.displacements),
        initial_N_mm=initial,
        history=(*state.history, record),
    )
    return advance(problem, advanced, new_x)


def _slopes(
    model: ThrowModel, u: jax.Array, solid: jax.Array, factors: jax.Array
) -> tuple[jax.Array, jax.Array | None]:
    """Derivative of the objective by the moduli, and by the solid where its own mass loads it."""
    by_moduli = jnp.einsum("b,bxyz->xyz", factors, compliance_gradients(model, u))
    if not model.spinning:
        return by_moduli, None
    each = compliance_gradients_by_solid(model, u, solid)
    return by_moduli, jnp.einsum("b,bxyz->xyz", factors, each)


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
    moduli, solid = relative_moduli(chain, density), solid_fraction(chain, density)
    return moduli, solid, volume_fraction(chain, density), greyness(chain, density)


_update = jax.jit(update)
