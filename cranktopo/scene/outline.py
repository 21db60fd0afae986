"""Web outlines as half-widths along the throw: every outline is symmetric in x and single-valued in y."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cranktopo.errors import invalid
from cranktopo.scene import profile
from cranktopo.scene.geometry import ObroundWeb, ProfileWeb, RectangleWeb, TaperedWeb, Web
from cranktopo.scene.profile import flank_half_width_mm, profile_flank

Array = NDArray[np.float64]


def half_width_mm(web: Web, throw_radius_mm: float, y_mm: Array) -> Array:
    """Half-width of the web outline, without bores and pockets, at positions along the throw.

    Args:
        web: the web table of the scene.
        throw_radius_mm: distance of the pin axis from the crank axis, mm.
        y_mm: positions along the throw direction, mm.

    Returns:
        Half-widths, mm; 0 beyond the ends of the web.
    """
    if web.outline == "obround":
        return _hull(web.width_mm / 2, web.width_mm / 2, throw_radius_mm, y_mm)
    if web.outline == "tapered":
        return _hull(web.main_radius_mm, web.pin_radius_mm, throw_radius_mm, y_mm)
    if web.outline == "ellipse":
        inside = 1.0 - ((y_mm - throw_radius_mm / 2) / web.semi_axis_throw_mm) ** 2
        return web.semi_axis_lateral_mm * _root(inside)
    if web.outline == "rectangle":
        return _rectangle(web, throw_radius_mm, y_mm)
    return flank_half_width_mm(profile_flank(web), y_mm)


def y_range_mm(web: Web, throw_radius_mm: float) -> tuple[float, float]:
    """Range of the web outline along the throw direction, mm.

    Args:
        web: the web table of the scene.
        throw_radius_mm: distance of the pin axis from the crank axis.
    """
    if web.outline == "obround":
        return -web.width_mm / 2, throw_radius_mm + web.width_mm / 2
    if web.outline == "tapered":
        # One circle may hold the other.
        low = min(-web.main_radius_mm, throw_radius_mm - web.pin_radius_mm)
        return low, max(web.main_radius_mm, throw_radius_mm + web.pin_radius_mm)
    if web.outline == "ellipse":
        return throw_radius_mm / 2 - web.semi_axis_throw_mm, throw_radius_mm / 2 + web.semi_axis_throw_mm
    if web.outline == "rectangle":
        return -web.overhang_mm, throw_radius_mm + web.overhang_mm
    return web.stations_mm[0], web.stations_mm[-1]


def largest_half_width_mm(web: Web) -> float:
    """Half of the largest width of the web outline, mm; side pockets are measured from it."""
    if web.outline == "obround" or web.outline == "rectangle":
        return web.width_mm / 2
    if web.outline == "tapered":
        return max(web.main_radius_mm, web.pin_radius_mm)
    if web.outline == "ellipse":
        return web.semi_axis_lateral_mm
    return profile.largest_half_width_mm(profile_flank(web))


def outline_kinks_mm(web: Web, radius_mm: float) -> list[float]:
    """Positions along the throw where the half-width is not smooth, ends included, mm, sorted.

    Args:
        web: the web table of the scene.
        radius_mm: throw radius.
    """
    kinks = list(y_range_mm(web, radius_mm))
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

    Args:
        web: the web table of the scene.
        radius_mm: throw radius.

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


def _root(value: Array) -> Array:
    return np.sqrt(np.maximum(value, 0.0))


def _hull(main_radius: float, pin_radius: float, distance: float, y: Array) -> Array:
    """Convex hull of a circle at the origin and one at (0, distance)."""
    circles = np.maximum(_root(main_radius**2 - y**2), _root(pin_radius**2 - (y - distance) ** 2))
    sine = (main_radius - pin_radius) / distance
    if abs(sine) >= 1.0:
        return circles
    # The common tangent touches both circles where their radii make this angle with the lateral axis.
    cosine = math.sqrt(1.0 - sine**2)
    tangent = (main_radius - y * sine) / cosine
    between = (y >= main_radius * sine) & (y <= distance + pin_radius * sine)
    return np.where(between, tangent, circles)


def _rectangle(web: RectangleWeb, distance: float, y: Array) -> Array:
    corner = web.corner_radius_mm
    beyond = np.abs(y - distance / 2) - (distance / 2 + web.overhang_mm - corner)
    width = web.width_mm / 2 - corner + _root(corner**2 - np.maximum(beyond, 0.0) ** 2)
    return np.where(beyond <= corner, width, 0.0)
