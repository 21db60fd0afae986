"""Faces of bodies, and edges of faces, without a synchronised model; how far curves end from their points."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from cranktopo.numerics.gmsh_session import DimTags


def faces_of(occ: Any, body: DimTags) -> Iterator[int]:
    """Yield the faces of all solids of a body."""
    return (
        int(face) for dim, tag in body if dim == 3 for shell in occ.getSurfaceLoops(tag)[1] for face in shell
    )


def edges_of(occ: Any, face: int) -> Iterator[int]:
    """Yield the edges around a face; one that bounds it from both sides twice."""
    return (int(edge) for loop in occ.getCurveLoops(face)[1] for edge in loop)


def apart_mm(gmsh: Any) -> float:
    """Return the largest distance of the end of a curve of the synchronised model from its point, mm."""
    model, found = gmsh.model, [0.0]
    for curve in model.getEntities(1):
        points = [tag for _, tag in model.getBoundary([curve], combined=False, oriented=False)]
        places = np.reshape([model.getValue(0, tag, []) for tag in points], (-1, 3))
        for end in model.getParametrizationBounds(*curve) if points else ():
            found.append(float(np.linalg.norm(places - model.getValue(*curve, end), axis=1).min()))
    return max(found)
