"""The outline of a web as the schema means it: half-width along the throw, range, tangents, corners."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cranktopo.errors import invalid
from cranktopo.scene.geometry import (
    EllipseWeb,
    ObroundWeb,
    ProfileWeb,
    RectangleWeb,
    TaperedWeb,
    Web,
)

Array = NDArray[np.float64]


def outline_range_mm(web: Web, radius_mm: float) -> tuple[float, float]:
    """Extent (y_min, y_max) of the outline along the throw, mm.

    Args:
        web: the web.
        radius_mm: throw radius.
    """
    if isinstance(web, ObroundWeb):
        return -web.width_mm / 2, radius_mm + web.width_mm / 2
    if isinstance(web, RectangleWeb):
        return -web.overhang_mm, radius_mm + web.overhang_mm
    if isinstance(web, EllipseWeb):
        return radius_mm / 2 - web.semi_axis_throw_mm, radius_mm / 2 + web.semi_axis_throw_mm
    if isinstance(web, TaperedWeb):
        return -web.main_radius_mm, radius_mm + web.pin_radius_mm
    return web.stations_mm[0], web.stations_mm[-1]


def outline_half_width_mm(web: Web, radius_mm: float, y_mm: Array) -> Array:
    """Half-width of the outline at positions along the throw, mm; 0 outside its range.

    Args:
        web: the web; a profile is joined by monotone cubics (Fritsch and Carlson, 1980).
        radius_mm: throw radius.
        y_mm: positions, any shape.
    """
    y = np.asarray(y_mm, dtype=np.float64)
    low, high = outline_range_mm(web, radius_mm)
    inside = (y >= low) & (y <= high)
    return np.where(inside, _half_width(web, radius_mm, np.clip(y, low, high)), 0.0)


def outline_width_mm(web: Web) -> float:
    """Greatest width of the outline across the throw, mm."""
    if isinstance(web, ObroundWeb | RectangleWeb):
        return web.width_mm
    if isinstance(web, EllipseWeb):
        return 2 * web.semi_axis_lateral_mm
    if isinstance(web, TaperedWeb):
        return 2 * max(web.main_radius_mm, web.pin_radius_mm)
    return 2 * max(web.half_widths_mm)


def outline_kinks_mm(web: Web, radius_mm: float) -> list[float]:
    """Positions along the throw where the half-width is not smooth, ends included, mm, sorted."""
    kinks = list(outline_range_mm(web, radius_mm))
    if isinstance(web, ObroundWeb):
        kinks += [0.0, radius_mm]
    elif isinstance(web, RectangleWeb):
        kinks += [kinks[0] + web.corner_radius_mm, kinks[1] - web.corner_radius_mm]
    elif isinstance(web, TaperedWeb):
        sine = tangent_sine(web, radius_mm)
        kinks += [web.main_radius_mm * sine, radius_mm + web.pin_radius_mm * sine]
    elif isinstance(web, ProfileWeb):
        kinks += list(web.stations_mm)
    return sorted(set(kinks))


def tangent_sine(web: TaperedWeb, radius_mm: float) -> float:
    """Sine of the slope of a tapered web's straight flank: (main - pin radius) / throw radius.

    Raises:
        CranktopoError: one circle contains the other, so there is no flank.
    """
    difference = web.main_radius_mm - web.pin_radius_mm
    if abs(difference) >= radius_mm:
        raise invalid(
            "web.main_radius_mm",
            web.main_radius_mm,
            f"must differ from web.pin_radius_mm = {web.pin_radius_mm:g} mm by less than the throw radius "
            f"{radius_mm:g} mm",
        )
    return difference / radius_mm


def profile_slopes(web: ProfileWeb) -> Array:
    """Slope of the half-width at each station of a profile (dimensionless), shape (stations,)."""
    from scipy.interpolate import PchipInterpolator

    curve = PchipInterpolator(web.stations_mm, web.half_widths_mm)
    return np.asarray(curve.derivative()(web.stations_mm), dtype=np.float64)


def _half_width(web: Web, radius: float, y: Array) -> Array:
    if isinstance(web, ObroundWeb):
        beyond = y - np.clip(y, 0.0, radius)
        return _root((web.width_mm / 2) ** 2 - beyond**2)
    if isinstance(web, RectangleWeb):
        return _rectangle(web, radius, y)
    if isinstance(web, EllipseWeb):
        return web.semi_axis_lateral_mm * _root(1 - ((y - radius / 2) / web.semi_axis_throw_mm) ** 2)
    if isinstance(web, TaperedWeb):
        return _tapered(web, radius, y)
    from scipy.interpolate import PchipInterpolator

    return np.asarray(PchipInterpolator(web.stations_mm, web.half_widths_mm)(y), dtype=np.float64)


def _rectangle(web: RectangleWeb, radius: float, y: Array) -> Array:
    corner = web.corner_radius_mm
    low, high = outline_range_mm(web, radius)
    into = np.maximum(np.maximum(low + corner - y, y - (high - corner)), 0.0)
    return web.width_mm / 2 - corner + _root(corner**2 - into**2)


def _tapered(web: TaperedWeb, radius: float, y: Array) -> Array:
    sine = tangent_sine(web, radius)
    cosine = math.sqrt(1 - sine**2)
    flank = (web.main_radius_mm - y * sine) / cosine
    main = _root(web.main_radius_mm**2 - y**2)
    pin = _root(web.pin_radius_mm**2 - (y - radius) ** 2)
    start, end = web.main_radius_mm * sine, radius + web.pin_radius_mm * sine
    return np.where(y < start, main, np.where(y > end, pin, flank))


def _root(square: Array) -> Array:
    return np.sqrt(np.maximum(square, 0.0))
