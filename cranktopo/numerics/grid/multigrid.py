"""Geometric multigrid preconditioner: Galerkin coarse operators, Chebyshev-Jacobi smoothing, float32."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import NamedTuple, TypeVar

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.numerics.grid.boundary_conditions import (
    BoundaryConditions,
    add_section,
    interior_mask,
    section_coordinates,
)
from cranktopo.numerics.grid.galerkin import (
    CoarseMap,
    apply_stencil,
    assemble_dense,
    assemble_stencil,
    coarse_cells,
    coarse_map,
    jacobi_bound,
    stencil_diagonal,
)
from cranktopo.numerics.grid.lattice import Cells, Lattice, layer_blocks, layer_stiffness
from cranktopo.numerics.grid.operator import (
    add_prolonged,
    apply_stiffness,
    prolong,
    restrict,
    stiffness_diagonal,
)
from cranktopo.numerics.grid.partition import WHOLE, Partition
from cranktopo.numerics.grid.smoothing import Smoother, SmootherState, jacobi_scaling, largest_eigenvalues
from cranktopo.numerics.kept_programs import kept_program
from cranktopo.numerics.precision import Precision

_Count = TypeVar("_Count", int, jax.Array)

# On larger grids the stencils of the second level do not stay in the cache, and take as long as the finest
# product. With half the smoothing there a solve takes at most a tenth more cycles, each a fifth cheaper.
_LARGE_NODES = 50_000
# Shift of the coarsest matrix relative to its diagonal: void around an island leaves it singular.
_SHIFT = 1e-13


class GridTables(NamedTuple):
    """Constants of a lattice; arguments of the compiled functions, so that grids of one size share them.

    Parity blocks (8, 3, 3, nz) of the layers, the bound of the Jacobi-scaled spectrum on the finest level.
    """

    blocks: Array
    bound: Array
    coarse: tuple[CoarseMap, ...]


class Hierarchy(NamedTuple):
    """Everything the V-cycle needs for one set of moduli, in the precision of the cycle.

    Attributes:
        moduli: moduli of the finest cells over the largest one.
        steps: per level above the coarsest, inverse diagonal over the largest eigenvalue of the Jacobi-scaled
            operator, (3, nodes...), 0 in void.
        stencils: Galerkin stencils of the intermediate levels.
        coarse_inverse: (cases, n, n) inverse on the coarsest grid, supports included.
    """

    blocks: jax.Array
    moduli: jax.Array
    steps: tuple[jax.Array, ...]
    stencils: tuple[jax.Array, ...]
    coarse_inverse: jax.Array


@lru_cache(maxsize=4)
def build_tables(lattice: Lattice, levels: int) -> GridTables:
    """Return the constants of a lattice and of its coarse grids."""
    heights = {lattice.dz_mm.index(h) for h in lattice.dz_mm}
    bound = max(jacobi_bound(layer_stiffness(lattice, layer)) for layer in heights)
    coarse = tuple(coarse_map(lattice, factors) for factors in lattice.coarsenings(levels))
    return GridTables(layer_blocks(lattice), np.asarray(bound), coarse)


@kept_program("precision")
def build_hierarchy(
    tables: GridTables,
    supports: BoundaryConditions,
    moduli: jax.Array,
    *,
    precision: Precision = "float32",
) -> Hierarchy:
    """Return coarse operators and smoothers for one set of moduli; of a part, where the supports are cut."""
    partition = supports.partition
    scale = partition.largest(jnp.max(moduli))
    moduli = moduli / scale
    rounded = moduli.astype(precision)
    # Above the first coarse level the moments of the moduli cancel: they are summed in float64.
    fields = (rounded if len(tables.coarse) > 1 else moduli, *(moduli for _ in tables.coarse[1:]))
    levels = [partition.at_level(level) for level in range(1, len(fields) + 1)]
    fields = tuple(
        field if at.parts > 1 else partition.whole_cells(field)
        for field, at in zip(fields, levels, strict=True)
    )
    *between, coarsest = zip(tables.coarse, fields, strict=True)
    stencils = tuple(assemble_stencil(c, field, precision) for c, field in between)
    blocks = jnp.asarray(tables.blocks, precision)
    diagonal = partition.add_interfaces(stiffness_diagonal(blocks, rounded))
    fine = _safe_inverse(diagonal) / jnp.asarray(tables.bound, precision)
    # The bounds hold whatever the moduli, estimates need a third fewer cycles: the fast method takes those.
    bounds = None if precision == "float32" else [c.bound for c in tables.coarse]
    steps = fine, *_coarse_steps(stencils, levels, bounds)
    springs = supports.springs / scale
    ends = supports._replace(springs=springs, partition=WHOLE)
    inverse = _coarse_inverse(assemble_dense(coarse_cells(*coarsest)), ends)
    return Hierarchy(blocks, rounded, steps, stencils, inverse.astype(precision))


def _coarse_steps(
    stencils: Sequence[jax.Array], levels: Sequence[Partition], bounds: Sequence[Array] | None
) -> Iterator[jax.Array]:
    inverses = [
        _safe_inverse(at.add_interfaces(stencil_diagonal(stencil)))
        for stencil, at in zip(stencils, levels, strict=False)
    ]
    roots = [jnp.sqrt(inverse) for inverse in inverses]
    largest = largest_eigenvalues(stencils, roots, levels) if bounds is None else bounds
    for inverse, value in zip(inverses, largest, strict=False):
        over = jnp.asarray(value, inverse.dtype)
        yield inverse / jnp.where(over > 0, over, 1.0)


def apply_cycle(
    hierarchy: Hierarchy,
    supports: BoundaryConditions,
    degree: jax.Array,
    residual: jax.Array,
    norm: jax.Array,
) -> tuple[jax.Array, jax.Array]:
    """Apply one V-cycle to a residual: an approximate, symmetric positive definite inverse.

    Returns a field and scale per case: the correction is what is admissible of their product. Rounding in the
    cycle bends the rigid sections by 1e-7; the energy of that would ruin CG.

    Args:
        degree: number of smoothing steps before and after the coarse correction on the finest level; twice as
            many on the next, but as many on a large grid; three times as many on the one after, and so on.
        norm: norms of the residual (cases,), about: what is computed with are numbers near 1.
    """
    partition = supports.partition
    scale = jnp.where(norm > 0, norm, 1.0)
    rounded = (residual / scale[:, None, None, None, None]).astype(hierarchy.moduli.dtype)
    nodes = math.prod(rounded.shape[2:4]) * ((rounded.shape[4] - 1) * partition.parts + 1)
    counts = tuple(smoothing_steps(degree, level, nodes) for level in range(len(hierarchy.steps)))
    return partition.copy_interfaces(_cycle(hierarchy, supports, counts, rounded, 0)), scale


def _cycle(
    hierarchy: Hierarchy,
    supports: BoundaryConditions,
    counts: tuple[jax.Array, ...],
    residual: jax.Array,
    level: int,
) -> jax.Array:
    if level == len(hierarchy.steps):
        flat = residual.reshape(residual.shape[0], -1)
        return jnp.einsum("bij,bj->bi", hierarchy.coarse_inverse, flat).reshape(residual.shape)
    partition, coarser = supports.partition, supports.partition.at_level(level + 1)
    smoother = level_smoother(hierarchy, supports, level)

    joins = coarser != partition
    state = smoother.before(smoother.start(residual), counts[level])
    joined = partition.whole_nodes(state.residual) if joins else state.residual
    nodes = _coarser_nodes(hierarchy, supports, level)
    coarse = coarser.add_interfaces(restrict(coarser.halve_interfaces(joined), nodes))
    found = _cycle(hierarchy, supports._replace(partition=coarser), counts, coarse, level + 1)
    if joins:
        correction = partition.own_nodes(prolong(found, _nodes(joined)))
        field = state.field + correction
    else:
        correction, field = add_prolonged(found, state.field)
    return smoother.after(SmootherState(correction, field, state.residual), counts[level]).field


def level_smoother(hierarchy: Hierarchy, supports: BoundaryConditions, level: int) -> Smoother:
    """Return the operator and steps of a level, 0 the finest."""
    steps = jacobi_scaling(hierarchy.steps[level], supports)
    if level == 0:
        arrays = hierarchy.blocks, hierarchy.moduli
        return Smoother("stiffness", apply_stiffness, arrays, steps, supports.partition)
    return Smoother("stencil", apply_stencil, (hierarchy.stencils[level - 1],), steps, supports.partition)


def _nodes(field: jax.Array) -> Cells:
    return field.shape[2], field.shape[3], field.shape[4]


def smoothing_steps(degree: _Count, level: int, nodes: int) -> _Count:
    """Return smoothing steps before and after a level's coarse correction; nodes are the finest's."""
    # Coarse levels cost little: smoothing them more saves a third of the cycles.
    halved = level == 1 and nodes > _LARGE_NODES
    return degree * (level + 1) // (2 if halved else 1)


def _coarser_nodes(hierarchy: Hierarchy, supports: BoundaryConditions, level: int) -> Cells:
    if level + 1 < len(hierarchy.steps):
        _, nx, ny, nz = hierarchy.steps[level + 1].shape
    else:
        nx, ny = supports.coarse_basis.shape[4:]
        nz = hierarchy.coarse_inverse.shape[-1] // (3 * nx * ny)
    return nx, ny, nz


def _coarse_inverse(dense: jax.Array, supports: BoundaryConditions) -> jax.Array:
    """Return dense inverse per case in the space of free nodes and section motions; 0 where it has none."""
    nodes = (supports.coarse_basis.shape[4], supports.coarse_basis.shape[5])
    size = dense.shape[0]
    layers = size // (3 * nodes[0] * nodes[1])
    diagonal = jnp.diagonal(dense)
    free = interior_mask(supports, (*nodes, layers), dense.dtype).reshape(-1, size) * (diagonal > 0)
    count = supports.springs.shape[1]
    motions = jnp.zeros((free.shape[0], count, 3, *nodes, layers), dense.dtype)
    motions = motions.at[..., 0].set(supports.coarse_basis[:, :, 0])
    motions = motions.at[..., -1].add(supports.coarse_basis[:, :, 1])
    motions = motions.reshape(free.shape[0], count, size)

    def invert(case: tuple[jax.Array, jax.Array, jax.Array]) -> jax.Array:
        free, motions, springs = case
        forces = motions @ dense
        mixed = forces * free
        section = forces @ motions.T + springs
        matrix = jnp.block([[dense * free * free[:, None], mixed.T], [mixed, section]])
        diagonal = jnp.diagonal(matrix)
        shift = jnp.where(diagonal > 0, _SHIFT * diagonal, jnp.max(diagonal))
        columns = jnp.concatenate([jnp.diag(free), motions])  # (n + m, n): admissible displacements
        factor = jax.scipy.linalg.cho_factor(matrix + jnp.diag(shift))
        solved = jax.scipy.linalg.cho_solve(factor, columns)
        inverse = free[:, None] * solved[:size] + motions.T @ solved[size:]
        return jnp.where(jnp.all(jnp.isfinite(inverse)), inverse, 0.0)

    # One after the other: with a stack of matrices a thread of jaxlib's pool (0.10.2) waits for others of the
    # pool, and two solves at once, each in a Python thread, wait for ever.
    return jax.lax.map(invert, (free, motions, supports.springs))


def project(
    supports: BoundaryConditions,
    field: jax.Array,
    scale: jax.Array | None = None,
    more: jax.Array | float = 0.0,
) -> jax.Array:
    """Return the orthogonal projection onto admissible fields: free nodes and rigid motions of the sections.

    For nodal forces it is the part that admissible displacements feel. The field is scaled per case before,
    the admissible field `more` added.
    """
    factor = jnp.ones(field.shape[0], field.dtype) if scale is None else scale
    mask = interior_mask(supports, _nodes(field), field.dtype)
    interior = factor[:, None, None, None, None] * field * mask + more
    return add_section(supports, interior, factor[:, None] * section_coordinates(supports, field))


def _safe_inverse(diagonal: jax.Array) -> jax.Array:
    return jnp.where(diagonal > 0, 1 / jnp.where(diagonal > 0, diagonal, 1), 0)
