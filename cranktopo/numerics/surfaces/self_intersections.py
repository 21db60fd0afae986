"""Where a closed surface passes through itself."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, solid_of


@lru_cache(maxsize=1)
def self_intersections_mm(mesh: SurfaceMesh) -> Array:
    """Ends of the edges that pierce a face which they do not touch.

    Two faces that intersect without sharing a vertex have such an edge. Extraction and its checks ask
    for the same mesh: the last answer is kept.

    Returns:
        Points, (n, 3), mm; none for a sound surface.

    Raises:
        CranktopoError: the surface is not closed and oriented.
    """
    return np.array(list(_piercing_edges(mesh)), dtype=np.float64).reshape(-1, 3)


def _piercing_edges(mesh: SurfaceMesh) -> Iterator[list[float]]:
    solid = solid_of(mesh)
    kept = solid.to_mesh64()
    points, faces = np.asarray(kept.vert_properties)[:, :3], np.asarray(kept.tri_verts).astype(np.int64)
    pairs = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    edges = pairs[pairs[:, 0] < pairs[:, 1]]  # each edge of a closed oriented mesh once
    places, corners = points.tolist(), faces.tolist()  # lists: a cast ray costs less than an array's index
    for start, end in edges.tolist():
        for hit in solid.ray_cast(tuple(places[start]), tuple(places[end])):
            if start not in (face := corners[hit.face_id]) and end not in face:
                yield places[start]
