"""Sums over the slabs of a grid, one after the other: where all of it at once would take too much memory."""

from __future__ import annotations

from collections.abc import Callable

import jax

# More would save little: one slab is then an eighth of what else is kept. Below so many numbers a slab is too
# little work for the cores, and what it takes is small anyway.
_MOST_SLABS, _LEAST_NUMBERS = 8, 750_000


def add_slabs(
    total: jax.Array,
    layers: int,
    part: Callable[[int | jax.Array, int], jax.Array],
    axis: int,
) -> jax.Array:
    """Return a nodal array plus the parts of slabs of equal depth along x; neighbours share a plane of nodes.

    Args:
        layers: number of layers of cells along x.
        part: from a slab's first layer and its depth to what it adds to its depth + 1 planes.
        axis: of `total` along x.
    """
    most = max(1, min(_MOST_SLABS, total.size // _LEAST_NUMBERS))
    slabs = max(count for count in range(1, most + 1) if layers % count == 0)
    depth = layers // slabs

    def add(number: int | jax.Array, total: jax.Array) -> jax.Array:
        start = number * depth
        there = jax.lax.dynamic_slice_in_dim(total, start, depth + 1, axis)
        return jax.lax.dynamic_update_slice_in_dim(total, there + part(start, depth), start, axis)

    return add(0, total) if slabs == 1 else jax.lax.fori_loop(0, slabs, add, total)
