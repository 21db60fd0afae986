"""Radius of the rounded outlets of a drilling, from corners of triangles on the roundings.

A rounding is what a ball leaves that rolls around the edge inside, so corners on it are one radius away from
the way of that ball's centre.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.throw.drilling.bore import DrillBore
from cranktopo.throw.drilling.outlet import DrillOutlet, ball_way_mm

_STEPS = 720
"""Points on the way of the ball's centre around an outlet."""
_TRIED, _FINER, _NEAR = 48, 9, 0.05
"""Radii that are tried, then about the one found, and the share by which those may differ from it."""
_LARGEST = 1.0
"""Radius of an outlet over the diameter of its drilling."""
_SLIM = 0.03
"""Least distance of a corner from drilling and journal over the other: beside their edges it tells little."""
_FEWEST = 6
"""Corners that lie on a rounding at least."""
_ALIKE = 0.01
"""Share in which radii from corners of one rounding agree."""


def outlet_radius_mm(bore: DrillBore, corners_mm: Array) -> float:
    """Return the radius of both roundings of a drilling that corners (n, 3) lie on; 0 where they are sharp.

    CAD systems approximate a rounding (the OpenCASCADE kernel within 0.4 % of its radius): three figures.
    """
    most = _LARGEST * 2 * bore.radius_mm
    tried = most * np.geomspace(0.02, 1.0, _TRIED)
    found = _agreed(_radii(bore, corners_mm, tried))
    for _ in range(2 if found else 0):
        near = found * (1 + _NEAR * np.linspace(-1, 1, _FINER))
        found = _agreed(_radii(bore, corners_mm, near)) or found
    return float(f"{found:.3g}")


def _agreed(radii: Array) -> float:
    """Return the median of the radii (n,) that most others agree with; 0 where few do."""
    if len(radii) < _FEWEST:
        return 0.0
    order = np.sort(radii)
    counts = np.searchsorted(order, order * (1 + _ALIKE)) - np.arange(len(order))
    first, count = int(counts.argmax()), int(counts.max())
    return float(np.median(order[first : first + count])) if count >= _FEWEST else 0.0


def _radii(bore: DrillBore, corners_mm: Array, tried_mm: Array) -> Array:
    """Return the radii of the balls that touch corners in their way around the outlets."""
    found = [_of_outlet(bore, outlet, corners_mm, tried_mm) for outlet in bore.outlets if not outlet.in_bore]
    return np.concatenate([np.empty(0), *found])


def _of_outlet(bore: DrillBore, outlet: DrillOutlet, corners_mm: Array, tried_mm: Array) -> Array:
    from scipy.spatial import cKDTree

    points = _beside(bore, outlet, corners_mm, float(tried_mm[-1]))
    if not len(points):
        return np.empty(0)
    turn = np.linspace(0, 2 * np.pi, _STEPS, endpoint=False)
    beyond = []
    for radius in tried_mm:
        way = ball_way_mm(bore.radius_mm, replace(outlet, rounding_mm=float(radius)), turn)
        _, near = cKDTree(way).query(points)
        a, b, c = (way[(near + step) % _STEPS] for step in (-1, 0, 1))
        beyond.append(np.minimum(_from_side(points, a, b), _from_side(points, b, c)) - radius)
    return _last_roots(tried_mm, np.array(beyond))


def _from_side(points: Array, a: Array, b: Array) -> Array:
    along = b - a
    share = np.clip(((points - a) * along).sum(1) / (along**2).sum(1), 0, 1)
    return np.asarray(np.linalg.norm(a + share[:, None] * along - points, axis=1))


def _last_roots(places: Array, values: Array) -> Array:
    """Return where columns of values (k, n) last rise through 0, by straight lines; some do not."""
    rises = (values[:-1] < 0) & (values[1:] >= 0)
    own = np.flatnonzero(rises.any(axis=0))
    last = len(places) - 2 - rises[::-1, own].argmax(axis=0)
    low, high = values[last, own], values[last + 1, own]
    return np.asarray(places[last] + (places[last + 1] - places[last]) * low / (low - high))


def _beside(bore: DrillBore, outlet: DrillOutlet, corners_mm: Array, most_mm: float) -> Array:
    """Return the corners between drilling and surface that may lie on a rounding of an outlet."""
    away = corners_mm - np.array(outlet.point_mm)
    along = away @ np.array(outlet.outward)
    aside = np.linalg.norm(away - along[:, None] * np.array(outlet.outward), axis=1) - bore.radius_mm
    deep = outlet.surface_mm - np.hypot(corners_mm[:, 0], corners_mm[:, 1] - outlet.y_mm)
    own = (np.minimum(aside, deep) > _SLIM * np.maximum(aside, deep)) & (np.maximum(aside, deep) < most_mm)
    reach = np.abs(along) < outlet.surface_mm
    return corners_mm[own & reach]
