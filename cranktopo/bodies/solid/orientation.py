"""Triangles of a body's faces with outward normals, whatever the faces' own orientation."""

from __future__ import annotations

from collections import defaultdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

_Tags = NDArray[np.int64]
_TRIANGLE = 2


def orient_outward(gmsh: Any, faces: list[int]) -> None:
    """Turn the triangles of whole CAD faces of one closed body so that all normals point out of it.

    gmsh's own rule shoots a ray from each face and errs where that passes near an edge. Neighbours tell: two
    faces agree where they run along their common edge in opposite directions; the volume tells which side
    is out.
    """
    tags = {face: _triangles_of(gmsh, face) for face in faces}
    turned = _turned(tags)
    points = _points(gmsh)
    volume = sum(
        (-1.0 if turned[face] else 1.0) * float(_volumes(points, found).sum()) for face, found in tags.items()
    )
    wrong = [(2, face) for face in faces if turned[face] != (volume < 0)]
    if wrong:
        gmsh.model.mesh.reverse(wrong)


def _triangles_of(gmsh: Any, face: int) -> _Tags:
    """Node tags (n, 3) of the triangles of a face."""
    kinds, _, nodes = gmsh.model.mesh.getElements(2, face)
    found = [
        np.asarray(node, dtype=np.int64) for kind, node in zip(kinds, nodes, strict=True) if kind == _TRIANGLE
    ]
    return np.concatenate(found).astype(np.int64).reshape(-1, 3) if found else np.zeros((0, 3), np.int64)


def _points(gmsh: Any) -> NDArray[np.float64]:
    """Coordinates by node tag, (largest tag + 1, 3), mm."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    points = np.zeros((int(tags.max()) + 1, 3))
    points[tags.astype(np.int64)] = coordinates.reshape(-1, 3)
    return points


def _volumes(points: NDArray[np.float64], triangles: _Tags) -> NDArray[np.float64]:
    """Signed volumes of the tetrahedra from the origin to each triangle."""
    a, b, c = (points[triangles[:, corner]] for corner in range(3))
    return np.asarray(np.einsum("ij,ij->i", a, np.cross(b, c)) / 6)


def _turned(tags: dict[int, _Tags]) -> dict[int, bool]:
    """Return which faces run against the first one of their body."""
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


def _neighbours(tags: dict[int, _Tags]) -> dict[int, list[tuple[int, bool]]]:
    """Faces that share an edge with each face, and whether they run along it in the same direction."""
    first: dict[tuple[int, int], tuple[int, bool]] = {}
    found: dict[int, list[tuple[int, bool]]] = defaultdict(list)
    for face, triangles in tags.items():
        for start, end in _border(triangles):
            edge, forward = (min(start, end), max(start, end)), start < end
            if edge not in first:
                first[edge] = face, forward
                continue
            other, before = first[edge]
            if other != face:
                found[face].append((other, before == forward))
                found[other].append((face, before == forward))
    return found


def _border(triangles: _Tags) -> list[tuple[int, int]]:
    """Directed edges (start, end) that only one triangle of a face has."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    if not len(edges):
        return []
    _, place, count = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True, return_counts=True)
    alone = edges[count[place.ravel()] == 1]
    return [(int(start), int(end)) for start, end in alone]
