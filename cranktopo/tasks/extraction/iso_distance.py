"""Distances of an extracted surface from the iso-surface that it was made of."""

from __future__ import annotations

import numpy as np
from manifold3d import Manifold

from cranktopo.base.arrays import Array
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, solid_of
from cranktopo.tasks.extraction.cutter import Cutter
from cranktopo.tasks.extraction.isosurface import FineField, unsmoothed_solid

_FACETS_ALONG = 100
"""Facets that a surface's longest extent is cut into at least."""
_NEIGHBOURS = 24
_MOST_POINTS = 20000


def iso_surface_distances_mm(cutter: Cutter, field: FineField, iso: float, web: SurfaceMesh) -> Array:
    """Return the distances from an iso-surface, before any smoothing, to the surface of a web.

    Only its points inside the envelope and outside bores and journals count: elsewhere the exact solids make
    the surface.

    Returns:
        One distance per point, (n,), mm; at most 20 000 points, evenly chosen.
    """
    raw = unsmoothed_solid(field, iso)
    # Booleans keep the vertices they do not remove: those that are left bound the web.
    left = _vertices((raw ^ cutter.envelope) - cutter.stubs - cutter.bores)
    points = _common(_vertices(raw), left)
    points = points[:: max(1, len(points) // _MOST_POINTS)]
    return distances_mm(points, web)


def distances_mm(points_mm: Array, mesh: SurfaceMesh) -> Array:
    """Return the distance of points to a surface: to the nearest of the facets around, cut small before.

    Returns:
        (n,), mm; an upper bound, sharp where facets are regular.
    """
    import trimesh
    from scipy.spatial import cKDTree

    fine = solid_of(mesh).refine_to_length(mesh.extent_mm / _FACETS_ALONG).to_mesh64()
    corners = np.asarray(fine.vert_properties)[:, :3][np.asarray(fine.tri_verts).astype(np.int64)]
    count = min(_NEIGHBOURS, len(corners))
    _, near = cKDTree(corners.mean(axis=1)).query(points_mm, k=count)
    pairs = corners[near.reshape(-1)]
    targets = np.repeat(points_mm, count, axis=0)
    closest = trimesh.triangles.closest_point(pairs, targets)
    gaps = np.linalg.norm(closest - targets, axis=1).reshape(-1, count)
    return np.asarray(gaps.min(axis=1))


def _vertices(solid: Manifold) -> Array:
    return np.asarray(solid.to_mesh64().vert_properties)[:, :3]


def _common(points: Array, kept: Array) -> Array:
    """Return the points that are, bit for bit, among the kept ones."""
    rows = {row.tobytes() for row in np.ascontiguousarray(kept)}
    return points[[row.tobytes() in rows for row in np.ascontiguousarray(points)]]
