"""Fields on the way between a grid and the next coarser one: kernels on the processor, elsewhere JAX."""

from __future__ import annotations

from functools import partial

import jax
import jax.numpy as jnp

from cranktopo.numerics.grid.lattice import Cells
from cranktopo.numerics.kernels.registry import by_kernel, called


def restrict(field: jax.Array, nodes: Cells) -> jax.Array:
    """Return the transpose of trilinear interpolation: fine nodal forces to the next coarser grid.

    Args:
        nodes: node counts of the coarser grid; an axis with as many as the finer one stays as it is.
    """
    elsewhere = partial(_restricted, nodes=nodes)
    if not _halved(field.shape[2:], nodes):
        return elsewhere(field)

    def kernel(field: jax.Array) -> jax.Array:
        return called("restriction", [field], [(*field.shape[:2], *nodes)], field.dtype)[0]

    return by_kernel(kernel, elsewhere, field)


def add_prolonged(coarse: jax.Array, field: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Return the interpolation of a coarse field to the grid of a finer one, and the sum of both."""
    if not _halved(field.shape[2:], coarse.shape[2:]):
        return _add_prolonged(coarse, field)
    return by_kernel(_add_by_kernel, _add_prolonged, coarse, field)


def _add_by_kernel(coarse: jax.Array, field: jax.Array) -> tuple[jax.Array, jax.Array]:
    found, total = called("prolongation", [coarse, field], [field.shape] * 2, field.dtype)
    return found, total


def _add_prolonged(coarse: jax.Array, field: jax.Array) -> tuple[jax.Array, jax.Array]:
    found = prolong(coarse, (field.shape[2], field.shape[3], field.shape[4]))
    return found, field + found


def _halved(fine: tuple[int, ...], coarse: tuple[int, ...]) -> bool:
    """Tell whether the coarse grid has every second node along all axes."""
    return all(one == 2 * other - 1 for one, other in zip(fine, coarse, strict=True))


def _restricted(field: jax.Array, nodes: Cells) -> jax.Array:
    """Return the same as JAX code."""
    for axis, count in zip((2, 3, 4), nodes, strict=True):
        size = field.shape[axis]
        if size == count:
            continue
        even = jax.lax.slice_in_dim(field, 0, size, 2, axis)
        odd = jax.lax.slice_in_dim(field, 1, size, 2, axis) * 0.5
        low, high = [(0, 0)] * 5, [(0, 0)] * 5
        low[axis], high[axis] = (0, 1), (1, 0)
        field = even + jnp.pad(odd, low) + jnp.pad(odd, high)
    return field


def prolong(field: jax.Array, nodes: Cells) -> jax.Array:
    """Return the trilinear interpolation of a coarse field to the next finer grid.

    Args:
        nodes: node counts of the finer grid; an axis with as many as the coarser one stays as it is.
    """
    for axis, count in zip((4, 3, 2), reversed(nodes), strict=True):
        size = field.shape[axis]
        if size == count:
            continue
        near = jax.lax.slice_in_dim(field, 0, size - 1, 1, axis)
        far = jax.lax.slice_in_dim(field, 1, size, 1, axis)
        pairs = jnp.stack([near, (near + far) * 0.5], axis=axis + 1)
        shape = list(field.shape)
        shape[axis] = 2 * (size - 1)
        last = jax.lax.slice_in_dim(field, size - 1, size, 1, axis)
        field = jnp.concatenate([pairs.reshape(shape), last], axis=axis)
    return field
