"""Matrix-free product of the assembled stiffness with displacement fields, and its diagonal.

A field has shape (cases, 3, nx + 1, ny + 1, nz + 1). Sums and differences over the corners of each cell,
eight 3 x 3 products, sums and differences back: no gather, no scatter, no (cells, 24) array.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.numerics.grid.element import COUPLED
from cranktopo.numerics.kernels.registry import by_kernel, called, coupled

# More would save little: one slab is then an eighth of what else is kept. Below so many numbers a slab is too
# little work for the cores, and what it takes is small anyway.
_MOST_SLABS, _LEAST_NUMBERS = 8, 750_000


def apply_stiffness(blocks: jax.Array, moduli: jax.Array, field: jax.Array) -> jax.Array:
    """Return the nodal forces K(moduli) u of every case: by a kernel on the processor, elsewhere by JAX.

    Args:
        blocks: parity blocks (8, 3, 3, nz) of the layers, N/mm per MPa, from `layer_blocks`.
        moduli: Young's modulus per cell (nx, ny, nz), MPa.
        field: displacements (cases, 3, nx + 1, ny + 1, nz + 1), mm.

    Returns:
        Forces of the same shape and precision as `field`, N.
    """
    return by_kernel(_by_kernel, apply_by_slabs, blocks, moduli, field)


def _by_kernel(*arrays: jax.Array) -> jax.Array:
    return coupled("stiffness", "product", arrays)[0]


def apply_by_slabs(blocks: jax.Array, moduli: jax.Array, field: jax.Array) -> jax.Array:
    """The product as JAX code, slab by slab along x: sums of the whole grid would take the most memory."""

    def part(start: int | jax.Array, depth: int) -> jax.Array:
        cells = jax.lax.dynamic_slice_in_dim(moduli, start, depth)
        return _apply_to_slab(blocks, cells, jax.lax.dynamic_slice_in_dim(field, start, depth + 1, 2))

    return add_slabs(jnp.zeros_like(field), moduli.shape[0], part, axis=2)


def _apply_to_slab(blocks: jax.Array, moduli: jax.Array, field: jax.Array) -> jax.Array:
    # A ring of cells without stiffness around the grid: sums of slices then need no edges, at which XLA
    # stops using vectors. Without the barriers it recomputes sums and products once per corner.
    ring, edges = ((1, 1),) * 3, ((0, 0),) * 3
    field = jnp.pad(field, (*edges[:2], *ring))
    sums = jax.lax.optimization_barrier(_parity_sums(jax.lax.optimization_barrier(field)))
    products = _multiply_blocks(jnp.pad(blocks, (*edges, ring[0])), jnp.pad(moduli, ring), sums)
    return _parity_sums_transposed(jax.lax.optimization_barrier(products))


def strain_energy_density(blocks: jax.Array, left: jax.Array, right: jax.Array) -> jax.Array:
    """Return v^T K_e u of every cell for unit modulus over all cases: the derivative of v^T K u by moduli.

    Returns:
        Array (nx, ny, nz), N mm per MPa.
    """
    return jnp.sum(by_kernel(_energies_by_kernel, _energies_by_layers, blocks, left, right), axis=0)


@jax.jit
def strain_energy_densities(blocks: jax.Array, u: jax.Array) -> jax.Array:
    """Return u^T K_e u per case and cell (cases, nx, ny, nz) for unit modulus, N mm per MPa."""
    return by_kernel(_energies_by_kernel, _energies_by_layers, blocks, u, u)


def _energies_by_kernel(blocks: jax.Array, left: jax.Array, right: jax.Array) -> jax.Array:
    cases, _, *nodes = right.shape
    shape = (cases, 1, *(n - 1 for n in nodes))
    return called("energy", [blocks, left, right], [shape], right.dtype)[0][:, 0]


def _energies_by_layers(blocks: jax.Array, left: jax.Array, right: jax.Array) -> jax.Array:
    """Return the same as JAX code, layer by layer: sums and differences stay in the cache."""

    def layer(fields: tuple[jax.Array, jax.Array], start: jax.Array) -> jax.Array:
        at = [jax.lax.dynamic_slice_in_dim(field[None], start, 2, axis=2) for field in fields]
        return jnp.squeeze(_layer_energy_density(blocks, *at), axis=0)

    def case(fields: tuple[jax.Array, jax.Array]) -> jax.Array:
        return jax.lax.map(partial(layer, fields), jnp.arange(right.shape[2] - 1))

    return jax.lax.map(case, (left, right))


def _layer_energy_density(blocks: jax.Array, left: jax.Array, right: jax.Array) -> jax.Array:
    other, sums = _parity_sums(left), _parity_sums(right)
    columns = blocks.astype(right.dtype)
    density = jnp.zeros(sums.shape[3:], right.dtype)
    # Term by term: one sum over classes and components would run along the slowest axis of memory.
    for p, c in np.argwhere(np.any(COUPLED, axis=2)):
        force = sum(columns[p, c, d] * sums[:, p, d] for d in np.flatnonzero(COUPLED[p, c]))
        density += jnp.sum(other[:, p, c] * force, axis=0)
    return density


def stiffness_diagonal(blocks: jax.Array, moduli: jax.Array) -> jax.Array:
    """Return the diagonal of K(moduli), shape (3, nx + 1, ny + 1, nz + 1), in units of `moduli` times mm."""
    weights = jnp.sum(blocks, axis=0)  # by symmetry every corner has the same diagonal
    diagonal = []
    for c in range(3):
        cell = moduli * weights[c, c].astype(moduli.dtype)
        padded = jnp.pad(cell, 1)
        for axis in range(3):
            size = padded.shape[axis]
            padded = jax.lax.slice_in_dim(padded, 0, size - 1, axis=axis) + jax.lax.slice_in_dim(
                padded, 1, size, axis=axis
            )
        diagonal.append(padded)
    return jnp.stack(diagonal)


def _parity_sums(field: jax.Array) -> jax.Array:
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
    """Return transpose of `_parity_sums` without its outermost nodes: inner nodes have cells on all sides."""
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
    """Return the 3 x 3 block product of every parity class."""
    columns = blocks.astype(sums.dtype)[:, :, :, None, None, :]
    return moduli * sum(
        (columns[:, :, d] * sums[:, :, d, None] for d in range(1, 3)),
        start=columns[:, :, 0] * sums[:, :, 0, None],
    )


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
