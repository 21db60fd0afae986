"""Matrix-free product of the assembled stiffness with displacement fields, and its diagonal.

A field has shape (cases, 3, nx + 1, ny + 1, nz + 1). Sums and differences over the corners of each cell,
eight 3 x 3 products, sums and differences back: no gather, no scatter, no (cells, 24) array.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.fem.element import hexahedron_stiffness, reflection_blocks, wave_of

Waves = list[list[jax.Array]]  # [wave][component], each (cases, nx, ny, nz)

# Entries of the reflection blocks that do not vanish by symmetry, the same for every box and material.
_COUPLED = np.abs(reflection_blocks(hexahedron_stiffness((1.0, 1.1, 0.9), 0.3))) > 1e-12


def apply_stiffness(blocks: jax.Array, moduli: jax.Array, field: jax.Array) -> jax.Array:
    """Nodal forces K(moduli) u of every case.

    Args:
        blocks: reflection blocks (8, 3, 3, nz) of the layers, N/mm per MPa, from `layer_blocks`.
        moduli: Young's modulus per cell (nx, ny, nz), MPa.
        field: displacements (cases, 3, nx + 1, ny + 1, nz + 1), mm.

    Returns:
        Forces of the same shape and precision as `field`, N.
    """
    waves = [_corner_sums(field[:, c]) for c in range(3)]
    products = _multiply_blocks(blocks, moduli, waves)
    return jnp.stack([_corner_sums_transposed([p[c] for p in products]) for c in range(3)], axis=1)


def strain_energy_density(blocks: jax.Array, left: jax.Array, right: jax.Array) -> jax.Array:
    """v^T K_e u of every cell for unit modulus, summed over cases: the derivative of v^T K u by moduli.

    Args:
        blocks: as in `apply_stiffness`.
        left: field v, as in `apply_stiffness`.
        right: field u.

    Returns:
        Array (nx, ny, nz), N mm per MPa.
    """
    waves = [_corner_sums(right[:, c]) for c in range(3)]
    other = [_corner_sums(left[:, c]) for c in range(3)]
    unit = jnp.ones(waves[0][0].shape[1:], right.dtype)
    products = _multiply_blocks(blocks, unit, waves)
    return sum(
        (jnp.sum(other[c][w] * products[w][c], axis=0) for w in range(1, 8) for c in range(3)),
        start=jnp.zeros_like(unit),
    )


@jax.jit
def strain_energy_densities(blocks: jax.Array, u: jax.Array) -> jax.Array:
    """u^T K_e u per case and cell (cases, nx, ny, nz) for unit modulus; arguments as `apply_stiffness`."""
    return jax.lax.map(lambda v: strain_energy_density(blocks, v[None], v[None]), u)


def stiffness_diagonal(blocks: jax.Array, moduli: jax.Array) -> jax.Array:
    """Diagonal of K(moduli), shape (3, nx + 1, ny + 1, nz + 1)."""
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


def _corner_sums(nodal: jax.Array) -> list[jax.Array]:
    """Sums and differences over the corners of each cell; list index is the wave 4 wx + 2 wy + wz."""
    waves = [nodal]
    for axis in (-1, -2, -3):
        waves = [part for wave in waves for part in _sum_and_difference(wave, axis)]
    # Built innermost axis first: index 4 wz + 2 wy + wx. Put x first.
    return [waves[4 * (w & 1) + (w & 2) + (w >> 2)] for w in range(8)]


def _barrier(arrays: tuple[jax.Array, ...]) -> tuple[jax.Array, ...]:
    barrier: Callable[[tuple[jax.Array, ...]], tuple[jax.Array, ...]] = jax.lax.optimization_barrier
    return barrier(arrays)


def _sum_and_difference(values: jax.Array, axis: int) -> tuple[jax.Array, jax.Array]:
    size = values.shape[axis]
    near = jax.lax.slice_in_dim(values, 0, size - 1, axis=values.ndim + axis)
    far = jax.lax.slice_in_dim(values, 1, size, axis=values.ndim + axis)
    return near + far, far - near


def _multiply_blocks(blocks: jax.Array, moduli: jax.Array, waves: Sequence[Sequence[jax.Array]]) -> Waves:
    """The 3 x 3 block product of every parity class; `waves` is [component][wave]."""
    blocks = jnp.asarray(blocks, moduli.dtype)
    formed: dict[tuple[int, int], jax.Array] = {}
    for parity in range(8):
        for c in range(3):
            terms = [
                blocks[parity, c, d] * waves[d][wave_of(parity, d)]
                for d in range(3)
                if _COUPLED[parity, c, d]
            ]
            if terms:
                formed[wave_of(parity, c), c] = moduli * sum(terms[1:], start=terms[0])
    # Without a barrier XLA recomputes the block products once per corner.
    formed = dict(zip(formed, _barrier(tuple(formed.values())), strict=True))
    zero = jnp.zeros_like(waves[0][0])
    return [[formed.get((wave, c), zero) for c in range(3)] for wave in range(8)]


def _corner_sums_transposed(waves: Sequence[jax.Array]) -> jax.Array:
    """Transpose of `_corner_sums` for one component: cells back to nodes."""
    parts = list(waves)
    for axis in (-1, -2, -3):
        parts = [_scatter_pair(parts[2 * i], parts[2 * i + 1], axis) for i in range(len(parts) // 2)]
    return parts[0]


def _scatter_pair(total: jax.Array, difference: jax.Array, axis: int) -> jax.Array:
    """Each cell gives (sum - difference) to its near node and (sum + difference) to its far node."""
    return _pad(total - difference, axis, 0, 1) + _pad(total + difference, axis, 1, 0)


def _pad(values: jax.Array, axis: int, low: int, high: int) -> jax.Array:
    config = [(0, 0, 0)] * values.ndim
    config[axis] = (low, high, 0)
    return jax.lax.pad(values, jnp.zeros((), values.dtype), config)
