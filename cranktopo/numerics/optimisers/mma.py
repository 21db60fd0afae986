"""Method of moving asymptotes: a step for any number of limits, by the dual of a separable subproblem.

    minimise f_0(x)  subject to  f_i(x) <= 0 (i = 1 ... m),  x between its bounds,

or, where an entry of `epigraph` is 1, with f_i(x) <= z and z minimised as well: the largest of several
functions. f_0 and f_i should be of the order of 1. `x`, its bounds and the gradients may have any shape; the
first axis of `gradients` counts the limits.

Source: K. Svanberg, The method of moving asymptotes, IJNME 24, 1987, with the constants of K. Svanberg, MMA
and GCMMA - two methods for nonlinear optimization, KTH, 2007. The dual is solved by an interior point method
in the m multipliers, as in N. Aage, B. S. Lazarov, Parallel framework for topology optimization using the
method of moving asymptotes, SMO 47, 2013: a step costs what some twenty passes over the gradients do.
"""

from __future__ import annotations

from typing import NamedTuple

import jax
import jax.numpy as jnp

# Asymptotes: distance at the start, largest and least distance, over the range of a variable; growth where
# a variable goes on in its direction, shrinkage where it turns back.
_FIRST, _WIDEST, _CLOSEST = 0.5, 10.0, 0.01
_GROW, _SHRINK = 1.2, 0.7
# A step stays so far from the asymptotes, as a share of the distance to them.
_AWAY = 0.1
# Curvature that every approximation gets: shares of the gradient, and of its mean over all variables.
_CURVED, _CURVED_MEAN = 1e-3, 1e-2
# Cost of violating a limit, which only a limit that cannot be met is worth.
_VIOLATION_COST = 1000.0
_EPIGRAPH_SPREAD = 10.0
_DUAL_STEPS, _DUAL_ACCURACY = 80, 1e-9


class Asymptotes(NamedTuple):
    """Memory of a step: asymptotes and the two last designs; number of steps taken."""

    low: jax.Array
    high: jax.Array
    last: jax.Array
    before: jax.Array
    steps: jax.Array


class MmaStep(NamedTuple):
    """A new design; multipliers (m,) of the limits are 0 where a limit is not active."""

    x: jax.Array
    asymptotes: Asymptotes
    multipliers: jax.Array


_DualState = tuple[jax.Array, jax.Array, jax.Array, jax.Array]


class _Subproblem(NamedTuple):
    """Sum of p / (high - x) + q / (x - low): row 0 of p and q is the objective, the others are the limits."""

    p: jax.Array
    q: jax.Array
    rest: jax.Array
    low: jax.Array
    high: jax.Array
    lowest: jax.Array
    highest: jax.Array
    epigraph: jax.Array


def first_asymptotes(x: jax.Array) -> Asymptotes:
    """Return the memory before the first step."""
    return Asymptotes(x, x, x, x, jnp.zeros((), jnp.int32))


@jax.jit
def mma_step(
    x: jax.Array,
    gradient: jax.Array,
    values: jax.Array,
    gradients: jax.Array,
    asymptotes: Asymptotes,
    move: jax.Array,
    bounds: tuple[jax.Array, jax.Array],
    epigraph: jax.Array,
) -> MmaStep:
    """Return the solution of the approximation about `x`.

    Args:
        values, gradients: the limits f_i (m,) and their derivatives.
        move: largest change of a variable.
        epigraph: (m,) 1 for the functions whose largest is minimised, 0 for limits.
    """
    shape = x.shape
    flat = [v.reshape(-1) for v in jnp.broadcast_arrays(x, *bounds)]
    memory = jax.tree.map(lambda v: v.reshape(-1), asymptotes)
    here, lowest, highest = flat
    low, high = _moved(here, highest - lowest, memory)
    all_gradients = jnp.concatenate([gradient.reshape(1, -1), gradients.reshape(len(values), -1)])
    problem = _approximation(here, (lowest, highest), (low, high), all_gradients, values, move, epigraph)
    multipliers = _solve_dual(problem)
    new = _minimiser(problem, multipliers)[0]
    fields = [v.reshape(shape) for v in (low, high, here, memory.last)]
    kept = Asymptotes(fields[0], fields[1], fields[2], fields[3], asymptotes.steps + 1)
    return MmaStep(new.reshape(shape), kept, multipliers)


def _moved(x: jax.Array, width: jax.Array, memory: Asymptotes) -> tuple[jax.Array, jax.Array]:
    trend = (x - memory.last) * (memory.last - memory.before)
    factor = jnp.where(trend > 0, _GROW, jnp.where(trend < 0, _SHRINK, 1.0))
    first = memory.steps[0] < 2
    below = jnp.where(first, _FIRST * width, factor * (memory.last - memory.low))
    above = jnp.where(first, _FIRST * width, factor * (memory.high - memory.last))
    near, far = _CLOSEST * width, _WIDEST * width
    return x - jnp.clip(below, near, far), x + jnp.clip(above, near, far)


