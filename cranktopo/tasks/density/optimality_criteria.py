"""Optimality-criteria update of the design variables under a volume constraint.

`x`: design variables (nx, ny, nw) in [0, 1]; `beta`: steepness of the projection; `by_moduli`, `by_solid`:
derivatives of the objective by the relative moduli and the solid fraction (nx, ny, nz).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp

from cranktopo.tasks.density.material import (
    MaterialInterpolation,
    dilated_density,
    eroded_density,
    physical_density,
    relative_moduli,
    solid_fraction,
    volume_fraction,
)

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
    """Return the derivatives of the objective and of the volume fraction by the design variables.

    Returns:
        Two arrays of the shape of x.
    """
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
    """Return one optimality-criteria step that meets the volume fraction of the physical density.

    Args:
        by_moduli: derivative of the objective by the relative moduli; never positive for compliance.
        by_solid: derivative of the objective by the solid fraction, when a case has a body force; where more
            mass does more harm than good the variable shrinks as fast as the move allows.

    Returns:
        New design variables.

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
    """Return the root of a function that falls from `low` to `high`; the end where it does not cross 0.

    Args:
        first: where the root is about.
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
