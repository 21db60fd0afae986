"""Galerkin coarse operators of the multigrid hierarchy: stencils of 27 blocks 3 x 3, half of them stored.

A coarse cell's stiffness is linear in the moduli of the fine cells it holds. Trilinear weights inside a
coarse cell are linear in the fine cell's position, products of two of them quadratic, so over x and y the
moduli enter only through nine moments per layer: every level is one small matrix product.
"""

from __future__ import annotations

from functools import lru_cache, reduce
from itertools import product
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.numerics.grid.lattice import CORNERS, Cells, Lattice, layer_stiffness
from cranktopo.numerics.grid.slab_product import add_slabs
from cranktopo.numerics.kernels.coarse_grids import OFFSETS
from cranktopo.numerics.kernels.registry import apply_operator, kernel_or_jax
from cranktopo.numerics.precision import Precision

# Corners a and b of a cell, and which later neighbour b is of a; the entries of their blocks in its matrix.
_PAIRS = [
    (a, b, OFFSETS.index(offset))
    for a, b in product(range(8), repeat=2)
    if (offset := tuple(int(n) for n in CORNERS[b] - CORNERS[a])) in OFFSETS
]
_PAIR_ENTRIES = np.array(
    [((a * 3 + c) * 8 + b) * 3 + d for a, b, _ in _PAIRS for c in range(3) for d in range(3)]
)
# A matrix product has the layers first: with many cells turning its result around costs far more than
# the sum of a few products, which is one program.
_FEW_MOMENTS = 8


class CoarseMap(NamedTuple):
    """Constants that turn the moduli of the fine cells into the stiffness of the coarse cells.

    Attributes:
        weights_x: moments over the fine cells along x in a coarse cell (moments, cells).
        matrices: per moment (x, y) and fine layer in a coarse layer, and per coarse layer, the (8, 3, 8, 3)
            matrix of P^T K_e P, shape (moments, 576, coarse nz): sums over moments then run along memory.
        bound: bound of the Jacobi-scaled spectrum of the coarse operator, whatever the moduli.
    """

    weights_x: Array
    weights_y: Array
    matrices: Array
    bound: Array


@lru_cache(maxsize=32)
def coarse_map(lattice: Lattice, factors: Cells) -> CoarseMap:
    """Return the constants of a coarse grid with so many fine cells per coarse cell along (x, y, z)."""
    stacks = [lattice.dz_mm[k : k + factors[2]] for k in range(0, lattice.cells[2], factors[2])]
    layers = [_layer_map(lattice, factors, heights) for heights in stacks]
    return CoarseMap(
        weights_x=_moment_weights(factors[0]),
        weights_y=_moment_weights(factors[1]),
        matrices=np.stack([matrix for matrix, _ in layers], axis=-1),
        bound=np.asarray(max(bound for _, bound in layers)),
    )


def coarse_cells(coarse: CoarseMap, moduli: jax.Array) -> jax.Array:
    """Return the stiffness matrices (8, 3, 8, 3, coarse cells...) of the Galerkin operator P^T K P."""
    entries = _entries(coarse, jnp.asarray(coarse.matrices, moduli.dtype), moduli)
    return entries.reshape(8, 3, 8, 3, *entries.shape[1:])


def _entries(coarse: CoarseMap, matrices: jax.Array, moduli: jax.Array) -> jax.Array:
    across, along = coarse.weights_x.shape[1], coarse.weights_y.shape[1]
    nx, ny, nz = moduli.shape[0] // across, moduli.shape[1] // along, matrices.shape[2]
    weights_x, weights_y = (jnp.asarray(a, moduli.dtype) for a in (coarse.weights_x, coarse.weights_y))
    fine = moduli.reshape(nx, across, ny, along, nz, -1)
    moments = jnp.einsum("pi,qj,xiyjzk->pqkxyz", weights_x, weights_y, fine).reshape(-1, nx * ny, nz)
    if len(moments) <= _FEW_MOMENTS:
        terms = (column[:, None] * moment for column, moment in zip(matrices, moments, strict=True))
        entries = reduce(jnp.add, terms)
    else:
        entries = jnp.einsum("mrz,mcz->rcz", matrices, moments)
    return entries.reshape(-1, nx, ny, nz)


