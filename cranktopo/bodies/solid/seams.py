"""Seams of faces: where that of a hole lies, and whether a spline around it ends where it began."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from cranktopo.bodies.solid.boundaries import edges_of, faces_of
from cranktopo.numerics.gmsh_session import DimTags
from cranktopo.throw.primitives import Cylinder

_CLOSED_MM = 1e-5
"""Distance of both ends of a closed surface, that of edges in files: 1e-12 is usual, 6e-4 was found."""
_PLACES = 11
"""Places along a seam at which it is looked at."""


def seams_closed(occ: Any, body: DimTags) -> bool:
    """Tell whether every spline of a body that goes around ends where it began.

    The kernel leaves a rounding now and then open by a micrometre, by where its seam lies. STEP says of such
    a surface that it is not closed, and a kernel that reads the file takes both sides of the seam for one.
    """
    seams = (tag for tag in _splines(occ, body) if _has_seam(tag))
    return all(min(_gap_mm(tag, 0), _gap_mm(tag, 1)) < _CLOSED_MM for tag in seams)


def seam_turned(occ: Any, body: DimTags, cylinder: Cylinder) -> DimTags:
    """Return the body of a cylinder, which must not lie along the crank, with its seam where it is wanted."""
    around = (list(map(abs, edges_of(occ, face))) for face in faces_of(occ, body))
    seam = next(edge for edges in around for edge in edges if edges.count(edge) == 2)
    start, axis = np.array(cylinder.start), np.array(cylinder.axis) / np.linalg.norm(cylinder.axis)
    now, wanted = np.array(occ.getCenterOfMass(1, seam)) - start, np.array([0.0, 0.0, cylinder.seam])
    turn = math.atan2(np.cross(now, wanted) @ axis, now @ wanted - (now @ axis) * (wanted @ axis))
    occ.rotate(body, *cylinder.start, *cylinder.axis, turn)
    return body


def has_splines(occ: Any, body: DimTags) -> bool:
    """Tell whether a face of a body is a spline."""
    return bool(_splines(occ, body))


def _splines(occ: Any, body: DimTags) -> list[int]:
    import gmsh

    occ.synchronize()
    faces = (tag for _, tag in gmsh.model.getBoundary(body, oriented=False))
    return [tag for tag in faces if gmsh.model.getType(2, tag) == "BSpline surface"]


def _has_seam(face: int) -> bool:
    """Tell whether an edge bounds a face from both sides."""
    import gmsh

    edges = {edge for _, edge in gmsh.model.getBoundary([(2, face)], combined=False, oriented=True)}
    return any(-edge in edges for edge in edges)


def _gap_mm(face: int, direction: int) -> float:
    """Return the largest distance of both ends of a face's range in one of its parameters."""
    import gmsh

    low, high = np.array(gmsh.model.getParametrizationBounds(2, face))
    sides = []
    for end in (low, high):
        side = low + (high - low) * np.linspace(0, 1, _PLACES)[:, None]
        side[:, direction] = end[direction]
        sides.append(np.array(gmsh.model.getValue(2, face, side.ravel())).reshape(-1, 3))
    return float(np.linalg.norm(sides[1] - sides[0], axis=1).max())
