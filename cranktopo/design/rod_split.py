"""The split of the big end, square or oblique: a frame turned about the axis of the big end.

Frame: u along the split, v along the bolts from the cap to the rod. A square split has x and y of the rod; an
oblique one is turned such that u falls toward positive x.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.rod import Rod


def turns(rod: Rod) -> tuple[float, float]:
    """Return cosine and sine of the angle of the split; 1 and 0 where it is square."""
    angle = math.radians(rod.split_angle_deg)
    return math.cos(angle), math.sin(angle)


def in_rod(rod: Rod, u: Array, v: Array) -> tuple[Array, Array]:
    """Return x and y of points in the frame of the split."""
    cosine, sine = turns(rod)
    return u * cosine + v * sine, v * cosine - u * sine


def in_split(rod: Rod, x: Array, y: Array) -> tuple[Array, Array]:
    """Return u and v of points in the frame of the rod."""
    cosine, sine = turns(rod)
    return x * cosine - y * sine, x * sine + y * cosine


def boss_range_mm(rod: Rod, y: Array, side: int) -> tuple[Array, Array]:
    """Return where bosses begin and end across the rod on one side of its axis, that of x with this sign."""
    half, (cosine, sine) = rod.boss_width_mm / 2, turns(rod)
    if not rod.split_angle_deg:
        inside = (y >= -rod.boss_below_mm) & (y <= rod.boss_above_mm)
        return 0 * y, half * inside.astype(float)
    low = np.maximum((y * sine - half) / cosine, (-rod.boss_below_mm - y * cosine) / sine)
    high = np.minimum((y * sine + half) / cosine, (rod.boss_above_mm - y * cosine) / sine)
    low, high = (low, high) if side > 0 else (-high, -low)
    start = np.maximum(low, 0.0)
    return start, np.maximum(high, start)


def boss_marks_mm(rod: Rod) -> list[float]:
    """Return places along the rod at which its bosses begin, end, or leave the rings of the big end."""
    heights = (-rod.boss_below_mm, rod.boss_above_mm)
    if not rod.split_angle_deg:
        return list(heights)
    half = rod.boss_width_mm / 2
    corners = [(side * half, v) for side in (-1, 1) for v in heights]
    for radius in (rod.big_end_diameter_mm / 2, rod.big_end_bore_mm / 2):
        corners += [
            (side * math.sqrt(radius**2 - v**2), v) for side in (-1, 1) for v in heights if abs(v) < radius
        ]
        if half < radius:
            corners += [
                (side * half, v * math.sqrt(radius**2 - half**2)) for side in (-1, 1) for v in (-1, 1)
            ]
    u, v = np.array(corners).T
    return [float(y) for y in in_rod(rod, u, v)[1]]


def big_end_range_mm(rod: Rod) -> tuple[float, float]:
    """Return where the big end without its cap begins and ends across the rod."""
    cosine, sine = turns(rod)
    ring, half = rod.big_end_diameter_mm / 2, rod.boss_width_mm / 2
    return -max(ring, half) * cosine, max(ring, half * cosine + rod.boss_above_mm * sine)


def oblique_shortfalls(rod: Rod, length_mm: float, neck_deg: float) -> Iterator[tuple[str, float, str]]:
    """Yield keys of what an oblique split asks of the rod: a length or angle that is missing, its share, why.

    Args:
        neck_deg: angle above the square split of where the shank leaves the big end.
    """
    if not rod.split_angle_deg:
        return
    cosine, sine = turns(rod)
    half, above = rod.boss_width_mm / 2, rod.boss_above_mm
    angle, limit = rod.split_angle_deg, math.floor(10 * neck_deg) / 10
    why = f"must be at most {limit:g} deg: beyond, the split cuts the shank"
    yield "split_angle_deg", angle / neck_deg - 1, why
    top, free = half * sine + above * cosine, length_mm - rod.small_end_diameter_mm / 2
    yield "boss_width_mm", top / free - 1, f"{half * 2:g} mm reach the small end at this rod.split_angle_deg"
    if rod.oil_hole_mm:
        inner = (rod.bolt_distance_mm - rod.bolt_hole_mm) / 2 * cosine - above * sine
        hole = rod.oil_hole_mm / 2
        why = f"a hole of a bolt meets the oil hole at this rod.split_angle_deg, {angle:g} deg"
        yield "bolt_distance_mm", (hole - inner) / rod.bolt_distance_mm, why
