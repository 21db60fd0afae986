"""A round hole with a rounded floor as what it is: a plane, a torus and a cone about one axis."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.throw.primitives import Frustum

ROUND_MM = 1e-9
"""Length of a straight side below which corners make a circle."""


def is_round(frustum: Frustum) -> bool:
    """Tell whether the corners of floor and mouth leave no straight side."""
    rings = zip((frustum.floor, frustum.mouth), frustum.corner_radii, strict=True)
    return all(straight_sides_mm(np.array(ring), radius).max() < ROUND_MM for ring, radius in rings)


def add_round_hole(occ: Any, frustum: Frustum) -> int:
    """Add a round frustum whose floor meets the wall in a rounding, by turning its section."""
    floor, mouth = (np.mean(ring, axis=0) for ring in (frustum.floor, frustum.mouth))
    (low, high), rounding = frustum.corner_radii, frustum.floor_radius
    deep = float(np.linalg.norm(mouth - floor))
    up, out = (mouth - floor) / deep, np.array(frustum.floor[1]) - np.array(frustum.floor[0])
    out = out / np.linalg.norm(out)
    slope = math.atan2(high - low, deep)
    reach = rounding * math.tan((math.pi / 2 - slope) / 2)  # of the rounding, from the sharp edge
    wall = low + reach * math.sin(slope), reach * math.cos(slope)
    ring = (0.0, 0.0), (low - reach, 0.0), (low - reach, rounding), wall, (high, deep), (0.0, deep)
    points = [occ.addPoint(*(floor + radius * out + height * up)) for radius, height in ring]
    middle, edge, centre, foot, rim, top = points
    lines = [occ.addLine(*ends) for ends in ((middle, edge), (foot, rim), (rim, top), (top, middle))]
    curves = [lines[0], occ.addCircleArc(edge, centre, foot), *lines[1:]]
    section = 2, occ.addPlaneSurface([occ.addCurveLoop(curves)])
    found = occ.revolve([section], *floor, *up, 2 * math.pi)
    occ.remove([section], recursive=True)
    occ.remove([(0, centre)])
    ((_, tag),) = (pair for pair in found if pair[0] == 3)
    return int(tag)


def straight_sides_mm(ring: Array, radius: float) -> Array:
    """Return what round corners leave of the side behind each corner of a ring (n, 3), (n,)."""
    return np.asarray(np.abs(np.linalg.norm(np.roll(ring, -1, axis=0) - ring, axis=1) - 2 * radius))
