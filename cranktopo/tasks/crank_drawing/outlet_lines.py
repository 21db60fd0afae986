"""Rims of the rounded outlets of oil drillings on the journals of a crank.

A rounding runs smoothly into the journal, so that no sharp edge of the body shows where it ends, and from
aside its outline is the near half of the outlet alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.frames import about_z_deg
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.tasks.crank_drawing.crank_shape import PlacedThrow
from cranktopo.throw.drilling.outlet import ring_points
from cranktopo.throw.drilling.table import drill_bores

_AROUND = 72
_SLACK_MM = 1e-6


def outlet_rims(throws: Sequence[PlacedThrow], z_mm: tuple[float, float]) -> list[Array]:
    """Return lines (n, 3) where the roundings of the outlets of all throws meet the journals, mm.

    They are closed, but for one that an end of the crank cuts.
    """
    rims = [
        _turned(rim, angle, throw.z_mm)
        for throw in throws
        for angle, own in zip(throw.half_angles_deg, _rims(throw.scene), strict=True)
        for rim in own
    ]
    (start, end), wide = z_mm, np.full(2, np.inf)
    for low, high in ((-np.inf, start - _SLACK_MM), (end + _SLACK_MM, np.inf)):
        rims = outside_of(rims, np.array([*-wide, low]), np.array([*wide, high]))
    return rims


def _rims(scene: Scene) -> Iterator[list[Array]]:
    """Yield the rims of both halves of a throw in its own frame, a split pin's as if it were straight."""
    turn = np.linspace(0.0, 2 * np.pi, _AROUND + 1)
    end = np.ones(len(turn))
    for far, half in enumerate(halves(scene)):
        found = []
        for bore in drill_bores(half):
            for own in bore.outlets:
                if own.rounding_mm:
                    outlet = own.in_second_half(scene.pitch_mm) if far else own
                    found.append(ring_points(bore.radius_mm, outlet, turn, end, end))
        yield found


def _turned(points_mm: Array, angle_deg: float, z_mm: float) -> Array:
    """Return points of a throw at their angle and place along the crank."""
    turn = np.radians(about_z_deg(angle_deg))
    x, y, z = points_mm.T
    cos, sin = np.cos(turn), np.sin(turn)
    return np.column_stack([cos * x - sin * y, sin * x + cos * y, z + z_mm])


def outside_of(lines: Sequence[Array], low_mm: Array, high_mm: Array) -> list[Array]:
    """Return the parts of lines (n, 3) outside of a box, in the same order along them."""
    found = []
    for line in lines:
        kept = np.logical_not(((line > low_mm) & (line < high_mm)).all(axis=1))
        steps = np.flatnonzero(kept[1:] != kept[:-1]) + 1
        runs = zip(np.split(line, steps), np.split(kept, steps), strict=True)
        found += [run for run, keep in runs if keep[0] and len(run) > 1]
    return found
