"""Geometric multigrid preconditioner: Galerkin coarse operators, Chebyshev-Jacobi smoothing, float32."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.fem.galerkin import apply_stencil, coarse_stencil, stencil_diagonal
from cranktopo.fem.lattice import Lattice, layer_stiffness
from cranktopo.fem.operator import apply_stiffness, stiffness_diagonal
from cranktopo.fem.supports import Supports, add_section, interior_mask, section_coordinates

# Chebyshev smoothing damps the upper part [largest / SPREAD, largest] of the Jacobi-scaled spectrum.
SPREAD = 8.0
_POWER_STEPS = 10
_POWER_MARGIN = 1.15


class Hierarchy(NamedTuple):
    """Everything the V-cycle needs for one set of moduli.

    Attributes:
        moduli: relative moduli of the finest cells, float32.
        inverse_diagonals: per level above the coarsest, (3, nodes...), 0 in void.
        largest: per level above the coarsest, bound of the Jacobi-scaled spectrum.
        stencils: Galerkin stencils of the intermediate levels.
        coarse_inverse: (cases, n, n) inverse on the coarsest grid, supports included.
    """

    moduli: jax.Array
    inverse_diagonals: tuple[jax.Array, ...]
    largest: tuple[jax.Array, ...]
    stencils: tuple[jax.Array, ...]
    coarse_inverse: jax.Array


@partial(jax.jit, static_argnames=("lattice", "levels"))
def build_hierarchy(lattice: Lattice, levels: int, supports: Supports, moduli: jax.Array) -> Hierarchy:
    """Coarse operators and smoothers for one set of moduli.

    Args:
        lattice: the finest grid.
        levels: number of halvings, at least 1.
        supports: supports of all cases; springs in the unit of `moduli`.
        moduli: modulus per cell (nx, ny, nz), scaled so that the largest is about 1.
    """
    moduli = moduli.astype(jnp.float32)
    stencils = tuple(coarse_stencil(lattice, moduli, level) for level in range(1, levels))
    diagonals = (stiffness_diagonal(lattice, moduli), *(stencil_diagonal(s) for s in stencils))
    inverses = tuple(_safe_inverse(d) for d in diagonals)
    largest = (
        jnp.asarray(_element_bound(lattice), jnp.float32),
        *(_largest_eigenvalue(s, d) for s, d in zip(stencils, inverses[1:], strict=True)),
    )
    coarse = coarse_stencil(lattice, moduli.astype(supports.springs.dtype), levels)
    return Hierarchy(moduli, inverses, largest, stencils, _coarse_inverse(coarse, supports))


def apply_cycle(lattice: Lattice, hierarchy: Hierarchy, supports: Supports, residual: jax.Array) -> jax.Array:
    """One V-cycle: an approximate, symmetric positive definite inverse applied to a residual.

    Args:
        lattice: the finest grid.
        hierarchy: from `build_hierarchy`.
        supports: supports of all cases.
        residual: projected nodal forces (cases, 3, nodes...), any float type.

    Returns:
        Correction of the same type, in the space of admissible displacements.
    """
    norm = jnp.sqrt(jnp.sum(residual**2, axis=(1, 2, 3, 4), keepdims=True))
    scale = jnp.where(norm > 0, norm, 1.0)
    correction = _cycle(lattice, hierarchy, supports, (residual / scale).astype(jnp.float32), 0)
    # Rounding to float32 bends the rigid sections by 1e-7; the energy of that would ruin CG.
    return project(supports, correction.astype(residual.dtype) * scale)


def _cycle(
    lattice: Lattice, hierarchy: Hierarchy, supports: Supports, residual: jax.Array, level: int
) -> jax.Array:
    if level == len(hierarchy.inverse_diagonals):
        return _solve_coarse(hierarchy, residual)

    def product(field: jax.Array) -> jax.Array:
        if level == 0:
            return apply_stiffness(lattice, hierarchy.moduli, field)
        return apply_stencil(hierarchy.stencils[level - 1], field)

    nodes = (residual.shape[2], residual.shape[3], residual.shape[4])
    inverse = hierarchy.inverse_diagonals[level] * interior_mask(supports, nodes, residual.dtype)
    smooth = partial(_chebyshev, product, inverse, hierarchy.largest[level])
    field = smooth(residual)
    coarse = _cycle(lattice, hierarchy, supports, restrict(residual - product(field)), level + 1)
    field = field + prolong(coarse)
    return field + smooth(residual - product(field))


def _chebyshev(
    product: Callable[[jax.Array], jax.Array], inverse: jax.Array, largest: jax.Array, residual: jax.Array
) -> jax.Array:
    """Two Chebyshev steps from a zero guess (Adams et al., Parallel multigrid smoothing, JCP 188, 2003)."""
    centre = largest * (1 + 1 / SPREAD) / 2
    width = largest * (1 - 1 / SPREAD) / 2
    ratio = centre / width
    first = inverse * residual / centre
    weight = 1 / (2 * ratio - 1 / ratio)
    second = weight / ratio * first + 2 * weight / width * inverse * (residual - product(first))
    return first + second


def _solve_coarse(hierarchy: Hierarchy, residual: jax.Array) -> jax.Array:
    flat = residual.reshape(residual.shape[0], -1)
    return jnp.einsum("bij,bj->bi", hierarchy.coarse_inverse, flat).reshape(residual.shape)


def _coarse_inverse(stencil: jax.Array, supports: Supports) -> jax.Array:
    """Dense inverse per case in the space of free nodes and section motions, float32 from float64."""
    nodes = (stencil.shape[3], stencil.shape[4], stencil.shape[5])
    size = 3 * int(np.prod(nodes))
    identity = jnp.eye(size, dtype=stencil.dtype).reshape(size, 3, *nodes)
    dense = apply_stencil(stencil, identity).reshape(size, size)
    diagonal = jnp.diagonal(dense)
    free = interior_mask(supports, nodes, stencil.dtype).reshape(-1, size) * (diagonal > 0)
    count = supports.springs.shape[1]
    motions = jnp.zeros((free.shape[0], count, 3, *nodes), stencil.dtype)
    motions = motions.at[..., 0].set(supports.coarse_basis[:, :, 0])
    motions = motions.at[..., -1].add(supports.coarse_basis[:, :, 1])
    motions = motions.reshape(free.shape[0], count, size)

    def invert(free: jax.Array, motions: jax.Array, springs: jax.Array) -> jax.Array:
        columns = jnp.concatenate([jnp.diag(free), motions])  # (n + m, n): admissible displacements
        matrix = columns @ dense @ columns.T
        matrix = matrix.at[size:, size:].add(springs)
        unused = jnp.diagonal(matrix) <= 0
        matrix = matrix + jnp.diag(jnp.where(unused, jnp.mean(diagonal), 0.0))
        solved = jax.scipy.linalg.cho_solve(jax.scipy.linalg.cho_factor(matrix), columns)
        return columns.T @ solved

    return jax.vmap(invert)(free, motions, supports.springs).astype(jnp.float32)


def restrict(field: jax.Array) -> jax.Array:
    """Transpose of trilinear interpolation: fine nodal forces to coarse ones."""
    for axis in (2, 3, 4):
        size = field.shape[axis]
        even = jax.lax.slice_in_dim(field, 0, size, 2, axis)
        odd = jax.lax.slice_in_dim(field, 1, size, 2, axis) * 0.5
        low, high = [(0, 0)] * 5, [(0, 0)] * 5
        low[axis], high[axis] = (0, 1), (1, 0)
        field = even + jnp.pad(odd, low) + jnp.pad(odd, high)
    return field


def prolong(field: jax.Array) -> jax.Array:
    """Trilinear interpolation of a coarse field to the next finer grid."""
    for axis in (4, 3, 2):
        size = field.shape[axis]
        near = jax.lax.slice_in_dim(field, 0, size - 1, 1, axis)
        far = jax.lax.slice_in_dim(field, 1, size, 1, axis)
        pairs = jnp.stack([near, (near + far) * 0.5], axis=axis + 1)
        shape = list(field.shape)
        shape[axis] = 2 * (size - 1)
        last = jax.lax.slice_in_dim(field, size - 1, size, 1, axis)
        field = jnp.concatenate([pairs.reshape(shape), last], axis=axis)
    return field


def project(supports: Supports, field: jax.Array) -> jax.Array:
    """Orthogonal projection onto admissible fields: free nodes and rigid motions of the sections.

    For nodal forces it is the part that admissible displacements feel.
    """
    nodes = (field.shape[2], field.shape[3], field.shape[4])
    interior = field * interior_mask(supports, nodes, field.dtype)
    return add_section(supports, interior, section_coordinates(supports, field))


def _safe_inverse(diagonal: jax.Array) -> jax.Array:
    return jnp.where(diagonal > 0, 1 / jnp.where(diagonal > 0, diagonal, 1), 0)


def _element_bound(lattice: Lattice) -> float:
    """Largest eigenvalue of diag(K_e)^-1 K_e over the layers; it bounds that of the assembled matrix."""
    bound = 0.0
    for layer in {lattice.dz_mm.index(h) for h in lattice.dz_mm}:
        stiffness = layer_stiffness(lattice, layer)
        root = 1 / np.sqrt(np.diag(stiffness))
        bound = max(bound, float(np.linalg.eigvalsh(root[:, None] * stiffness * root).max()))
    return bound


def _largest_eigenvalue(stencil: jax.Array, inverse: jax.Array) -> jax.Array:
    """Power iteration on the Jacobi-scaled stencil, with a margin because it converges from below."""
    start = jnp.sin(jnp.arange(inverse.size, dtype=stencil.dtype) * 12.9898).reshape(1, *inverse.shape)

    def step(_: int, state: tuple[jax.Array, jax.Array]) -> tuple[jax.Array, jax.Array]:
        vector, _norm = state
        image = inverse * apply_stencil(stencil, vector)
        norm = jnp.sqrt(jnp.sum(image**2))
        return image / jnp.where(norm > 0, norm, 1), norm

    start = start * (inverse > 0)
    start = start / jnp.sqrt(jnp.sum(start**2))
    _, norm = jax.lax.fori_loop(0, _POWER_STEPS, step, (start, jnp.ones((), stencil.dtype)))
    return norm * _POWER_MARGIN
