"""Outlines of webs seen along the crank: of a body, of a scene, and how far they are apart."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.spans import polygon_area
from cranktopo.bodies.drill_tool import segments
from cranktopo.design.schema import Scene
from cranktopo.throw.web import web_bodies

if TYPE_CHECKING:
    from manifold3d import CrossSection, Manifold

_STEP_MM = 0.25
"""Way between points of an edge whose distance from another is looked at."""
_CORNERS = 6
"""Corners nearest to a point, at whose sides the nearest place of an edge is looked for."""


def drawn_outline(scene: Scene) -> CrossSection:
    """Return the outline of a scene's web and counterweight along the crank."""
    from manifold3d import CrossSection, FillRule

    polygons = [body.polygon_mm(_sides) for body in web_bodies(scene) if body.adds]
    return CrossSection(polygons, FillRule.NonZero)


def _sides(radius_mm: float) -> int:
    return 4 * segments(radius_mm)


def silhouette(solid: Manifold, low: float, high: float) -> CrossSection:
    """Return the outline of what of a solid lies between two heights."""
    between = solid.trim_by_plane((0.0, 0.0, 1.0), low).trim_by_plane((0.0, 0.0, -1.0), -high)
    return between.project()


def apart_mm(one: CrossSection, other: CrossSection) -> tuple[float, float]:
    """Return the largest distance of the outer edges of two sections, and the root of their mean square."""
    first, second = (_dense(section) for section in (one, other))
    distances = np.concatenate([_from(first, second), _from(second, first)])
    return float(distances.max()), float(np.sqrt((distances**2).mean()))


def outer_edge(section: CrossSection) -> Array:
    """Return the corners (n, 2) of the largest contour of a section."""
    return max((np.asarray(c) for c in section.to_polygons()), key=lambda c: abs(polygon_area(c)))


def _dense(section: CrossSection) -> Array:
    points = outer_edge(section)
    after = np.roll(points, -1, axis=0)
    counts = np.maximum(1, np.ceil(np.linalg.norm(after - points, axis=1) / _STEP_MM)).astype(int)
    return np.concatenate(
        [a + (b - a) * np.arange(n)[:, None] / n for a, b, n in zip(points, after, counts, strict=True)]
    )


def _from(points: Array, edge: Array) -> Array:
    """Distances of points from a closed polygon of short sides.

    Of the sides at several corners: where the silhouette of triangles folds by a hair, those of the nearest
    corner need not be the nearest.
    """
    from scipy.spatial import cKDTree

    _, near = cKDTree(edge).query(points, k=min(_CORNERS, len(edge)))
    found = np.full(len(points), np.inf)
    for corner in near.T:
        for step in (-1, 0):
            a, b = edge[(corner + step) % len(edge)], edge[(corner + step + 1) % len(edge)]
            along = b - a
            share = np.clip(((points - a) * along).sum(1) / np.maximum((along**2).sum(1), 1e-30), 0, 1)
            found = np.minimum(found, np.linalg.norm(a + share[:, None] * along - points, axis=1))
    return found


def half_width_mm(points: Array, y: float) -> float:
    """Return the largest |x| of a polygon at a height."""
    a, b = points, np.roll(points, -1, axis=0)
    crossing = (np.minimum(a[:, 1], b[:, 1]) <= y) & (np.maximum(a[:, 1], b[:, 1]) >= y)
    a, b = a[crossing], b[crossing]
    if not len(a):
        return 0.0
    rise = np.where(a[:, 1] == b[:, 1], 1.0, b[:, 1] - a[:, 1])
    return float(np.abs(a[:, 0] + (b[:, 0] - a[:, 0]) * (y - a[:, 1]) / rise).max())
