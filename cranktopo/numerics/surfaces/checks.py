"""What a mesh must be before it is written: a closed 2-manifold that does not pass through itself."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.numerics.surfaces.mesh import DEGENERATE_MM2, SurfaceMesh, connected, solid_of


@lru_cache(maxsize=1)
def self_intersections_mm(mesh: SurfaceMesh) -> Array:
    """Return ends (n, 3), mm, of edges that pierce a face which they do not touch; none for a sound surface.

    Two faces that intersect without sharing a vertex have such an edge. Extraction and its checks ask for the
    same mesh: the last answer is kept.
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


_REMEDY = "Extract again at another resolution."


def check_manifold(mesh: SurfaceMesh) -> None:
    """Check that a mesh is a closed, outward 2-manifold without degenerate faces (CRITERION_NOT_MET)."""
    fault = manifold_fault(mesh)
    if fault:
        raise surface_refusal(fault, _REMEDY)


@lru_cache(maxsize=1)
def manifold_fault(mesh: SurfaceMesh) -> str:
    """Tell why a mesh is no closed outward 2-manifold of faces with an area; empty where it is one.

    Extraction and its checks ask for the same mesh: the last answer is kept.
    """
    surface = mesh.as_trimesh()
    if not surface.is_watertight:
        return "not watertight, or more than two faces at an edge"
    if not surface.is_winding_consistent:
        return "its faces are not oriented alike"
    if mesh.volume_mm3 <= 0:
        return f"inside out (volume {mesh.volume_mm3:.3g} mm3)"
    pinched = _pinched_vertices(surface)
    if pinched:
        return f"not a 2-manifold, surfaces touch in {pinched} single vertices"
    degenerate = int((mesh.areas_mm2 <= DEGENERATE_MM2).sum())
    return f"{degenerate} degenerate faces" if degenerate else ""


def check_self_intersection(mesh: SurfaceMesh) -> None:
    """Check that no edge of a closed mesh pierces a face that it does not touch (CRITERION_NOT_MET)."""
    places = self_intersections_mm(mesh)
    if len(places):
        where = ", ".join(f"{value:.2f}" for value in places[0])
        raise surface_refusal(
            f"it intersects itself near ({where}) mm", "Extract again at another resolution."
        )


def surface_refusal(what: str, remedy: str) -> CranktopoError:
    """Return the error of a surface that fails a check."""
    return CranktopoError(f"surface: {what}.", hint=remedy, code=ExitCode.CRITERION_NOT_MET)


def _pinched_vertices(surface: Any) -> int:
    """Return how many more fans of faces there are than vertices: 0 for a 2-manifold."""
    faces = np.asarray(surface.faces)
    links = []
    for end in (0, 1):
        shared = surface.face_adjacency_edges[:, end]
        # corner number = 3 * face + place of the shared vertex in it
        places = [np.argmax(faces[f] == shared[:, None], axis=1) for f in surface.face_adjacency.T]
        links.append(3 * surface.face_adjacency + np.stack(places, axis=1))
    fans = connected(faces.size, np.concatenate(links)).max() + 1
    return int(fans - len(np.unique(faces)))
