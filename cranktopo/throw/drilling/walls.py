"""Walls between oil drillings and what a fit may move: outline, pockets, bevels; kept where <= 0, mm."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.throw.drilling.bore import DrillBore
from cranktopo.throw.drilling.table import drill_bores
from cranktopo.throw.fitted import Rule, Surroundings, wall_rule

_POINTS = 33
"""Points along the axis of a drilling."""
_NamedBox = tuple[str, Array]


def drilling_rules(around: Surroundings, boxes: Sequence[_NamedBox]) -> Iterator[Rule]:
    """One rule for each drilling and each of outline, bevels and boxes; none where there is no drilling.

    Args:
        boxes: titles of pockets and the corners of the box around each, (2, 3), z from the journal face.
    """
    start, end = around.scene.web_z_mm
    least = around.limits.min_wall_mm
    for bore in drill_bores(around.scene):
        axis = _axis(bore, start, end)
        needed = bore.radius_mm + around.wall_mm
        own = f"{bore.key} and the"
        if not len(axis):
            continue
        yield wall_rule(f"between {own} outline", least), needed - _in_outline_mm(axis, around.points_mm)
        for arc in around.arcs:
            depth = axis[:, 2] if arc.outward > 0 else end - start - axis[:, 2]
            away = arc.distance_mm(depth, arc.outward * axis[:, 1]).min()
            yield wall_rule(f"between {own} {arc.title}", least), needed - away
        both = np.concatenate([axis, axis * [-1.0, 1.0, 1.0]])  # a feature has its mirror image
        for title, (low, high) in boxes:
            yield wall_rule(f"between {own} {title}", least), needed - _off_box_mm(both, low, high)


def _axis(bore: DrillBore, start: float, end: float) -> Array:
    """Points of the axis within the web, (n, 3), z from its journal face."""
    (_, _, foot), (_, _, rise) = bore.outlets[0].point_mm, bore.direction
    ends = np.sort((np.array([start, end]) - foot) / rise) if rise else np.zeros(0)
    low, high = bore.extent_mm
    if not len(ends) or ends[0] > high or ends[1] < low:
        return np.zeros((0, 3))
    places = np.linspace(max(ends[0], low), min(ends[1], high), _POINTS)[:, None]
    points = np.array(bore.outlets[0].point_mm) + places * bore.direction
    return np.asarray(points - [0.0, 0.0, start])


def _in_outline_mm(axis: Array, points: Array) -> float:
    """Least distance of the axis inside the outline, negative where it is outside."""
    x, y = np.abs(axis[:, 0]), axis[:, 1]
    away = np.hypot(x[:, None] - points[:, 0], y[:, None] - points[:, 1]).min(axis=1)
    half = np.interp(y, points[:, 1], points[:, 0], left=0.0, right=0.0)
    return float(np.where(x < half, away, -away).min())


def _off_box_mm(points: Array, low: Array, high: Array) -> float:
    """Least distance of points from a box, negative inside."""
    off = np.maximum(low - points, points - high)
    outside = np.sqrt((np.maximum(off, 0.0) ** 2).sum(axis=1))
    return float(np.where(outside > 0, outside, off.max(axis=1)).min())