def _approximation(
    x: jax.Array,
    bounds: tuple[jax.Array, jax.Array],
    asymptotes: tuple[jax.Array, jax.Array],
    gradients: jax.Array,
    values: jax.Array,
    move: jax.Array,
    epigraph: jax.Array,
) -> _Subproblem:
    (lowest, highest), (low, high) = bounds, asymptotes
    rising, falling = jnp.maximum(gradients, 0.0), jnp.maximum(-gradients, 0.0)
    size = jnp.abs(gradients)
    extra = _CURVED * size + _CURVED_MEAN * jnp.mean(size, axis=1, keepdims=True)
    p = (high - x) ** 2 * (rising + extra)
    q = (x - low) ** 2 * (falling + extra)
    at_x = jnp.sum(p / (high - x) + q / (x - low), axis=1)
    return _Subproblem(
        p=p,
        q=q,
        rest=at_x[1:] - values,
        low=low,
        high=high,
        lowest=jnp.maximum(jnp.maximum(lowest, low + _AWAY * (x - low)), x - move),
        highest=jnp.minimum(jnp.minimum(highest, high - _AWAY * (high - x)), x + move),
        epigraph=epigraph,
    )


def _minimiser(problem: _Subproblem, multipliers: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
    weights = jnp.concatenate([jnp.ones(1, multipliers.dtype), multipliers])
    p, q = weights @ problem.p, weights @ problem.q
    root_p, root_q = jnp.sqrt(p), jnp.sqrt(q)
    free = (root_p * problem.low + root_q * problem.high) / (root_p + root_q)
    return jnp.clip(free, problem.lowest, problem.highest), p, q


def _dual(problem: _Subproblem, multipliers: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Return the gradient of the dual (m,), less the violated part of the limits, and its Hessian (m, m)."""
    x, p, q = _minimiser(problem, multipliers)
    above, below = 1 / (problem.high - x), 1 / (x - problem.low)
    limits = jnp.sum(problem.p[1:] * above + problem.q[1:] * below, axis=1) - problem.rest
    gradients = problem.p[1:] * above**2 - problem.q[1:] * below**2
    curvature = 2 * p * above**3 + 2 * q * below**3
    free = (x > problem.lowest) & (x < problem.highest)
    hessian = -(gradients * (free / curvature)) @ gradients.T
    violation = jnp.maximum(multipliers - _VIOLATION_COST, 0.0)
    total = problem.epigraph @ multipliers
    level = jnp.maximum(0.0, _EPIGRAPH_SPREAD * (total - 1.0))
    gradient = limits - violation - level * problem.epigraph
    hessian -= jnp.diag((violation > 0).astype(x.dtype))
    pairs = jnp.outer(problem.epigraph, problem.epigraph)
    return gradient, hessian - jnp.where(level > 0, _EPIGRAPH_SPREAD, 0.0) * pairs


def _solve_dual(problem: _Subproblem) -> jax.Array:
    """Return multipliers that maximise the dual: Newton's method on its conditions with a falling barrier."""
    m = problem.p.shape[0] - 1

    def residual(multipliers: jax.Array, slack: jax.Array, gradient: jax.Array) -> jax.Array:
        return jnp.maximum(jnp.max(jnp.abs(gradient + slack)), jnp.max(multipliers * slack))

    def narrow(state: _DualState) -> _DualState:
        multipliers, slack, _, count = state
        gradient, hessian = _dual(problem, multipliers)
        barrier = 0.1 * jnp.mean(multipliers * slack)
        matrix = hessian - jnp.diag(slack / multipliers)
        step = jnp.linalg.solve(matrix, -(gradient + barrier / multipliers))
        slack_step = barrier / multipliers - slack - slack / multipliers * step
        # Neither multiplier nor slack may lose or gain more than a factor of about ten.
        falls = jnp.concatenate([-step / multipliers, -slack_step / slack])
        length = jnp.minimum(1.0, 0.95 / jnp.maximum(jnp.max(falls), 1e-30))
        multipliers = jnp.minimum(multipliers + length * step, 10 * multipliers + 1)
        slack = slack + length * slack_step
        return multipliers, slack, residual(multipliers, slack, _dual(problem, multipliers)[0]), count + 1

    def open_(state: _DualState) -> jax.Array:
        return (state[2] > _DUAL_ACCURACY) & (state[3] < _DUAL_STEPS)

    ones = jnp.ones(m, problem.p.dtype)
    first = (ones, ones, jnp.asarray(jnp.inf, problem.p.dtype), jnp.zeros((), jnp.int32))
    return jax.lax.while_loop(open_, narrow, first)[0]
