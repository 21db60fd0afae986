"""Rigid motions of a body and of its plane sections, and what mirror planes hold of its displacements.

Motions (ux, uy, uz, rx, ry, rz) of a section across z: translations of its centre and rotations about its
axes, mm and rad.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Index
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.numerics.tetrahedra.elasticity import Elasticity

UX, UY, UZ, RX, RY, RZ = range(6)
_PLANE_MM = 1e-6


def plane_nodes(nodes_mm: Array, axis: int, position_mm: float) -> NDArray[np.intp]:
    """Return the nodes, of (3, n), on the plane across an axis; CranktopoError where there are none."""
    found = np.nonzero(np.abs(nodes_mm[axis] - position_mm) < _PLANE_MM)[0]
    if found.size == 0:
        raise CranktopoError(
            f"mesh: no nodes on the plane {'xyz'[axis]} = {position_mm:g} mm.",
            hint="The body must reach that plane.",
            code=ExitCode.SOLVER,
        )
    return found


def held_by_mirror(nodes_mm: Array, axis: int, position_mm: float, *, even: bool) -> Index:
    """Return the unknowns that a mirror plane holds: across it in even motion, along it in odd one."""
    nodes = plane_nodes(nodes_mm, axis, position_mm)
    held = [own for own in range(3) if (own == axis) == even]
    return (3 * nodes[:, None] + held).ravel()


def section_motions(nodes_mm: Array, section: NDArray[np.intp]) -> Array:
    """Return the six rigid motions of a section across z about its own centre, (unknowns, 6)."""
    x, y = nodes_mm[0, section], nodes_mm[1, section]
    motions = np.zeros((nodes_mm.size, 6))
    for axis in range(3):
        motions[3 * section + axis, axis] = 1.0
    motions[3 * section + 2, RX] = y
    motions[3 * section + 2, RY] = -x
    motions[3 * section, RZ] = -y
    motions[3 * section + 1, RZ] = x
    return motions


def body_motions(nodes_mm: Array) -> Array:
    """Return the six rigid motions of the whole body about the origin, (unknowns, 6)."""
    body = section_motions(nodes_mm, np.arange(nodes_mm.shape[1]))
    body[1::3, RX], body[::3, RY] = -nodes_mm[2], nodes_mm[2]
    return body


def section_slopes(model: Elasticity, forces: Array, field: Array, z_mm: float = 0.0) -> Array:
    """Return the derivative of forces' field by the nodes of a rigid section, (3, nodes), forces held."""
    section, turns = section_turns(model, field[:, None], z_mm)
    total = np.zeros(model.nodes_mm.shape)
    total[:, section] = np.cross(forces.reshape(-1, 3)[section], turns[:, 0]).T
    return total


def section_turns(model: Elasticity, fields: Array, z_mm: float) -> tuple[NDArray[np.intp], Array]:
    """Return the nodes of a rigid section, and its rotations in fields (unknowns, k), rad, (3, k)."""
    section = plane_nodes(model.nodes_mm, 2, z_mm)
    unknowns = (3 * section[:, None] + np.arange(3)).ravel()
    rigid = section_motions(model.nodes_mm, section)[unknowns]
    return section, np.linalg.lstsq(rigid, fields[unknowns], rcond=None)[0][[RX, RY, RZ]]
