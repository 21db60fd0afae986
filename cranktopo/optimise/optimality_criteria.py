"""Optimality-criteria update of the design variables under a volume constraint.

`x`: design variables (nx, ny, nw) in [0, 1]; `beta`: steepness of the projection; `by_moduli`, `by_solid`:
derivatives of the objective by the relative moduli and the solid fraction (nx, ny, nz).
"""

from __future__ import annotations

from collections.abc import Callable

import jax
import jax.numpy as jnp

from cranktopo.optimise.material import (
    Interpolation,
    dilated_density,
    eroded_density,
    physical_density,
    relative_moduli,
    solid_fraction,
    volume_fraction,
)

_ROOT_ACCURACY = 1e-10
_ROOT_STEPS = 100
_Bracket = tuple[jax.Array, jax.Array, jax.Array, jax.Array, jax.Array]


def design_gradients(
    data: Interpolation,
    x: jax.Array,
    beta: jax.Array,
    by_moduli: jax.Array,
    by_solid: jax.Array | None = None,
) -> tuple[jax.Array, jax.Array]:
    """Derivatives of the objective and of the volume fraction by the design variables.

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
    data: Interpolation,
    x: jax.Array,
    beta: jax.Array,
    by_moduli: jax.Array,
    target: jax.Array,
    move: jax.Array,
    by_solid: jax.Array | None = None,
) -> jax.Array:
    """One optimality-criteria step that meets the volume fraction of the physical density.

    Args:
        by_moduli: derivative of the objective by the relative moduli; never positive for compliance.
        by_solid: derivative of the objective by the solid fraction, when a case has a body force; where more
            mass does more harm than good the variable shrinks as fast as the move allows.

    Returns:
        New design variables.

    Source: M. P. Bendsoe, Optimization of Structural Topology, Shape, and Material, 1995; the multiplier
    is bisected on the projected volume as in F. Wang et al., SMO 43, 2011.
    """
    by_x, volume_by_x = design_gradients(data, x, beta, by_moduli, by_solid)
    gain = jnp.maximum(0.0, -by_x) / jnp.where(volume_by_x > 0, volume_by_x, jnp.inf)
    low, high = jnp.maximum(x - move, 0.0), jnp.minimum(x + move, 1.0)
    top = jnp.log(jnp.max(gain))

    def candidate(multiplier: jax.Array) -> jax.Array:
        return jnp.clip(x * jnp.sqrt(gain / jnp.exp(multiplier)), low, high)

    def surplus(multiplier: jax.Array) -> jax.Array:
        return volume_fraction(data, physical_density(data, candidate(multiplier), beta)) - target

    return candidate(falling_root(surplus, top - 40.0, top + 10.0))


def falling_root(function: Callable[[jax.Array], jax.Array], low: jax.Array, high: jax.Array) -> jax.Array:
    """Root of a function that falls from positive at `low` to negative at `high`; the end where it does not.

    Secants and halvings take turns: the bracket always shrinks, and quickly where the function is smooth.
    The ends themselves are not evaluated, so that the function is compiled once.
    """

    def narrow(state: _Bracket) -> _Bracket:
        low, high, at_low, at_high, count = state
        drop = at_low - at_high  # infinite while an end is unknown
        share = jnp.where((count % 2 == 0) | jnp.isinf(drop), 0.5, at_low / drop)
        middle = low + (high - low) * share
        value = function(middle)
        low, at_low = jnp.where(value > 0, middle, low), jnp.where(value > 0, value, at_low)
        high, at_high = jnp.where(value > 0, high, middle), jnp.where(value > 0, at_high, value)
        return low, high, at_low, at_high, count + 1

    def open_(state: _Bracket) -> jax.Array:
        low, high, at_low, at_high, count = state
        near = jnp.minimum(at_low, -at_high) <= _ROOT_ACCURACY
        return (count < _ROOT_STEPS) & (high - low > _ROOT_ACCURACY) & ~near

    unknown = jnp.full_like(low, jnp.inf)
    first = low, high, unknown, -unknown, jnp.zeros((), jnp.int32)
    low, high, at_low, at_high, _ = jax.lax.while_loop(open_, narrow, first)
    nearer = jnp.where(at_low < -at_high, low, high)
    return jnp.where(jnp.isinf(at_high), high, jnp.where(jnp.isinf(at_low), low, nearer))
