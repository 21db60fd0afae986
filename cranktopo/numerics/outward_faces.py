"""Triangles of the open gmsh session, whole faces of closed bodies turned so that all normals point out."""

from __future__ import annotations

from collections import defaultdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Int64

_TRIANGLE = 2


def orient_outward(gmsh: Any, faces: list[int]) -> None:
    """Turn the triangles of whole CAD faces of one closed body so that all normals point out of it.

    gmsh's own rule shoots a ray from each face and errs where that passes near an edge. Neighbours tell: two
    faces agree where they run along their common edge in opposite directions; the volume tells which side
    is out.
    """
    from cranktopo.numerics.surfaces.mesh import SurfaceMesh

    found = {face: gmsh.model.mesh.getElementsByType(_TRIANGLE, face)[1] for face in faces}
    tags = {face: np.asarray(nodes, dtype=np.int64).reshape(-1, 3) for face, nodes in found.items()}
    turned, points = _turned(tags), _points(gmsh)
    volumes = {face: SurfaceMesh(points, corners).volume_mm3 for face, corners in tags.items()}
    volume = sum(-own if turned[face] else own for face, own in volumes.items())
    wrong = [(2, face) for face in faces if turned[face] != (volume < 0)]
    if wrong:
        gmsh.model.mesh.reverse(wrong)


def _points(gmsh: Any) -> NDArray[np.float64]:
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    points = np.zeros((int(tags.max()) + 1, 3))
    points[tags.astype(np.int64)] = coordinates.reshape(-1, 3)
    return points


def _turned(tags: dict[int, Int64]) -> dict[int, bool]:
    neighbours = _neighbours(tags)
    turned: dict[int, bool] = {}
    for first in tags:
        waiting = [] if first in turned else [first]
        turned.setdefault(first, False)
        while waiting:
            face = waiting.pop()
            for other, against in neighbours[face]:
                if other not in turned:
                    turned[other] = turned[face] != against
                    waiting.append(other)
    return turned


def _neighbours(tags: dict[int, Int64]) -> dict[int, list[tuple[int, bool]]]:
    """Faces that share an edge with each face, and whether they run along it in the same direction."""
    sides: dict[tuple[int, int], list[tuple[int, bool]]] = defaultdict(list)
    for face, corners in tags.items():
        for start, end in _border(corners):
            sides[min(start, end), max(start, end)].append((face, start < end))
    found: dict[int, list[tuple[int, bool]]] = defaultdict(list)
    for (face, forward), *others in sides.values():
        for other, along in others:
            if other != face:
                found[face].append((other, along == forward))
                found[other].append((face, along == forward))
    return found


def _border(triangles: Int64) -> list[tuple[int, int]]:
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    if not len(edges):
        return []
    _, place, count = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True, return_counts=True)
    alone = edges[count[place.ravel()] == 1]
    return [(int(start), int(end)) for start, end in alone]
