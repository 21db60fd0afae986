"""Boundary conditions of the load cases: mirror planes and rigid end sections with a few free motions.

A rigid section is not modelled by stiff cells. Displacements are kept in the space where the section
moves as R q, on every level of the multigrid hierarchy: trilinear interpolation reproduces a rigid motion
of a plane exactly, so the coarse spaces are nested.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.numerics.device_arrays import on_device
from cranktopo.numerics.grid.lattice import Cells, Lattice
from cranktopo.numerics.grid.partition import WHOLE, Partition

# Rigid motions of a section about its centre.
MOTIONS = ("tx", "ty", "tz", "rx", "ry", "rz")


@dataclass(frozen=True)
class SectionMotion:
    """One free motion of a rigid end section: `plane` 0 is at the first z plane, -1 at the last.

    Translations are "tx", "ty", "tz" (mm), rotations "rx", "ry", "rz" (rad); stiffness of a spring to ground
    in N/mm or N mm/rad, generalised load in N or N mm.
    """

    plane: int
    motion: str
    stiffness: float = 0.0
    load: float = 0.0


@dataclass(frozen=True)
class CaseSupports:
    """Supports of one load case: components fixed by mirrors at x = 0 and at the last z plane, empty without.

    Motions of the rigid sections that are not named are held at zero.
    """

    fixed_at_x0: tuple[int, ...]
    fixed_at_z_end: tuple[int, ...]
    motions: tuple[SectionMotion, ...]


class BoundaryConditions(NamedTuple):
    """Supports of all cases as arrays; m is the largest number of section motions, padded with zeros.

    Attributes:
        free_x0: (cases, 3) 0 where the component is fixed on x = 0, else 1.
        free_z_end: (cases, 3) likewise on the last z plane; all 0 where that plane is a rigid section.
        basis: (cases, m, 2, 3, nx + 1, ny + 1) orthonormal section motions on the first and last plane.
        coarse_basis: the same motions on the coarsest grid's nodes.
        springs: (cases, m, m) spring stiffness in the coordinates of `basis`.
    """

    free_x0: jax.Array
    free_z_end: jax.Array
    basis: jax.Array
    coarse_basis: jax.Array
    springs: jax.Array
    partition: Partition = WHOLE


def build_supports(
    lattice: Lattice, origin_mm: tuple[float, float], levels: int, cases: tuple[CaseSupports, ...]
) -> tuple[BoundaryConditions, Array]:
    """Return the supports as arrays, and nodal forces (cases, 3, nodes...) of the loads on section motions.

    Args:
        origin_mm: x and y of the grid's first node relative to the centre of the sections, mm.
        levels: number of halvings between the finest and the coarsest grid.
    """
    # One size for all supports, so that another support needs no new compilation.
    size = max(len(MOTIONS), *(len(case.motions) for case in cases))
    parts = [_case_arrays(lattice, origin_mm, levels, case, size) for case in cases]
    basis, coarse, springs, loads = (np.stack(items) for items in zip(*parts, strict=True))
    supports = BoundaryConditions(
        free_x0=on_device([[0.0 if c in case.fixed_at_x0 else 1.0 for c in range(3)] for case in cases]),
        free_z_end=on_device([_free_at_z_end(case) for case in cases]),
        basis=on_device(basis),
        coarse_basis=on_device(coarse),
        springs=on_device(springs),
    )
    forces = np.zeros((len(cases), *lattice.field_shape))
    forces[..., 0] = np.einsum("bm,bmcxy->bcxy", loads, basis[:, :, 0])
    forces[..., -1] += np.einsum("bm,bmcxy->bcxy", loads, basis[:, :, 1])
    return supports, forces


def interior_factors(
    supports: BoundaryConditions, nodes: tuple[int, int, int]
) -> tuple[jax.Array, jax.Array]:
    """Return the factors of `interior_mask` along x (cases, 3, nx + 1) and along z (cases, 3, nz + 1)."""
    along_x = jnp.ones((*supports.free_x0.shape, nodes[0])).at[:, :, 0].set(supports.free_x0)
    first, last = supports.partition.at_first_plane(), supports.partition.at_last_plane()
    along_z = jnp.ones((*supports.free_x0.shape, nodes[2])).at[:, :, 0].set(jnp.where(first, 0.0, 1.0))
    along_z = along_z.at[:, :, -1].set(jnp.where(last, supports.free_z_end, 1.0))
    return along_x, along_z


def interior_mask(supports: BoundaryConditions, nodes: tuple[int, int, int], dtype: jnp.dtype) -> jax.Array:
    """Return the mask (cases, 3, nodes...): 1 where a component moves freely, else 0."""
    along_x, along_z = interior_factors(supports, nodes)
    mask = along_x[:, :, :, None, None] * along_z[:, :, None, None, :]
    return jnp.broadcast_to(mask, (*mask.shape[:2], *nodes)).astype(dtype)


def section_coordinates(supports: BoundaryConditions, field: jax.Array) -> jax.Array:
    """Return the inner products (cases, m) of the section motions with a field's end planes."""
    return coordinates_of_ends(supports, jnp.stack([field[..., 0], field[..., -1]], axis=-1))


