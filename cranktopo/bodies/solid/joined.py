"""A second try of the CAD kernel, in which it takes points near each other for one.

Where two faces of a tool are tangent, as of a slot with rounded corners, the kernel intersects each with
an outline of splines by itself, and the curves miss each other by 1e-5 to 3e-4 mm. It then leaves an edge of
that length, on which triangles do not close, or loses the body.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from cranktopo.bodies.solid.boundaries import edges_of, faces_of
from cranktopo.bodies.solid.checked import ClosedForm, misfit
from cranktopo.numerics.gmsh_session import DimTags, points_joined

_SHORT_MM = 5e-4
"""Length of an edge, on a throw of usual size, that no dimension has."""
_JOINED_MM = 1e-4
"""Distance, on a throw of usual size, within which points are one; STEP files tell it as their tolerance."""
_POINT_MM = 1e-7


def with_joined_edges(occ: Any, build: Callable[[], DimTags], form: ClosedForm, scale: float) -> DimTags:
    """Return what is built, from a second try where the first one misfits or has an edge that is too short.

    Args:
        scale: factor that brings the throw to usual size.
    """
    body = build()
    if misfit(occ, body, form) <= 1 and shortest_edge_mm(occ, body) >= _SHORT_MM / scale:
        return body
    with points_joined(_JOINED_MM / scale):
        other = build()
    kept, lost = (other, body) if misfit(occ, other, form) <= 1 else (body, other)
    occ.remove(lost, recursive=True)
    return kept


def shortest_edge_mm(occ: Any, body: DimTags) -> float:
    """Return the length of the shortest edge of a body, mm; a pole, which is a point, does not count."""
    edges = (edge for face in faces_of(occ, body) for edge in edges_of(occ, face))
    lengths = (float(occ.getMass(1, edge)) for edge in edges)
    return min((length for length in lengths if length > _POINT_MM), default=math.inf)
