"""Ways to the next design: optimality criteria for a volume alone, moving asymptotes for any limits.

Each takes a solved design and proposes the next design variables; the loop and its continuation know no more.
"""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.numerics.optimisers.mma import Asymptotes, first_asymptotes, mma_step
from cranktopo.tasks.density.continuation import largest_move, tolerance_at
from cranktopo.tasks.density.material import (
    MaterialInterpolation,
    dilated_density,
    eroded_density,
    relative_moduli,
    solid_fraction,
)
from cranktopo.tasks.density.model import ThrowModel
from cranktopo.tasks.density.optimality_criteria import update
from cranktopo.tasks.density.problem import DensityProblem
from cranktopo.tasks.density.response import compliance_gradients, compliance_gradients_by_solid, solve
from cranktopo.tasks.density.responses import Design, gradients, loads_of, values_of
from cranktopo.tasks.density.state import Proposal, State

# Share of a miss that the next step aims further, and the largest such margin, as shares of the limit.
_GAIN, _LARGEST_MARGIN = 0.5, 0.01


def by_optimality_criteria(problem: DensityProblem, state: State, design: Design, eroded: Design) -> Proposal:
    """Take a step for the weighted sum of compliances at a volume fraction."""
    factors = jnp.asarray(
        [w / float(c) for w, c in zip(problem.weights, design.reference_compliances, strict=True)]
    )
    factors = factors / sum(problem.weights)
    by_moduli, by_solid = _objective_gradients(problem.model, eroded, factors)
    limits = jnp.asarray(problem.target), jnp.asarray(largest_move(problem.schedule, state.beta))
    x = jnp.asarray(state.x)
    new = _update(problem.density_chain, x, jnp.asarray(state.beta), by_moduli, *limits, by_solid)
    return Proposal(np.asarray(new), float(jnp.dot(factors, design.compliances)))


def compile_optimality_criteria(problem: DensityProblem) -> None:
    """Compile the step ahead of its first call, such as beside the first solve."""
    number = jnp.asarray(0.5)
    x, cells = (
        jax.ShapeDtypeStruct(shape, number.dtype)
        for shape in (problem.density_chain.design_fraction.shape, problem.model.lattice.cells)
    )
    by_solid = cells if problem.model.spinning else None
    _update.lower(problem.density_chain, x, number, cells, number, number, by_solid).compile()


def _objective_gradients(
    model: ThrowModel, design: Design, factors: jax.Array
) -> tuple[jax.Array, jax.Array | None]:
    """Return the derivative of the objective by the moduli, and by the solid where its own mass loads it."""
    by_moduli = jnp.einsum("b,bxyz->xyz", factors, compliance_gradients(model, design.displacements))
    if not model.spinning:
        return by_moduli, None
    each = compliance_gradients_by_solid(model, design.displacements, design.solid)
    return by_moduli, jnp.einsum("b,bxyz->xyz", factors, each)


def by_moving_asymptotes(problem: DensityProblem, state: State, design: Design, eroded: Design) -> Proposal:
    """Take a step for any goals and limits."""
    optimisation = problem.optimisation
    adjoints = _adjoints(problem, state, eroded)
    values, by_moduli, by_solid = gradients(problem.model, optimisation.functions, eroded, adjoints)
    if eroded is not design:
        values = values_of(optimisation.functions, design)
    x, beta = jnp.asarray(state.x), jnp.asarray(state.beta)
    by_x = vjp(problem.density_chain, x, beta, by_moduli, by_solid)
    several = len(optimisation.goals) if optimisation.worst_of_several else 0
    gradient, rest = (jnp.zeros_like(x), slice(0, None)) if several else (by_x[0], slice(1, None))
    epigraph = jnp.asarray([1.0] * several + [0.0] * len(optimisation.limits))
    bounds = jnp.zeros_like(x), jnp.ones_like(x)
    memory = _remembered(state, x)
    move = jnp.asarray(largest_move(problem.schedule, state.beta))
    margins = _margins(problem, state, values[rest], epigraph)
    taken = mma_step(x, gradient, values[rest] + margins, by_x[rest], memory, move, bounds, epigraph)
    new = jnp.where(problem.density_chain.design_fraction > 0, taken.x, x)
    goals = len(optimisation.goals)
    reached = tuple(float(r.value(design)) for r in optimisation.responses)
    kept = {name: np.asarray(value) for name, value in taken.asymptotes._asdict().items()}
    kept["margins"] = np.asarray(margins)
    kept |= {f"adjoint_{index}": np.asarray(u) for index, u in adjoints.items()}
    return Proposal(
        x=np.asarray(new),
        objective=float(jnp.max(values[:goals])),
        goals=reached[:goals],
        limits=reached[goals:],
        broken=float(jnp.max(values[goals:], initial=-jnp.inf)),
        memory=kept,
    )


def _margins(problem: DensityProblem, state: State, values: jax.Array, epigraph: jax.Array) -> jax.Array:
    """Return margins of the limits at the final projection, where steps keep missing them to one side."""
    if not state.memory or state.beta < problem.schedule.projection_last:
        return jnp.zeros_like(values)
    before = jnp.asarray(state.memory["margins"])
    return jnp.clip(before + _GAIN * values, 0.0, _LARGEST_MARGIN) * (1 - epigraph)


def _remembered(state: State, x: jax.Array) -> Asymptotes:
    if not state.memory:
        return first_asymptotes(x)
    return Asymptotes(*(jnp.asarray(state.memory[name]) for name in Asymptotes._fields))


def _adjoints(problem: DensityProblem, state: State, design: Design) -> dict[int, jax.Array]:
    """Solve for the responses that read displacements; each starts from that of the last design."""
    found = {}
    optimisation = problem.optimisation
    for index, (response, function) in enumerate(
        zip(optimisation.responses, optimisation.functions, strict=True)
    ):
        if response.reads_displacements:
            guess = state.memory.get(f"adjoint_{index}")
            found[index] = solve(
                problem.model,
                design.moduli,
                forces=loads_of(function, design),
                guess=None if guess is None else jnp.asarray(guess),
                tolerance=tolerance_at(problem, state.beta),
                precision=problem.solving.precision,
            ).displacements
    return found


@jax.jit
def vjp(
    density_chain: MaterialInterpolation,
    x: jax.Array,
    beta: jax.Array,
    by_moduli: jax.Array,
    by_solid: jax.Array,
) -> jax.Array:
    """Return derivatives (k, nx, ny, nw) by design variables of k functions of moduli and solid fraction."""

    def fields(x: jax.Array) -> tuple[jax.Array, jax.Array]:
        moduli = relative_moduli(density_chain, eroded_density(density_chain, x, beta))
        return moduli, solid_fraction(density_chain, dilated_density(density_chain, x, beta))

    _, pull = jax.vjp(fields, x)
    return jax.vmap(lambda *by: pull(by)[0])(by_moduli, by_solid)


_update = jax.jit(update)
