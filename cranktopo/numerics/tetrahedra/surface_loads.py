"""Nodal forces of pressure on parts of a body's surface, on curved faces, through scikit-fem."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.errors import solver_error
from cranktopo.numerics.tetrahedra.elasticity import LOAD_ORDER, Elasticity
from cranktopo.numerics.tetrahedra.node_gradients import gather, nodal_values


def faces_where(model: Elasticity, inside: Callable[[Array], NDArray[np.bool_]]) -> Any:
    """Return the basis of the surface's faces whose three corners are inside; points have shape (3, n).

    Raises:
        CranktopoError: no face is, or an element there is bent too much.
    """
    from skfem import ElementTetP2, FacetBasis

    mesh = model.mesh
    outer = mesh.boundary_facets()
    chosen = outer[inside(mesh.p)[mesh.facets[:, outer]].all(axis=0)]
    if not len(chosen):
        raise solver_error("mesh: no element on a loaded face.", "Choose a smaller element size.")
    try:
        return FacetBasis(mesh, ElementTetP2(), facets=chosen, intorder=LOAD_ORDER)
    except Exception as error:  # scikit-fem has no class of its own for it
        if not str(error).startswith("Newton iteration"):
            raise
        raise solver_error(
            "mesh: an element on a loaded face is bent too much.", "Choose a smaller element size."
        ) from None


def pressure_force(model: Elasticity, faces: Any, pressure_MPa: Array) -> Array:
    """Return the nodal forces of a pressure at the points of faces, shape (unknowns,), N.

    Args:
        faces: basis of `faces_where`; its points are `faces.global_coordinates()`, (3, faces, points).
        pressure_MPa: shape (faces, points); positive presses into the body.
    """
    force = np.zeros(model.nodes_mm.shape)
    weights = -pressure_MPa * faces.dx * np.asarray(faces.normals)
    gather(force, faces, np.einsum("neq,ieq->nie", nodal_values(faces), weights, optimize=True))
    return force.T.ravel()


def face_shares(model: Elasticity, faces: Any) -> Array:
    """Return what each node has of the area of faces, shape (nodes,), in sum 1."""
    shares = np.einsum("neq,eq->ne", nodal_values(faces), faces.dx)
    total = np.bincount(faces.element_dofs.ravel(), shares.ravel(), minlength=model.nodes_mm.shape[1])
    return np.asarray(total / faces.dx.sum())


def from_faces(model: Elasticity, faces: Any, weights: Array) -> Array:
    """Return rows that displacements of the nodes give sums of weights by, (k, unknowns).

    Args:
        weights: of the components of the displacement at the points of faces, (k, faces * points, 3).
    """
    values, count = nodal_values(faces), model.nodes_mm.shape[1]
    at_points = weights.reshape(len(weights), *faces.dx.shape, 3)
    shares = np.einsum("neq,keqi->kine", values, at_points, optimize=True)
    rows = np.zeros((len(weights), 3, count))
    for row, share in zip(rows.reshape(-1, count), shares.reshape(-1, *shares.shape[2:]), strict=True):
        np.add.at(row, faces.element_dofs, share)
    return rows.transpose(0, 2, 1).reshape(len(weights), -1)
