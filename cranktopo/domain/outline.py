"""Point membership of plane shapes: web outlines, journals, pockets and the design envelope.

Each shape is a function of coordinate arrays x, y (mm) that returns a boolean array.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cranktopo.domain.stl_envelope import bounds_mm, section
from cranktopo.scene.bevel import throw_range_mm
from cranktopo.scene.geometry import Envelope, Web
from cranktopo.scene.outline import half_width_mm, largest_half_width_mm, y_range_mm
from cranktopo.scene.schema import Scene

Coordinates = NDArray[np.float64]
Shape = Callable[[Coordinates, Coordinates], NDArray[np.bool_]]


def disc(radius_mm: float, y_mm: float = 0.0, x_mm: float = 0.0) -> Shape:
    """Disc around a point.

    Args:
        radius_mm: its radius.
        y_mm, x_mm: its centre.
    """
    return lambda x, y: (x - x_mm) ** 2 + (y - y_mm) ** 2 <= radius_mm**2


def web_outline(web: Web, throw_radius_mm: float, height_mm: float) -> Shape:
    """Outline of the web at a height, less its end bevels; bores and pockets are not cut out.

    Args:
        web: the web table of the scene.
        throw_radius_mm: distance of the crankpin axis from the crank axis, mm.
        height_mm: height over the journal face of the web.
    """
    low, high = throw_range_mm(web, throw_radius_mm, height_mm)

    def inside(x: Coordinates, y: Coordinates) -> NDArray[np.bool_]:
        return np.asarray((np.abs(x) < half_width_mm(web, throw_radius_mm, y)) & (y >= low) & (y <= high))

    return inside


def envelope_outline(envelope: Envelope, z_mm: float) -> Shape:
    """Cross-section of the design envelope at a height; only a mesh changes along the crank axis.

    Args:
        envelope: the scene's envelope.
        z_mm: height along the crank axis.
    """
    if envelope.shape == "box":
        half, low, high = envelope.half_width_mm, envelope.y_min_mm, envelope.y_max_mm
        return lambda x, y: (np.abs(x) <= half) & (y >= low) & (y <= high)
    if envelope.shape == "cylinder":
        return disc(envelope.radius_mm)
    if envelope.shape == "outline":
        return polygons([np.array(envelope.points_mm)])
    return polygons(section(Path(envelope.file), z_mm, envelope.symmetric))


def envelope_bounds_mm(envelope: Envelope) -> tuple[float, float, float, float]:
    """Smallest |x| range and y range that hold the envelope: (x_min, x_max, y_min, y_max), mm."""
    if envelope.shape == "box":
        return -envelope.half_width_mm, envelope.half_width_mm, envelope.y_min_mm, envelope.y_max_mm
    if envelope.shape == "cylinder":
        r = envelope.radius_mm
        return -r, r, -r, r
    if envelope.shape == "outline":
        points = np.array(envelope.points_mm)
        (x0, y0), (x1, y1) = points.min(axis=0), points.max(axis=0)
        return float(x0), float(x1), float(y0), float(y1)
    return bounds_mm(Path(envelope.file), envelope.symmetric)


def web_bounds_mm(scene: Scene) -> tuple[float, float, float, float]:
    """Range that holds the web outline: (x_min, x_max, y_min, y_max), mm."""
    half = largest_half_width_mm(scene.web)
    return -half, half, *y_range_mm(scene.web, scene.throw.radius_mm)


def polygons(contours: list[Coordinates]) -> Shape:
    """Inside of closed contours (n, 2) by the even-odd rule, for x of shape (n, 1) and y of shape (1, m)."""
    starts = np.concatenate([np.zeros((0, 2)), *contours])
    ends = np.concatenate([np.zeros((0, 2)), *(np.roll(contour, -1, axis=0) for contour in contours)])

    def inside(x: Coordinates, y: Coordinates) -> NDArray[np.bool_]:
        rows = [_crossings(starts, ends, value) for value in y.ravel()]
        # A point is inside if the ray towards -x crosses the boundary an odd number of times.
        counts = [np.searchsorted(row, x.ravel()) for row in rows]
        return np.asarray(np.stack(counts, axis=1) % 2 == 1)

    return inside


def _crossings(starts: Coordinates, ends: Coordinates, y: float) -> Coordinates:
    """Sorted x where the edges cross a line of constant y."""
    (x1, y1), (x2, y2) = starts.T, ends.T
    crosses = (y1 <= y) != (y2 <= y)
    x1, y1, x2, y2 = (values[crosses] for values in (x1, y1, x2, y2))
    return np.sort(x1 + (y - y1) * (x2 - x1) / (y2 - y1))
