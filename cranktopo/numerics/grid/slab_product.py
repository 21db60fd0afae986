"""Product of the stiffness with displacement fields as JAX code, slab by slab along x."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

# More would save little: one slab is then an eighth of what else is kept. Below so many numbers a slab is too
# little work for the cores, and what it takes is small anyway.
_MOST_SLABS, _LEAST_NUMBERS = 8, 750_000


def apply_by_slabs(blocks: jax.Array, moduli: jax.Array, field: jax.Array) -> jax.Array:
    """Return the product slab by slab along x: sums of the whole grid would take the most memory."""

    def part(start: int | jax.Array, depth: int) -> jax.Array:
        cells = jax.lax.dynamic_slice_in_dim(moduli, start, depth)
        return _apply_to_slab(blocks, cells, jax.lax.dynamic_slice_in_dim(field, start, depth + 1, 2))

    return add_slabs(jnp.zeros_like(field), moduli.shape[0], part, axis=2)


def _apply_to_slab(blocks: jax.Array, moduli: jax.Array, field: jax.Array) -> jax.Array:
    # A ring of cells without stiffness around the grid: sums of slices then need no edges, at which XLA
    # stops using vectors. Without the barriers it recomputes sums and products once per corner.
    ring, edges = ((1, 1),) * 3, ((0, 0),) * 3
    field = jnp.pad(field, (*edges[:2], *ring))
    sums = jax.lax.optimization_barrier(parity_sums(jax.lax.optimization_barrier(field)))
    products = _multiply_blocks(jnp.pad(blocks, (*edges, ring[0])), jnp.pad(moduli, ring), sums)
    return _parity_sums_transposed(jax.lax.optimization_barrier(products))


def parity_sums(field: jax.Array) -> jax.Array:
    """Return sums and differences over the corners of each cell, by parity class: (cases, 8, 3, cells...).

    Along its own direction a component changes places: entry [p, c] is sum p xor e_c. One operation per
    axis on all components and classes together: single sums would need four times as many programs.
    """
    sums = field[:, None]
    for axis in range(3):
        size = sums.shape[3 + axis]
        near = jax.lax.slice_in_dim(sums, 0, size - 1, axis=3 + axis)
        far = jax.lax.slice_in_dim(sums, 1, size, axis=3 + axis)
        pair = far[:, :, None] + _signs(axis, field.dtype) * near[:, :, None]
        sums = pair.reshape(field.shape[0], -1, 3, *near.shape[3:])
    return sums


def _parity_sums_transposed(sums: jax.Array) -> jax.Array:
    """Return transpose of `parity_sums` without its outermost nodes: inner nodes have cells on all sides."""
    for axis in (2, 1, 0):
        pair = sums.reshape(sums.shape[0], -1, 2, *sums.shape[2:])
        first, second = pair[:, :, 0], pair[:, :, 1]
        near = _signs(axis, sums.dtype)[0] * (first - second)
        size = near.shape[3 + axis]
        later = jax.lax.slice_in_dim(near, 1, size, axis=3 + axis)
        sums = later + jax.lax.slice_in_dim(first + second, 0, size - 1, axis=3 + axis)
    return sums[:, 0]


def _signs(axis: int, dtype: jnp.dtype[Any]) -> jax.Array:
    """Return sign of the near corner along an axis, for both classes and every component: (2, 3, 1, 1, 1)."""
    signs = np.ones((2, 3))
    signs[0, axis] = -1
    signs[1] = -signs[0]
    return jnp.asarray(signs[..., None, None, None], dtype)


def _multiply_blocks(blocks: jax.Array, moduli: jax.Array, sums: jax.Array) -> jax.Array:
    columns = blocks.astype(sums.dtype)[:, :, :, None, None, :]
    return moduli * sum(
        (columns[:, :, d] * sums[:, :, d, None] for d in range(1, 3)),
        start=columns[:, :, 0] * sums[:, :, 0, None],
    )


def add_slabs(
    total: jax.Array, layers: int, part: Callable[[int | jax.Array, int], jax.Array], axis: int
) -> jax.Array:
    """Return a nodal array plus the parts of slabs of equal depth along x; neighbours share a plane of nodes.

    A part is a function of a slab's first layer and its depth: what it adds to its depth + 1 planes.
    """
    most = max(1, min(_MOST_SLABS, total.size // _LEAST_NUMBERS))
    slabs = max(count for count in range(1, most + 1) if layers % count == 0)
    depth = layers // slabs

    def add(number: int | jax.Array, total: jax.Array) -> jax.Array:
        start = number * depth
        there = jax.lax.dynamic_slice_in_dim(total, start, depth + 1, axis)
        return jax.lax.dynamic_update_slice_in_dim(total, there + part(start, depth), start, axis)

    return add(0, total) if slabs == 1 else jax.lax.fori_loop(0, slabs, add, total)