def coordinates_of_ends(supports: BoundaryConditions, ends: jax.Array) -> jax.Array:
    """Return the same from the end planes alone (cases, 3, nodes along x, along y, 2)."""
    coordinates = jnp.einsum("bmpcxy,bcxyp->bm", _basis(supports, ends.dtype), ends)
    return supports.partition.sum_parts(coordinates)


def add_section(supports: BoundaryConditions, field: jax.Array, coordinates: jax.Array) -> jax.Array:
    """Return the field plus section motions on the end planes."""
    ends = jnp.einsum("bmpcxy,bm->bpcxy", _basis(supports, field.dtype), coordinates)
    return field.at[..., 0].add(ends[:, 0]).at[..., -1].add(ends[:, 1])


def _basis(supports: BoundaryConditions, dtype: jnp.dtype) -> jax.Array:
    """Return the section motions on the end planes of a part: 0 where another part goes on."""
    basis = supports.basis.astype(dtype)
    if supports.partition.parts == 1:
        return basis
    ends = jnp.stack([supports.partition.at_first_plane(), supports.partition.at_last_plane()])
    return basis * ends[:, None, None, None]


def _free_at_z_end(case: CaseSupports) -> list[float]:
    rigid = any(motion.plane == -1 for motion in case.motions)
    return [0.0 if rigid or c in case.fixed_at_z_end else 1.0 for c in range(3)]


def _case_arrays(
    lattice: Lattice, origin_mm: tuple[float, float], levels: int, case: CaseSupports, size: int
) -> tuple[Array, Array, Array, Array]:
    fine = _motion_fields(lattice, origin_mm, (1, 1, 1), case)
    coarse = _motion_fields(lattice, origin_mm, lattice.coarsenings(levels)[-1], case)
    count = len(case.motions)
    basis = np.zeros((size, *fine.shape[1:]))
    coarse_basis = np.zeros((size, *coarse.shape[1:]))
    springs, loads = np.zeros((size, size)), np.zeros(size)
    if count:
        q, triangle = np.linalg.qr(fine.reshape(count, -1).T)
        inverse = np.linalg.inv(triangle)  # motion amplitudes = inverse @ coordinates
        basis[:count] = q.T.reshape(fine.shape)
        coarse_basis[:count] = np.einsum("mk,m...->k...", inverse, coarse)
        stiffness = np.diag([motion.stiffness for motion in case.motions])
        springs[:count, :count] = inverse.T @ stiffness @ inverse
        loads[:count] = inverse.T @ np.array([motion.load for motion in case.motions])
    return basis, coarse_basis, springs, loads


def _motion_fields(
    lattice: Lattice, origin_mm: tuple[float, float], factors: Cells, case: CaseSupports
) -> Array:
    """Return the unit motions (motions, 2, 3, nx + 1, ny + 1) on the end planes of a coarse grid."""
    nx, ny = lattice.cells[0] // factors[0], lattice.cells[1] // factors[1]
    x, y = np.meshgrid(
        origin_mm[0] + lattice.dx_mm * factors[0] * np.arange(nx + 1),
        origin_mm[1] + lattice.dy_mm * factors[1] * np.arange(ny + 1),
        indexing="ij",
    )
    zero, one = np.zeros_like(x), np.ones_like(x)
    unit = {
        "tx": (one, zero, zero),
        "ty": (zero, one, zero),
        "tz": (zero, zero, one),
        "rx": (zero, zero, y),
        "ry": (zero, zero, -x),
        "rz": (-y, x, zero),
    }
    fields = np.zeros((len(case.motions), 2, 3, nx + 1, ny + 1))
    for index, motion in enumerate(case.motions):
        field = np.array(unit[motion.motion])
        for component in case.fixed_at_x0:
            if np.abs(field[component][np.isclose(x, 0.0)]).max(initial=0.0) > 0.0:
                raise ValueError(f"section motion {motion.motion} contradicts the mirror x = 0")
        fields[index, motion.plane] = field
    return fields
