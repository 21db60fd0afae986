"""Galerkin coarse operators of the multigrid hierarchy, stored as 27-point stencils of 3 x 3 blocks.

A coarse cell's stiffness is linear in the moduli of the fine cells it holds, so every level is one
constant matrix times those moduli.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import product

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from cranktopo.fem.element import CORNERS
from cranktopo.fem.lattice import Lattice, layer_stiffness

OFFSETS = list(product((-1, 0, 1), repeat=3))


def coarse_stencil(lattice: Lattice, moduli: jax.Array, level: int) -> jax.Array:
    """Stencil of the Galerkin operator P^T K P after `level` halvings of the grid.

    Args:
        lattice: the fine grid.
        moduli: modulus per fine cell (nx, ny, nz).
        level: 1 or more.

    Returns:
        Array (27, 3, 3, coarse nodes...): block that couples a node to its neighbour at OFFSETS[i].
    """
    matrices = _coarse_cell_matrices(lattice, moduli, level)  # (8, 3, 8, 3, cells...)
    blocks: dict[tuple[int, ...], list[jax.Array]] = {offset: [] for offset in OFFSETS}
    for a, corner in enumerate(CORNERS):
        for b, other in enumerate(CORNERS):
            widths = [(0, 0), (0, 0), *((int(c), int(1 - c)) for c in corner)]
            blocks[tuple(int(v) for v in other - corner)].append(jnp.pad(matrices[a, :, b], widths))
    return jnp.stack([sum(parts[1:], start=parts[0]) for parts in blocks.values()])


def apply_stencil(stencil: jax.Array, field: jax.Array) -> jax.Array:
    """Product of a stencil operator (27, 3, 3, nodes...) with fields (cases, 3, nodes...)."""
    shape = field.shape[2:]
    padded = jnp.pad(field, ((0, 0), (0, 0), (1, 1), (1, 1), (1, 1)))
    result = jnp.zeros_like(field)
    for index, (i, j, k) in enumerate(OFFSETS):
        part = padded[:, :, 1 + i : 1 + i + shape[0], 1 + j : 1 + j + shape[1], 1 + k : 1 + k + shape[2]]
        for d in range(3):
            result = result + stencil[index, :, d] * part[:, d : d + 1]
    return result


def stencil_diagonal(stencil: jax.Array) -> jax.Array:
    """Diagonal (3, nodes...) of a stencil operator."""
    centre = stencil[OFFSETS.index((0, 0, 0))]
    return jnp.stack([centre[c, c] for c in range(3)])


def _coarse_cell_matrices(lattice: Lattice, moduli: jax.Array, level: int) -> jax.Array:
    nx, ny, nz = lattice.coarsened(level)
    n = 1 << level
    children = moduli.reshape(nx, n, ny, n, nz, n).transpose(1, 3, 5, 0, 2, 4).reshape(n**3, nx, ny, nz)
    parts = []
    for start, stop, maps in _layer_maps(lattice, level):
        part = children[..., start:stop].reshape(n**3, -1)
        parts.append((jnp.asarray(maps.T, moduli.dtype) @ part).reshape(8, 3, 8, 3, nx, ny, stop - start))
    return jnp.concatenate(parts, axis=-1)


@lru_cache(maxsize=32)
def _layer_maps(lattice: Lattice, level: int) -> tuple[tuple[int, int, NDArray[np.float64]], ...]:
    """Runs of coarse layers with the same fine layer heights: (start, stop, map (8^level, 576))."""
    n = 1 << level
    heights = [lattice.dz_mm[k : k + n] for k in range(0, lattice.cells[2], n)]
    starts = [k for k in range(len(heights)) if k == 0 or heights[k] != heights[k - 1]]
    stops = [*starts[1:], len(heights)]
    return tuple((a, b, _children_map(lattice, level, a * n)) for a, b in zip(starts, stops, strict=True))


def _children_map(lattice: Lattice, level: int, first_layer: int) -> NDArray[np.float64]:
    """(P^T K_e P) of each fine cell inside a coarse cell, flattened: shape (8^level, 576)."""
    n = 1 << level
    result = np.empty((n, n, n, 8, 3, 8, 3))
    for k in range(n):
        stiffness = layer_stiffness(lattice, first_layer + k).reshape(8, 3, 8, 3)
        for i, j in product(range(n), repeat=2):
            weights = _interpolation((i, j, k), n)
            result[i, j, k] = np.einsum("ap,acbd,bq->pcqd", weights, stiffness, weights, optimize=True)
    return result.reshape(n**3, 576)


def _interpolation(cell: tuple[int, int, int], n: int) -> NDArray[np.float64]:
    """Trilinear weights (8 fine corners, 8 coarse corners) of fine cell `cell` among n^3 in a coarse cell."""
    position = (np.array(cell) + CORNERS) / n  # (8, 3) in [0, 1]
    factors = np.where(CORNERS[None] == 1, position[:, None], 1 - position[:, None])
    return np.asarray(np.prod(factors, axis=2))
