"""Ways to the next design: optimality criteria for a volume alone, moving asymptotes for any limits.

Each takes a solved design and proposes the next design variables; the loop knows no more.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.numerics.device_arrays import on_device
from cranktopo.numerics.kept_programs import kept_program
from cranktopo.numerics.optimisers.mma import Asymptotes, first_asymptotes, mma_step
from cranktopo.tasks.density.material import (
    MaterialInterpolation,
    dilated_density,
    eroded_density,
    physical_density,
    relative_moduli,
    solid_fraction,
    volume_fraction,
)
from cranktopo.tasks.density.model import ThrowModel
from cranktopo.tasks.density.problem import DensityProblem, OptimisationProblem
from cranktopo.tasks.density.response import compliance_gradients, compliance_gradients_by_solid, solve
from cranktopo.tasks.density.responses import Design, gradients, loads_of, values_of
from cranktopo.tasks.density.state import Proposal, State

_ROOT_ACCURACY = 1e-10
_ROOT_STEPS = 100
# Of the logarithm of the multiplier, from the first guess to the other side of the root.
_FIRST_STEP = 0.5


def design_gradients(
    data: MaterialInterpolation,
    x: jax.Array,
    beta: jax.Array,
    by_moduli: jax.Array,
    by_solid: jax.Array | None = None,
) -> tuple[jax.Array, jax.Array]:
    """Return the derivatives of the objective and of the volume fraction by the design variables."""
    _, pull_objective = jax.vjp(lambda v: relative_moduli(data, eroded_density(data, v, beta)), x)
    _, pull_volume = jax.vjp(lambda v: volume_fraction(data, dilated_density(data, v, beta)), x)
    by_x = pull_objective(by_moduli)[0]
    if by_solid is not None:
        _, pull_solid = jax.vjp(lambda v: solid_fraction(data, dilated_density(data, v, beta)), x)
        by_x = by_x + pull_solid(by_solid)[0]
    return by_x, pull_volume(jnp.ones((), x.dtype))[0]


def update(
    data: MaterialInterpolation,
    x: jax.Array,
    beta: jax.Array,
    by_moduli: jax.Array,
    target: jax.Array,
    move: jax.Array,
    by_solid: jax.Array | None = None,
) -> jax.Array:
    """Return the design variables of one optimality-criteria step that meets the physical volume fraction.

    The derivative by the moduli is never positive for compliance. Where more mass does more harm than good,
    as with a body force, the variable shrinks as fast as the move allows.

    Source: M. P. Bendsoe, Optimization of Structural Topology, Shape, and Material, 1995; the multiplier
    is searched by the projected volume as in F. Wang et al., SMO 43, 2011.
    """
    by_x, volume_by_x = design_gradients(data, x, beta, by_moduli, by_solid)
    gain = jnp.maximum(0.0, -by_x) / jnp.where(volume_by_x > 0, volume_by_x, jnp.inf)
    low, high = jnp.maximum(x - move, 0.0), jnp.minimum(x + move, 1.0)
    top = jnp.log(jnp.max(gain))
    # Where nothing is projected and no bound is met, this one keeps the volume.
    about = 2 * jnp.log(jnp.sum(x * jnp.sqrt(gain)) / jnp.sum(x))

    def candidate(multiplier: jax.Array) -> jax.Array:
        return jnp.clip(x * jnp.sqrt(gain / jnp.exp(multiplier)), low, high)

    def surplus(multiplier: jax.Array) -> jax.Array:
        return volume_fraction(data, physical_density(data, candidate(multiplier), beta)) - target

    return candidate(falling_root(surplus, top - 40.0, top + 10.0, about))


class _Bracket(NamedTuple):
    """Two points on both sides of a root, and the values there; infinite while there is none.

    Attributes:
        weight_low, weight_high: values that the next secant goes through.
        side: which point the last step replaced: 1 the low one, -1 the high one, 0 before the first step.
    """

    low: jax.Array
    high: jax.Array
    at_low: jax.Array
    at_high: jax.Array
    weight_low: jax.Array
    weight_high: jax.Array
    side: jax.Array
    evaluations: jax.Array

    def next_point(self, first: jax.Array) -> jax.Array:
        """Bracket the root: by longer and longer steps to its other side, then by secants."""
        span = self.high - self.low
        reach = jnp.minimum(_FIRST_STEP * 2.0**self.evaluations, span / 2)
        over, under = jnp.isfinite(self.at_low), jnp.isfinite(self.at_high)
        outwards = jnp.where(over, self.low + reach, jnp.where(under, self.high - reach, first))
        secant = self.low + span * self.weight_low / (self.weight_low - self.weight_high)
        return jnp.where(over & under, secant, outwards)

    def with_value(self, point: jax.Array, value: jax.Array) -> _Bracket:
        """Return the bracket with a point for the one on its side.

        Where that side has been replaced twice running, the other one's value counts less.

        Source: N. Anderson, A. Bjoerck, A new high order method of regula falsi type, BIT 13, 1973.
        """
        low = value > 0
        side = jnp.where(low, 1, -1).astype(self.side.dtype)
        replaced = jnp.where(low, self.at_low, self.at_high)
        share = 1 - value / replaced
        share = jnp.where(side == self.side, jnp.where(share > 0, share, 0.5), 1.0)
        return _Bracket(
            low=jnp.where(low, point, self.low),
            high=jnp.where(low, self.high, point),
            at_low=jnp.where(low, value, self.at_low),
            at_high=jnp.where(low, self.at_high, value),
            weight_low=jnp.where(low, value, self.weight_low * share),
            weight_high=jnp.where(low, self.weight_high * share, value),
            side=side,
            evaluations=self.evaluations + 1,
        )


def falling_root(
    function: Callable[[jax.Array], jax.Array], low: jax.Array, high: jax.Array, first: jax.Array
) -> jax.Array:
    """Return the root, about `first`, of a function that falls from `low` to `high`.

    It is the end where the function does not cross 0.
    """

    def narrow(now: _Bracket) -> _Bracket:
        point = now.next_point(first)
        return now.with_value(point, function(point))

    def is_open(now: _Bracket) -> jax.Array:
        near = jnp.minimum(now.at_low, -now.at_high) <= _ROOT_ACCURACY
        return (now.evaluations < _ROOT_STEPS) & (now.high - now.low > _ROOT_ACCURACY) & ~near

    first = jnp.clip(first, low, high)
    unknown, none = jnp.full_like(low, jnp.inf), jnp.zeros((), jnp.int32)
    start = _Bracket(low, high, unknown, -unknown, unknown, -unknown, none, none)
    end = jax.lax.while_loop(is_open, narrow, start)
    nearer = jnp.where(end.at_low < -end.at_high, end.low, end.high)
    return jnp.where(jnp.isinf(end.at_high), end.high, jnp.where(jnp.isinf(end.at_low), end.low, nearer))


# Share of a miss that the next step aims further, and the largest such margin, as shares of the limit.
_GAIN, _LARGEST_MARGIN = 0.5, 0.01


def by_optimality_criteria(problem: DensityProblem, state: State, design: Design, eroded: Design) -> Proposal:
    """Take a step for the weighted sum of compliances at a volume fraction."""
    factors = np.asarray(problem.weights) / np.asarray(design.reference_compliances) / sum(problem.weights)
    by_moduli, by_solid = _objective_gradients(problem.model, eroded, factors)
    limits = problem.target, problem.schedule.largest_move(state.beta)
    new = _update(problem.density_chain, state.x, state.beta, by_moduli, *limits, by_solid)
    return Proposal(np.asarray(new), float(factors @ np.asarray(design.compliances)))


def compile_optimality_criteria(problem: DensityProblem) -> None:
    """Compile the step ahead of its first call, such as beside the first solve."""
    number = 0.5
    x, cells = (
        jax.ShapeDtypeStruct(shape, float)
        for shape in (problem.density_chain.design_fraction.shape, problem.model.lattice.cells)
    )
    by_solid = cells if problem.model.spinning else None
    _update.begin(problem.density_chain, x, number, cells, number, number, by_solid).compile()


def _objective_gradients(
    model: ThrowModel, design: Design, factors: Array
) -> tuple[jax.Array, jax.Array | None]:
    by_moduli = _weighted(factors, compliance_gradients(model, design.displacements))
    if not model.spinning:
        return by_moduli, None
    each = compliance_gradients_by_solid(model, design.displacements, design.solid)
    return by_moduli, _weighted(factors, each)


def by_moving_asymptotes(problem: DensityProblem, state: State, design: Design, eroded: Design) -> Proposal:
    """Take a step for any goals and limits."""
    optimisation = problem.optimisation
    adjoints = _adjoints(problem, state, eroded)
    values, by_moduli, by_solid = gradients(problem.model, optimisation.functions, eroded, adjoints)
    x, beta = on_device(state.x), state.beta
    by_x = vjp(problem.density_chain, x, beta, by_moduli, by_solid)
    if eroded is not design:
        of_eroded, values = values, values_of(optimisation.functions, design)
        by_x *= _ratios(optimisation, values, of_eroded)[:, None, None, None]
    several = len(optimisation.goals) if optimisation.worst_of_several else 0
    gradient, rest = (jnp.zeros_like(x), slice(0, None)) if several else (by_x[0], slice(1, None))
    epigraph = on_device([1.0] * several + [0.0] * len(optimisation.limits))
    bounds = jnp.zeros_like(x), jnp.ones_like(x)
    memory = _remembered(state, x)
    move = problem.schedule.largest_move(state.beta)
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
        violation=float(jnp.max(values[goals:], initial=-jnp.inf)),
        memory=kept,
    )


def _ratios(optimisation: OptimisationProblem, values: jax.Array, of_eroded: jax.Array) -> jax.Array:
    """Return the factors that make slopes of the eroded design those of the same share of the design's.

    Where a thin member of the eroded design comes apart, its compliance is many times that of the design; a
    step by its own slopes would mend a broken limit of the design by next to nothing.
    """
    from_zero = on_device([0.0] * len(optimisation.goals) + [1.0] * len(optimisation.limits))
    own, other = values + from_zero, of_eroded + from_zero
    return jnp.where((own > 0) & (other > 0), own / jnp.where(other > 0, other, 1.0), 1.0)


def _margins(problem: DensityProblem, state: State, values: jax.Array, epigraph: jax.Array) -> jax.Array:
    """Return margins of the limits at the final projection, where steps keep missing them to one side."""
    if not state.memory or state.beta < problem.schedule.projection_last:
        return jnp.zeros_like(values)
    before = on_device(state.memory["margins"])
    return jnp.clip(before + _GAIN * values, 0.0, _LARGEST_MARGIN) * (1 - epigraph)


def _remembered(state: State, x: jax.Array) -> Asymptotes:
    if not state.memory:
        return first_asymptotes(x)
    return Asymptotes(*(on_device(state.memory[name]) for name in Asymptotes._fields))


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
                guess=None if guess is None else on_device(guess),
                tolerance=problem.tolerance_at(state.beta),
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


_update = kept_program()(update)
_weighted = jax.jit(partial(jnp.einsum, "b,bxyz->xyz"))
