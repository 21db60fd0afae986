"""Projection: a smoothed step that drives filtered densities to void or solid."""

from __future__ import annotations

from dataclasses import dataclass

import jax
import jax.numpy as jnp

THRESHOLD = 0.5


@dataclass(frozen=True)
class Projection:
    """Thresholds of the three designs that one filtered density stands for.

    Attributes:
        nominal: of the design itself.
        eroded: of the thinner design that has the stiffness; above that where members must not get thin.
        dilated: of the thicker design whose volume is limited; below that where gaps must not get narrow.

    Source: F. Wang, B. S. Lazarov, O. Sigmund, On projection methods, SMO 43, 2011.
    """

    nominal: float = THRESHOLD
    eroded: float = THRESHOLD
    dilated: float = THRESHOLD


def projected(density: jax.Array, beta: float | jax.Array, threshold: float = THRESHOLD) -> jax.Array:
    """Return the smoothed Heaviside projection, not below 0; steeper with beta.

    Source: F. Wang, B. S. Lazarov, O. Sigmund, On projection methods, SMO 43, 2011, equation 9.
    """
    low = jnp.tanh(beta * threshold)
    high = jnp.tanh(beta * (1.0 - threshold))
    step = (low + jnp.tanh(beta * (density - threshold))) / (low + high)
    # Rounding may leave void below 0, of which no fractional power exists; its slope stays.
    return step + jax.lax.stop_gradient(jnp.maximum(step, 0.0) - step)
