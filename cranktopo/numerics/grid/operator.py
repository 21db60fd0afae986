"""Matrix-free products of the assembled stiffness, its diagonal, and transfers to the next coarser grid.

A field has shape (cases, 3, nx + 1, ny + 1, nz + 1). Sums and differences over the corners of each cell,
eight 3 x 3 products, sums and differences back: no gather, no scatter, no (cells, 24) array. Kernels compute
on the processor, JAX code elsewhere.
"""

from __future__ import annotations

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.numerics.grid.lattice import COUPLED, Cells
from cranktopo.numerics.grid.slab_product import apply_by_slabs, parity_sums
from cranktopo.numerics.kernels.registry import apply_operator, ffi_call, kernel_or_jax


def restrict(field: jax.Array, nodes: Cells) -> jax.Array:
    """Return the transpose of `prolong`: fine nodal forces on the next coarser grid with so many nodes."""
    elsewhere = partial(_restricted, nodes=nodes)
    if not _halved(field.shape[2:], nodes):
        return elsewhere(field)

    def kernel(field: jax.Array) -> jax.Array:
        return ffi_call("restriction", [field], [(*field.shape[:2], *nodes)], field.dtype)[0]

    return kernel_or_jax(kernel, elsewhere, field)


def add_prolonged(coarse: jax.Array, field: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Return the interpolation of a coarse field to the grid of a finer one, and the sum of both."""
    if not _halved(field.shape[2:], coarse.shape[2:]):
        return _add_prolonged(coarse, field)
    return kernel_or_jax(_add_by_kernel, _add_prolonged, coarse, field)


def _add_by_kernel(coarse: jax.Array, field: jax.Array) -> tuple[jax.Array, jax.Array]:
    found, total = ffi_call("prolongation", [coarse, field], [field.shape] * 2, field.dtype)
    return found, total


def _add_prolonged(coarse: jax.Array, field: jax.Array) -> tuple[jax.Array, jax.Array]:
    found = prolong(coarse, (field.shape[2], field.shape[3], field.shape[4]))
    return found, field + found


def _halved(fine: tuple[int, ...], coarse: tuple[int, ...]) -> bool:
    return all(one == 2 * other - 1 for one, other in zip(fine, coarse, strict=True))


def _restricted(field: jax.Array, nodes: Cells) -> jax.Array:
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
    """Return the trilinear interpolation to the next finer grid; an axis with as many nodes stays."""
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


def apply_stiffness(blocks: jax.Array, moduli: jax.Array, field: jax.Array) -> jax.Array:
    """Return the nodal forces K(moduli) u of every case, N, with moduli per cell in MPa and u in mm."""
    return kernel_or_jax(
        lambda *a: apply_operator("stiffness", "product", a)[0], apply_by_slabs, blocks, moduli, field
    )


def strain_energy_density(blocks: jax.Array, left: jax.Array, right: jax.Array) -> jax.Array:
    """Return v^T K_e u of every cell for unit modulus, N mm per MPa: the derivative of v^T K u by moduli."""
    return jnp.sum(kernel_or_jax(_energies_by_kernel, _energies_by_layers, blocks, left, right), axis=0)


@jax.jit
def strain_energy_densities(blocks: jax.Array, u: jax.Array) -> jax.Array:
    """Return u^T K_e u per case and cell (cases, nx, ny, nz) for unit modulus, N mm per MPa."""
    return kernel_or_jax(_energies_by_kernel, _energies_by_layers, blocks, u, u)


def _energies_by_kernel(blocks: jax.Array, left: jax.Array, right: jax.Array) -> jax.Array:
    cases, _, *nodes = right.shape
    shape = (cases, 1, *(n - 1 for n in nodes))
    return ffi_call("energy", [blocks, left, right], [shape], right.dtype)[0][:, 0]


def _energies_by_layers(blocks: jax.Array, left: jax.Array, right: jax.Array) -> jax.Array:
    """Return the same as JAX code, layer by layer: sums and differences stay in the cache."""

    def layer(fields: tuple[jax.Array, jax.Array], start: jax.Array) -> jax.Array:
        at = [jax.lax.dynamic_slice_in_dim(field[None], start, 2, axis=2) for field in fields]
        return jnp.squeeze(_layer_energy_density(blocks, *at), axis=0)

    def case(fields: tuple[jax.Array, jax.Array]) -> jax.Array:
        return jax.lax.map(partial(layer, fields), jnp.arange(right.shape[2] - 1))

    return jax.lax.map(case, (left, right))


def _layer_energy_density(blocks: jax.Array, left: jax.Array, right: jax.Array) -> jax.Array:
    other, sums = parity_sums(left), parity_sums(right)
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
