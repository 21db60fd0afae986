"""What straightened elements add to the energy: the part of the error that is in the shape of a mesh.

Where bending an element to the surface would fold it, its edge nodes stay off the surface. To first order
the energy of displacements changes by its derivative along the way to the surface, with no other solve.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.numerics.tetrahedra.elasticity import STIFFNESS_ORDER, Elasticity
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.tasks.fea.condense import Superelement
from cranktopo.tasks.fea.node_gradients import chunks, section_slopes, shape_slopes, work_slopes


def straightened(
    model: Elasticity, mesh: TetMesh, blocks: Sequence[Superelement], youngs_MPa: float, poisson: float
) -> tuple[list[Array], float]:
    """Energy that straight elements add to fields of condensed blocks, and the volume of the model, mm3.

    Returns:
        A quadratic form per block, less than 0 where volume is added, as `hierarchical_estimator` has them:
        twice the energy that the mesh misses; and the volume that it has too much.
    """
    away = np.zeros(model.nodes_mm.shape)
    if mesh.off_surface_mm is not None:
        away[:, model.mesh.dofs.element_dofs] = mesh.off_surface_mm[:, mesh.cells]
    off = (away != 0).any(axis=0, keepdims=True)[0]
    moved = np.flatnonzero(off[model.mesh.dofs.element_dofs].any(axis=0))
    if not len(moved):
        return [np.zeros((block.fields.shape[1],) * 2) for block in blocks], 0.0
    forms = [-block.parts * _added(model, block, away, moved, youngs_MPa, poisson) for block in blocks]
    return forms, _volume(model, away, moved)


def _added(
    model: Elasticity,
    block: Superelement,
    away: Array,
    moved: NDArray[np.intp],
    youngs_MPa: float,
    poisson: float,
) -> Array:
    """Return what twice the energy of a block's fields gains, to first order, where the nodes go all the way.

    Sections move rigidly as before; where the pin load acts is held.
    """
    fields = block.fields.T
    forces = (model.stiffness @ block.fields).T
    form = np.zeros((len(fields),) * 2)
    ends = (0.0,) if block.copies == 2 else (0.0, float(model.nodes_mm[2].max()))
    for i, j in zip(*np.triu_indices(len(fields)), strict=True):
        slopes = work_slopes(model, youngs_MPa, poisson, fields[i], fields[j], moved)
        for z in ends:
            slopes += section_slopes(model, forces[i], fields[j], z)
            slopes += section_slopes(model, forces[j], fields[i], z)
        form[i, j] = form[j, i] = (slopes * away).sum()
    return form


def _volume(model: Elasticity, away: Array, moved: NDArray[np.intp]) -> float:
    """Volume that the way of the nodes takes off, to first order."""
    taken = 0.0
    for basis in chunks(model, STIFFNESS_ORDER, moved):
        way = away[:, basis.element_dofs]
        taken -= float(np.einsum("jne,njeq,eq->", way, shape_slopes(basis), basis.dx, optimize=True))
    return taken
