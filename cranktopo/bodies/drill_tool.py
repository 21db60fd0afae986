"""An oil drilling in triangles, with the roundings of its outlets."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from manifold3d import Manifold, Mesh64

from cranktopo.base.arrays import Array
from cranktopo.throw.drilling.bore import DrillBore
from cranktopo.throw.drilling.outlet import across, ring_points

_CHORD_ERROR_MM = 0.002
_ARC_POINTS, _BEYOND_OUTLET = 9, 0.25
"""Points on the rounding of an outlet; how far the tool reaches beyond it, over the drilling's radius."""


def segments(radius_mm: float) -> int:
    """Return the number of sides, a multiple of 8, whose chord error r (1 - cos(pi / n)) is allowed."""
    sides = math.pi / math.acos(max(0.0, 1 - _CHORD_ERROR_MM / radius_mm))
    return max(32, 8 * math.ceil(sides / 8))


def drill_tool(bore: DrillBore, sides: int | None = None) -> Manifold:
    """Return a drilling with its roundings as one body, rings of points from end to end.

    One body, because a bore and a rounding made apart would touch in a circle: their chords cross there and
    leave folded slivers all around it.
    """
    around = sides or max(segments(bore.radius_mm + outlet.rounding_mm) for outlet in bore.outlets)
    turns = np.linspace(0, 2 * np.pi, around, endpoint=False)
    (first, low), (second, high) = (_drill_end(bore, end, turns) for end in (0, 1))
    rings = np.concatenate([first[::-1], second])
    here = np.arange(len(rings) * around).reshape(-1, around)
    after, tips = np.roll(here, -1, axis=1), np.full((2, around), [[here.size], [here.size + 1]])
    faces = [
        (here[:-1], after[:-1], after[1:]),
        (here[:-1], after[1:], here[1:]),
        (tips[0], after[0], here[0]),
        (tips[1], here[-1], after[-1]),
    ]
    corners = np.concatenate([np.stack(three, axis=-1).reshape(-1, 3) for three in faces])
    points = np.concatenate([rings.reshape(-1, 3), [low, high]])
    return Manifold(Mesh64(points, corners.astype(np.uint64)))


def _drill_end(bore: DrillBore, end: Literal[0, 1], turns: Array) -> tuple[Array, Array]:
    """Return rings (n, turns, 3) of an end, from the bore outwards, and the tip in front of the last."""
    outlet, radius = bore.outlets[end], bore.radius_mm
    if not outlet.rounding_mm:
        one, other = across(bore.direction)
        tip = np.array(bore.outlets[0].point_mm) + bore.extent_mm[end] * bore.direction
        spokes = np.cos(turns)[:, None] * one + np.sin(turns)[:, None] * other
        return (tip + radius * spokes)[None], tip
    seen = turns if end else np.pi - turns  # an outlet counts the angle as seen from outside
    turn, arc = (v.ravel() for v in np.meshgrid(seen, np.linspace(0, 1, _ARC_POINTS)))
    rings = ring_points(radius, outlet, turn, arc, np.ones(turn.size)).reshape(_ARC_POINTS, -1, 3)
    beyond, outward = _BEYOND_OUTLET * radius, np.array(outlet.outward)
    upright = (rings[-1] - [0.0, outlet.y_mm, 0.0]) * [1.0, 1.0, 0.0]
    last = rings[-1] + beyond / outlet.surface_mm * upright
    foot = np.array(outlet.point_mm)
    return np.concatenate([rings, last[None]]), foot + (((last - foot) @ outward).max() + beyond) * outward