def assemble_stencil(coarse: CoarseMap, moduli: jax.Array, precision: Precision) -> jax.Array:
    """Return the stencil (nodes along x, y, 14, 3, 3, along z): blocks of a node with itself and later ones.

    Slab by slab along x: matrices of all coarse cells at once would be the most memory that a solve takes.
    """
    across, along = coarse.weights_x.shape[1], coarse.weights_y.shape[1]
    nx, ny, nz = moduli.shape[0] // across, moduli.shape[1] // along, coarse.matrices.shape[2]
    matrices = jnp.asarray(coarse.matrices, moduli.dtype)[:, _PAIR_ENTRIES]

    def part(start: int | jax.Array, depth: int) -> jax.Array:
        slab = jax.lax.dynamic_slice_in_dim(moduli, start * across, depth * across)
        return _summed_pairs(_entries(coarse, matrices, slab).astype(precision))

    empty = jnp.zeros((nx + 1, ny + 1, len(OFFSETS), 3, 3, nz + 1), precision)
    return add_slabs(empty, nx, part, axis=0)


def _summed_pairs(entries: jax.Array) -> jax.Array:
    """Return blocks (nodes along x, y, 14, 3, 3, along z) from corner pairs (pairs x 9, cells...)."""
    nx, ny, nz = entries.shape[1:]
    blocks = entries.reshape(len(_PAIRS), 3, 3, nx, ny, nz)

    # A loop: as one expression the shifted sums take seconds to compile.
    def add(number: jax.Array, stencil: jax.Array) -> jax.Array:
        a, _, offset = jnp.asarray(_PAIRS)[number]
        i, j, k = jnp.asarray(CORNERS)[a]
        at = i, j, offset, 0, 0, k
        there = jax.lax.dynamic_slice(stencil, at, (nx, ny, 1, 3, 3, nz))
        part = jax.lax.dynamic_slice_in_dim(blocks, number, 1).transpose(3, 4, 0, 1, 2, 5)
        return jax.lax.dynamic_update_slice(stencil, there + part, at)

    empty = jnp.zeros((nx + 1, ny + 1, len(OFFSETS), 3, 3, nz + 1), entries.dtype)
    return jax.lax.fori_loop(0, len(_PAIRS), add, empty)


def assemble_dense(cells: jax.Array) -> jax.Array:
    """Return the dense matrix (n, n) of cell matrices; freedoms in the order of a field (3, nodes...)."""
    shape = cells.shape[4:]
    nodes = np.arange(int(np.prod([n + 1 for n in shape]))).reshape([n + 1 for n in shape])
    corners = np.stack(
        [nodes[i : i + shape[0], j : j + shape[1], k : k + shape[2]].ravel() for i, j, k in CORNERS]
    )
    freedoms = (corners[:, None] + nodes.size * np.arange(3)[None, :, None]).reshape(24, -1)
    size = 3 * nodes.size
    dense = jnp.zeros((size, size), cells.dtype)
    return dense.at[freedoms[:, None], freedoms[None]].add(cells.reshape(24, 24, -1))


def apply_stencil(stencil: jax.Array, field: jax.Array) -> jax.Array:
    """Return a stencil operator's product with fields: by a kernel on the processor, elsewhere by JAX."""
    return kernel_or_jax(
        lambda *a: apply_operator("stencil", "product", a)[0], _apply_by_sums, stencil, field
    )


