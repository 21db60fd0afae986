"""Element sizes at oil drillings: as fine as their radius along them, finer at their outlets."""

from __future__ import annotations

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.throw.drilling.bore import DrillBore, DrillOutlet

_GROWTH = 0.5
"""Growth of the element size per mm of distance."""
_ALONG, _OUTLET = 1.0, 0.5
"""Element size along a drilling and at its outlets over its radius."""


def size_terms(bore: DrillBore, size: float, fraction: float | None, height: str) -> list[str]:
    """Return formulae of the largest element size at a drilling in x, y and z, mm.

    Args:
        size: general element size.
        fraction: element size on a rounded outlet over its radius; None for what stiffness needs.
        height: formula of the height in the half throw.
    """
    at = [_at(outlet, bore, size, fraction, height) for outlet in bore.outlets]
    return [_along(bore, size, height), *at]


def size_mm(bore: DrillBore, size: float, points_mm: Array) -> Array:
    """Return the largest element size at points (n, 3) of the half throw, mm, for stiffness."""
    start, direction = np.array(bore.outlets[0].point_mm), bore.direction
    away = np.linalg.norm(np.cross(points_mm - start, direction), axis=1)
    result = _fine(size, _ALONG * bore.radius_mm) + _GROWTH * away
    for outlet in bore.outlets:
        away = np.linalg.norm(points_mm - np.array(outlet.point_mm), axis=1) - _rim(bore, outlet)
        beside = _fine(size, _OUTLET * bore.radius_mm) + _GROWTH * np.maximum(away, 0.0)
        result = np.minimum(result, beside)
    return np.asarray(result)


def _fine(size: float, wanted: float) -> float:
    return min(size, wanted)


def _rim(bore: DrillBore, outlet: DrillOutlet) -> float:
    """Radius around an outlet that is meshed finely."""
    return bore.radius_mm + outlet.rounding_mm


def _along(bore: DrillBore, size: float, height: str) -> str:
    (px, py, pz), (dx, dy, dz) = bore.outlets[0].point_mm, bore.direction.tolist()
    x, y, z = f"(x-({px!r}))", f"(y-({py!r}))", f"({height}-({pz!r}))"
    cross = f"({y}*({dz!r})-{z}*({dy!r}))^2+({z}*({dx!r})-{x}*({dz!r}))^2+({x}*({dy!r})-{y}*({dx!r}))^2"
    return f"{_fine(size, _ALONG * bore.radius_mm)!r}+{_GROWTH!r}*Sqrt({cross})"


def _at(outlet: DrillOutlet, bore: DrillBore, size: float, fraction: float | None, z: str) -> str:
    px, py, pz = outlet.point_mm
    notch = outlet.rounding_mm or bore.radius_mm
    finest = _fine(size, _OUTLET * bore.radius_mm if fraction is None else fraction * notch)
    distance = f"Sqrt((x-({px!r}))^2+(y-({py!r}))^2+({z}-({pz!r}))^2)"
    return f"{finest!r}+{_GROWTH!r}*Max(0,{distance}-{_rim(bore, outlet)!r})"
