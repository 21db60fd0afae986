"""Point membership of plane shapes: web outlines, journals, pockets and the design envelope.

Each shape is a function of coordinate arrays x, y (mm) that returns a boolean array.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from cranktopo.errors import CranktopoError
from cranktopo.scene.geometry import Envelope, Web
from cranktopo.scene.schema import Scene

Coordinates = NDArray[np.float64]
Shape = Callable[[Coordinates, Coordinates], NDArray[np.bool_]]


def disc(radius_mm: float, y_mm: float = 0.0, x_mm: float = 0.0) -> Shape:
    """Disc of a radius around (x_mm, y_mm)."""
    return lambda x, y: (x - x_mm) ** 2 + (y - y_mm) ** 2 <= radius_mm**2


def web_outline(web: Web, throw_radius_mm: float) -> Shape:
    """Outline of the web without bores and pockets.

    Args:
        web: the web table of the scene.
        throw_radius_mm: distance of the crankpin axis from the crank axis, mm.
    """
    if web.outline == "obround":
        return _hull_of_discs(web.width_mm / 2, web.width_mm / 2, throw_radius_mm)
    if web.outline == "tapered":
        return _hull_of_discs(web.main_radius_mm, web.pin_radius_mm, throw_radius_mm)
    if web.outline == "rectangle":
        half = web.width_mm / 2, throw_radius_mm / 2 + web.overhang_mm
        return _rounded_rectangle(half, throw_radius_mm / 2, web.corner_radius_mm)
    if web.outline == "ellipse":
        a, b = web.semi_axis_lateral_mm, web.semi_axis_throw_mm
        return lambda x, y: (x / a) ** 2 + ((y - throw_radius_mm / 2) / b) ** 2 <= 1.0
    return _profile(web.stations_mm, web.half_widths_mm)


def envelope_outline(envelope: Envelope) -> Shape:
    """Outline of the design envelope, which is extruded along the crank axis."""
    if envelope.shape == "box":
        half, low, high = envelope.half_width_mm, envelope.y_min_mm, envelope.y_max_mm
        return lambda x, y: (np.abs(x) <= half) & (y >= low) & (y <= high)
    if envelope.shape == "cylinder":
        return disc(envelope.radius_mm)
    if envelope.shape == "outline":
        return _polygon(np.array(envelope.points_mm))
    raise CranktopoError(
        f"envelope.shape = '{envelope.shape}': not extruded, so it has no outline.",
        hint="Use box, cylinder or outline.",
    )


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
    raise CranktopoError(f"envelope.shape = '{envelope.shape}': not extruded.")


def web_bounds_mm(scene: Scene) -> tuple[float, float, float, float]:
    """Range that holds the web outline: (x_min, x_max, y_min, y_max), mm."""
    web, r = scene.web, scene.throw.radius_mm
    if web.outline == "obround":
        h = web.width_mm / 2
        return -h, h, -h, r + h
    if web.outline == "tapered":
        h = max(web.main_radius_mm, web.pin_radius_mm)
        return -h, h, -web.main_radius_mm, r + web.pin_radius_mm
    if web.outline == "rectangle":
        return -web.width_mm / 2, web.width_mm / 2, -web.overhang_mm, r + web.overhang_mm
    if web.outline == "ellipse":
        a, b = web.semi_axis_lateral_mm, web.semi_axis_throw_mm
        return -a, a, r / 2 - b, r / 2 + b
    h = 1.05 * max(web.half_widths_mm)
    return -h, h, web.stations_mm[0], web.stations_mm[-1]


def _hull_of_discs(main_radius: float, pin_radius: float, distance: float) -> Shape:
    """Convex hull of a disc at the origin and one at (0, distance)."""
    sine = (main_radius - pin_radius) / distance
    if abs(sine) >= 1.0:  # one disc holds the other
        return disc(main_radius) if sine > 0 else disc(pin_radius, distance)
    cosine = np.sqrt(1 - sine**2)

    def inside(x: Coordinates, y: Coordinates) -> NDArray[np.bool_]:
        # The disc nearest to a point is found by projecting onto the axis along the tangent's normal.
        t = np.clip((y - np.abs(x) * sine / cosine) / distance, 0.0, 1.0)
        radius = main_radius + t * (pin_radius - main_radius)
        return np.asarray(x**2 + (y - t * distance) ** 2 <= radius**2)

    return inside


def _rounded_rectangle(half: tuple[float, float], centre_y: float, corner: float) -> Shape:
    def inside(x: Coordinates, y: Coordinates) -> NDArray[np.bool_]:
        dx = np.abs(x) - (half[0] - corner)
        dy = np.abs(y - centre_y) - (half[1] - corner)
        outside = np.hypot(np.maximum(dx, 0), np.maximum(dy, 0))
        return (np.abs(x) <= half[0]) & (np.abs(y - centre_y) <= half[1]) & (outside <= max(corner, 1e-12))

    return inside


def _profile(stations: tuple[float, ...], half_widths: tuple[float, ...]) -> Shape:
    from scipy.interpolate import PchipInterpolator

    curve = PchipInterpolator(stations, half_widths, extrapolate=False)

    def inside(x: Coordinates, y: Coordinates) -> NDArray[np.bool_]:
        width = np.nan_to_num(curve(y), nan=-1.0)
        return np.asarray(np.abs(x) <= width)

    return inside


def _polygon(points: Coordinates) -> Shape:
    """Even-odd rule: a point is inside if a ray along +x crosses the boundary an odd number of times."""

    def inside(x: Coordinates, y: Coordinates) -> NDArray[np.bool_]:
        result = np.zeros(np.broadcast_shapes(np.shape(x), np.shape(y)), bool)
        for (x1, y1), (x2, y2) in zip(points, np.roll(points, -1, axis=0), strict=True):
            if y1 == y2:
                continue
            crosses = (y1 <= y) != (y2 <= y)
            result ^= crosses & (x < x1 + (y - y1) * (x2 - x1) / (y2 - y1))
        return result

    return inside
