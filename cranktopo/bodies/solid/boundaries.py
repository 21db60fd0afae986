"""Faces of bodies, and edges of faces, without a synchronised model."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from cranktopo.numerics.gmsh_session import DimTags


def faces_of(occ: Any, body: DimTags) -> Iterator[int]:
    """Yield the faces of all solids of a body."""
    return (
        int(face) for dim, tag in body if dim == 3 for shell in occ.getSurfaceLoops(tag)[1] for face in shell
    )


def edges_of(occ: Any, face: int) -> Iterator[int]:
    """Yield the edges around a face; one that bounds it from both sides twice."""
    return (int(edge) for loop in occ.getCurveLoops(face)[1] for edge in loop)
