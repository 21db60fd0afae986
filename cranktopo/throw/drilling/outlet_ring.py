"""The ring that the rounding of a drilling's outlet takes out: a ball rolls around the edge inside.

Its section at every angle about the drilling has three corners: the edge of the sharp outlet, and where the
ball touches the drilling and the journal.
"""

from __future__ import annotations

from typing import cast

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.throw.drilling.bore import DrillOutlet, across


def ring_points(radius_mm: float, outlet: DrillOutlet, turn: Array, arc: Array, out: Array) -> Array:
    """Points (n, 3) of the ring, mm.

    Args:
        radius_mm: of the drilling.
        turn: angle about the drilling, rad.
        arc: 0 where the ball touches the drilling, 1 where it touches the journal.
        out: 0 on the edge of the sharp outlet, 1 on the rounding.
    """
    one, other = across(np.array(outlet.outward))
    spoke = np.cos(turn)[:, None] * one + np.sin(turn)[:, None] * other
    edge = _at(outlet, radius_mm * spoke, outlet.surface_mm)
    wide, deep = radius_mm + outlet.rounding_mm, outlet.surface_mm - outlet.rounding_mm
    ball = _at(outlet, wide * spoke, deep)
    normal = ball - np.array([0.0, outlet.y_mm, 0.0])
    normal[:, 2] = 0.0
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    rounding = ball + outlet.rounding_mm * _between(-spoke, normal, arc)
    straight = edge + out[:, None] * (rounding - edge)
    return (1 - arc)[:, None] * straight + arc[:, None] * _around(outlet.y_mm, edge, rounding, out)


def _at(outlet: DrillOutlet, offsets_mm: Array, radius_mm: float) -> Array:
    """Points of lines beside the axis on a cylinder about the journal."""
    heights = outlet.height_mm(offsets_mm, radius_mm)
    return cast(Array, np.array(outlet.point_mm) + offsets_mm + heights[:, None] * np.array(outlet.outward))


def _between(first: Array, second: Array, share: Array) -> Array:
    """Unit vectors on the arc from one to another."""
    angle = np.arccos(np.clip((first * second).sum(axis=1), -1, 1))
    one, other = (np.sin(part * angle) / np.sin(angle) for part in (1 - share, share))
    return cast(Array, one[:, None] * first + other[:, None] * second)


def _around(y_mm: float, first: Array, second: Array, share: Array) -> Array:
    """Points between two others, on the helix about the journal's axis that joins them."""
    ends = [_cylindrical(y_mm, points) for points in (first, second)]
    turn = (ends[1][1] - ends[0][1] + np.pi) % (2 * np.pi) - np.pi
    radius = ends[0][0] + share * (ends[1][0] - ends[0][0])
    angle = ends[0][1] + share * turn
    z = first[:, 2] + share * (second[:, 2] - first[:, 2])
    return np.stack([radius * np.sin(angle), y_mm + radius * np.cos(angle), z], axis=1)


def _cylindrical(y_mm: float, points: Array) -> tuple[Array, Array]:
    x, y = points[:, 0], points[:, 1] - y_mm
    return np.hypot(x, y), np.arctan2(x, y)
