"""Sums over the slabs of a grid, one after the other: where all of it at once would take too much memory."""

from __future__ import annotations

from collections.abc import Callable

import jax

# More would save little: one slab is then an eighth of what else is kept.
_MOST_SLABS = 8


def add_slabs(
    total: jax.Array, layers: int, part: Callable[[jax.Array, int], jax.Array], axis: int, first: int = 0
) -> jax.Array:
    """A nodal array plus the parts of slabs of equal depth along x; neighbours share a plane of nodes.

    Args:
        layers: number of layers of cells along x.
        part: from a slab's first layer and its depth to what it adds to its depth + 1 planes.
        axis: of `total` along x.
        first: planes of `total` before those of the grid.
    """
    slabs = max(count for count in range(1, _MOST_SLABS + 1) if layers % count == 0)
    depth = layers // slabs

    def add(number: jax.Array, total: jax.Array) -> jax.Array:
        start = number * depth
        there = jax.lax.dynamic_slice_in_dim(total, first + start, depth + 1, axis)
        return jax.lax.dynamic_update_slice_in_dim(total, there + part(start, depth), first + start, axis)

    return jax.lax.fori_loop(0, slabs, add, total)
