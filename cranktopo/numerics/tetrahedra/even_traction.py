"""Even traction on part of a body's surface, as nodal forces, and their change with the nodes' places.

Faces are six-node triangles with points of their own, so that no point must be sought in an element.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Index
from cranktopo.base.errors import solver_error
from cranktopo.numerics.tetrahedra.elasticity import LOAD_ORDER, Elasticity, triangle_quadrature
from cranktopo.numerics.tetrahedra.stress import boundary_faces

Where = Callable[[Array], NDArray[np.bool_]]
"""Tells which points (3, ...) belong to a part of the surface."""
Share = Callable[[Array], Array]
"""Share of the full traction that points (3, ...) have, from 0 to 1, without jumps."""
_STEP_MM = 1e-6
"""Step of central differences of shares by the place of a point."""


@dataclass(frozen=True)
class EvenTraction:
    """1 N along a direction, even over part of the surface but for its rim.

    Attributes:
        faces: nodes, (6, f).
        values, gradients: of the shape functions at the points, (points, 6) and (points, 6, 2).
        weights: of the points on the reference triangle, (points,).
    """

    model: Elasticity
    direction: Array
    faces: Index
    share: Share
    values: Array
    gradients: Array
    weights: Array

    def forces(self) -> Array:
        """Return the nodal forces, (unknowns,), N."""
        area = self.share(self._points()) * np.linalg.norm(self._normals(), axis=0) * self.weights
        if not area.any():
            raise solver_error("mesh: no element on a loaded face.", "Choose a smaller element size.")
        at_nodes = area @ self.values / area.sum()  # (f, 6)
        total = np.bincount(self.faces.T.ravel(), at_nodes.ravel(), minlength=self.model.nodes_mm.shape[1])
        return np.outer(total, self.direction).ravel()

    def slopes(self, adjoint: Array) -> Array:
        """Return the derivative of sum(adjoint * forces) by the nodes, (3, nodes); adjoint (unknowns,)."""
        points, normals = self._points(), self._normals()
        size = np.linalg.norm(normals, axis=0)
        along = adjoint.reshape(-1, 3) @ self.direction
        at_points = np.einsum("nf,pn->fp", along[self.faces], self.values)
        full = self.share(points) * self.weights
        total = (full * size).sum()
        beyond = (at_points - (full * size * at_points).sum() / total) / total  # by what a point weighs
        unit = normals / size * full * beyond
        du, dv = np.moveaxis(self._tangents(), 1, 0)
        # the derivative of |du x dv| by du is dv x n, by dv it is n x du
        at_nodes = np.einsum("ifp,pn->inf", np.cross(dv, unit, axis=0), self.gradients[..., 0])
        at_nodes += np.einsum("ifp,pn->inf", np.cross(unit, du, axis=0), self.gradients[..., 1])
        moved = self._share_slopes(points) * self.weights * size * beyond
        at_nodes += np.einsum("ifp,pn->inf", moved, self.values)
        found = np.zeros_like(self.model.nodes_mm)
        for row, part in zip(found, at_nodes, strict=True):
            np.add.at(row, self.faces, part)
        return found

    def _share_slopes(self, points: Array) -> Array:
        """Derivatives of the shares by the places of points, (3, f, points)."""
        steps = _STEP_MM * np.eye(3)[:, :, None, None]
        return np.stack([self.share(points + step) - self.share(points - step) for step in steps]) / (
            2 * _STEP_MM
        )

    def _points(self) -> Array:
        """Places of the points, (3, f, points)."""
        return np.einsum("inf,pn->ifp", self.model.nodes_mm[:, self.faces], self.values)

    def _tangents(self) -> Array:
        """Derivatives of the place by both coordinates of the faces, (3, 2, f, points)."""
        return np.einsum("inf,pnk->ikfp", self.model.nodes_mm[:, self.faces], self.gradients)

    def _normals(self) -> Array:
        tangents = self._tangents()
        return np.cross(tangents[:, 0], tangents[:, 1], axis=0)


def even_traction(model: Elasticity, direction: Array, faces: Where, share: Share) -> EvenTraction:
    """Return 1 N along a direction (3,) on those faces whose corners are where `faces` says."""
    cells = model.mesh.dofs.element_dofs
    local, owners = boundary_faces(cells)
    every = cells[local, owners]
    chosen = every[:, faces(model.nodes_mm[:, every[:3]]).all(axis=0)]
    return EvenTraction(model, direction, chosen, share, *triangle_quadrature(LOAD_ORDER))
