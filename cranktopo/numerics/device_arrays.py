"""Arrays of NumPy as arrays of JAX, without a program of its own for every shape."""

from __future__ import annotations

import jax
import numpy as np
from numpy.typing import ArrayLike


def on_device(values: ArrayLike) -> jax.Array:
    """Return a copy of values as an array of JAX, float64 inside `double_precision()`.

    Outside of traced functions `jnp.asarray` and `jnp.zeros` compile a program for every new shape, 10 ms
    each. What JAX is given it may share: without the copy, a change of the values would change the array.
    """
    return jax.device_put(np.array(values))


def zeros_like(array: jax.Array) -> jax.Array:
    """Return zeros in the shape and precision of an array, which nothing else shares."""
    return jax.device_put(np.zeros(array.shape, array.dtype))