def _apply_by_sums(stencil: jax.Array, field: jax.Array) -> jax.Array:
    # A node of zeros around the grid: no neighbour is missing. Without the barrier XLA recomputes what made
    # the field once per neighbour.
    padded = jax.lax.optimization_barrier(jnp.pad(field, ((0, 0), (0, 0), (1, 1), (1, 1), (1, 1))))
    here = (0, 0, 0)
    result = jnp.zeros_like(padded)
    for index, offset in enumerate(OFFSETS):
        blocks = jnp.moveaxis(stencil[:, :, index], (2, 3), (0, 1))  # (3, 3, nodes...)
        result = _add_at(result, _block_product(blocks, _neighbours(padded, offset)), here)
        if index:
            transposed = _block_product(jnp.swapaxes(blocks, 0, 1), _neighbours(padded, here))
            result = _add_at(result, transposed, offset)
    return jax.lax.optimization_barrier(_neighbours(result, (0, 0, 0)))


def _block_product(blocks: jax.Array, field: jax.Array) -> jax.Array:
    """Return the block times displacement at every node.

    Term by term: as a matrix product a GPU would round the numbers to 10 bits, and as a `jnp.sum` jaxlib
    0.10.2 computes the second load case wrong on a processor.
    """
    terms = (blocks[:, d] * field[:, None, d] for d in range(3))
    return reduce(jnp.add, terms)


def _neighbours(padded: jax.Array, offset: tuple[int, ...]) -> jax.Array:
    i, j, k = offset
    nx, ny, nz = padded.shape[2:]
    return padded[:, :, 1 + i : nx - 1 + i, 1 + j : ny - 1 + j, 1 + k : nz - 1 + k]


def _add_at(padded: jax.Array, values: jax.Array, offset: tuple[int, ...]) -> jax.Array:
    at = (0, 0, *(1 + n for n in offset))
    return jax.lax.dynamic_update_slice(padded, _neighbours(padded, offset) + values, at)


def stencil_diagonal(stencil: jax.Array) -> jax.Array:
    """Return the diagonal (3, nodes...) of a stencil operator."""
    return jnp.stack([stencil[:, :, 0, c, c] for c in range(3)])


def _samples(n: int) -> list[int]:
    return sorted({0, (n - 1) // 2, n - 1}) if n > 2 else list(range(n))


def _moment_weights(n: int) -> Array:
    samples = _samples(n)
    weights = np.ones((len(samples), n))
    for row, here in zip(weights, samples, strict=True):
        for other in samples:
            if other != here:
                row *= (np.arange(n) - other) / (here - other)
    return weights


@lru_cache(maxsize=64)
def _layer_map(lattice: Lattice, factors: Cells, heights: tuple[float, ...]) -> tuple[Array, float]:
    """Return the map (moments, 576) of a coarse layer from sampled P^T K_e P, and the bound of its spectrum.

    Every K_i <= b_i diag(K_i), so a sum of them with positive moduli is at most max b_i times its diagonal.
    """
    across, along = _samples(factors[0]), _samples(factors[1])
    result = np.empty((len(across), len(along), len(heights), 24, 24))
    for k, height in enumerate(heights):
        stiffness = layer_stiffness(lattice, lattice.dz_mm.index(height))
        for (p, i), (q, j) in product(enumerate(across), enumerate(along)):
            weights = _interpolation((i, j, k), factors)
            result[p, q, k] = weights.T @ stiffness @ weights
    return result.reshape(-1, 576), jacobi_bound(result)


def jacobi_bound(stiffness: Array) -> float:
    """Return the largest eigenvalue of diag(K)^-1 K of a cell, or of many (..., 24, 24)."""
    root = 1 / np.sqrt(np.diagonal(stiffness, axis1=-2, axis2=-1))
    return float(np.linalg.eigvalsh(root[..., :, None] * stiffness * root[..., None, :]).max())


@lru_cache(maxsize=64)
def _interpolation(cell: Cells, factors: Cells) -> Array:
    """Return trilinear weights (24, 24) of a fine cell, its rows, inside its coarse cell."""
    position = (np.array(cell) + CORNERS) / np.array(factors)  # (8, 3) in [0, 1]
    weights = np.where(CORNERS[None] == 1, position[:, None], 1 - position[:, None])
    return np.kron(np.prod(weights, axis=2), np.eye(3))
