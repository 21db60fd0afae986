"""Volume of a solid by quadratic triangles on its faces, beside the CAD kernel's own integration.

The kernel integrates a face over its parameters, and misses up to 5e-5 of a body's volume where the curves
that end the face turn sharply, 1e-3 where that face goes around an ellipse. Triangles do not know parameters.
At the size taken here they miss 7e-6 of a ring, which is nothing but curved, and less than 1e-6 of most
bodies.
"""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import dataclass
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array, Index
from cranktopo.numerics.gmsh_session import DELAUNAY, with_option

_PER_TURN, _ALONG = 24, 40
"""Triangles to a full turn of the smaller radius of curvature, and along the largest extent of the solid."""
_QUADRATIC = 9
"""Number that gmsh gives to triangles of six nodes."""
_ORDER = 8
"""Of the quadrature: exact for the moments of inertia below six-node triangles."""


@dataclass(frozen=True)
class SolidMoments:
    """Volume, mm3, centre, mm, and the integral of x2 + y2, mm5."""

    volume: float
    centre: tuple[float, float, float]
    polar: float


def triangulated_volume_mm3(solid: int) -> float:
    """Return the volume of a solid of the open session, which has no mesh before and after."""
    return triangulated_moments(solid).volume


def triangulated_moments(solid: int) -> SolidMoments:
    """Return the moments of a solid of the open session, which has no mesh before and after."""
    import gmsh

    gmsh.model.occ.synchronize()
    every = gmsh.model.getEntities()
    low, high = np.reshape(gmsh.model.getBoundingBox(3, solid), (2, 3))
    with ExitStack() as options:
        options.enter_context(with_option("Mesh.MeshSizeFromCurvature", _PER_TURN))
        options.enter_context(with_option("Mesh.MeshSizeMax", float((high - low).max()) / _ALONG))
        options.enter_context(with_option("Mesh.MeshOnlyVisible", 1))
        options.enter_context(with_option("Mesh.Algorithm", DELAUNAY))
        gmsh.model.setVisibility(every, 0)
        gmsh.model.setVisibility([(3, solid)], 1, recursive=True)
        try:
            gmsh.model.mesh.generate(2)
            gmsh.model.mesh.setOrder(2)
            return moments_of(*_triangles(gmsh, solid))
        finally:
            gmsh.model.mesh.clear()
            gmsh.model.setVisibility(every, 1)


def _triangles(gmsh: Any, solid: int) -> tuple[Array, Index]:
    """Return nodes (n, 3) and the six nodes of each triangle on the faces of a solid, (triangles, 6)."""
    numbers, places, _ = gmsh.model.mesh.getNodes()
    position = np.zeros(int(numbers.max()) + 1, dtype=np.intp)
    position[numbers.astype(np.intp)] = np.arange(len(numbers))
    found = []
    for _, face in gmsh.model.getBoundary([(3, solid)], oriented=False):
        _, of_face = gmsh.model.mesh.getElementsByType(_QUADRATIC, face)
        found.append(position[of_face.astype(np.intp)].reshape(-1, 6))
    return places.reshape(-1, 3), np.concatenate(found)


def moments_of(nodes_mm: Array, triangles: Index) -> SolidMoments:
    """Return the moments of what is inside a closed surface of six-node triangles, whatever way each turns.

    Args:
        triangles: corners, then the nodes of the edges 01, 12 and 20, (n, 6).
    """
    from cranktopo.numerics.tetrahedra.elasticity import (
        triangle_quadrature,
    )  # loads SciPy; few bodies come here

    values, slopes, weights = triangle_quadrature(_ORDER)
    middle = nodes_mm.mean(axis=0)
    at, shapes = nodes_mm[triangles] - middle, (values, slopes[..., 0], slopes[..., 1])
    place, one, other = (np.einsum("qn,tni->tqi", own, at) for own in shapes)
    cones = np.einsum("tqi,tqi,q->tq", place, np.cross(one, other), weights)
    cones *= _senses(nodes_mm, triangles)[:, None]
    cones *= np.sign(cones.sum())
    volume, from_middle = cones.sum() / 3, np.einsum("tq,tqi->i", cones, place) / 4
    squares = np.einsum("tq,tqi->i", cones, place[..., :2] ** 2).sum() / 5
    x, y, z = map(float, middle + from_middle / volume)
    polar = squares + 2 * middle[:2] @ from_middle[:2] + volume * middle[:2] @ middle[:2]
    return SolidMoments(float(volume), (x, y, z), float(polar))


def _senses(nodes_mm: Array, triangles: Index) -> Array:
    """Return +1 for triangles that turn as the first of their surface does, else -1."""
    from trimesh import Trimesh, repair

    turned = Trimesh(nodes_mm, triangles[:, :3], process=False)
    repair.fix_winding(turned)
    corners = triangles[:, :3]
    kept = (np.stack([np.roll(corners, shift, axis=1) for shift in range(3)]) == turned.faces).all(axis=2)
    return np.where(kept.any(axis=0), 1.0, -1.0)
