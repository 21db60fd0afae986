"""Mobility of a journal in a bearing of finite width: which way and how fast a load moves it.

The map is that of Reynolds' equation (`reynolds.py`), computed once by
`python -m cranktopo.numerics.bearing_film.mobility` for several widths; between them the logarithm of the
force is interpolated over that of the width.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

from cranktopo.base.arrays import Array, Complex, Index
from cranktopo.numerics.bearing_film.reynolds import film

MAP_FILE = Path(__file__).with_name("mobility_map.npz")
WIDTHS = (0.06, 0.09, 0.13, 0.18, 0.25, 0.35, 0.5, 0.7, 1.0, 1.4)
"""Width over diameter."""
THICKNESS = np.geomspace(1.0, 2e-4, 26)
"""1 - eccentricity."""
DIRECTIONS = np.radians([*range(0, 60, 10), *np.arange(60, 125, 2.5), *range(125, 181, 11)])
"""Of the velocity, from the eccentricity; close where a thin film stops to carry."""
_FINE, _ANGLES = 240, 480


@dataclass(frozen=True)
class Mobility:
    """Maps of some widths, over (film thickness, angle of the load).

    Rows are even in the logarithm of 1 - eccentricity; the angle of the load from the eccentricity grows with
    the square of the column, since a load near the thinnest film moves the journal any way.

    Attributes:
        motion: direction of the velocity in rad, and logarithm of the force of a unit velocity, one row for
            each entry of each map, (entries, 2).
        peak: largest pressure over the load per projected area, (entries, 1).
        map: of each bearing, the number of its map.
    """

    motion: Array
    peak: Array
    map: Index

    def velocity(self, eccentricity: Complex, load: Complex, bearing: Index | int = 0) -> Complex:
        """Return the velocity of each journal's centre over the load's magnitude, dimensionless."""
        turn = np.angle(eccentricity)
        angle = np.angle(load * np.exp(-1j * turn))
        found = self._mixed(self.motion, np.abs(eccentricity), np.abs(angle), bearing)
        return np.asarray(np.exp(1j * (turn + np.copysign(found[..., 0], angle)) - found[..., 1]))

    def peak_pressure(self, eccentricity: Complex, load: Complex, bearing: Index | int = 0) -> Array:
        """Return the largest pressure over the load per projected area."""
        angle = np.angle(load * np.exp(-1j * np.angle(eccentricity)))
        found = self._mixed(self.peak, np.abs(eccentricity), np.abs(angle), bearing)
        return np.asarray(found[..., 0])

    def _mixed(self, table: Array, eccentricity: Array, angle: Array, bearing: Index | int) -> Array:
        """Return entries between those of the table, (..., values)."""
        thickness = np.minimum(np.maximum(1 - eccentricity, THICKNESS[-1]), 1.0)
        row = np.log(thickness) * ((_FINE - 1) / _LOG_THINNEST)
        column = np.sqrt(angle * ((_ANGLES - 1) ** 2 / math.pi))
        i = np.minimum(row.astype(np.intp), _FINE - 2)
        j = np.minimum(column.astype(np.intp), _ANGLES - 2)
        entry = (self.map[bearing] * _FINE + i) * _ANGLES + j
        down, right = (row - i)[..., None], (column - j)[..., None]
        upper = table[entry] + right * (table[entry + 1] - table[entry])
        entry = entry + _ANGLES
        lower = table[entry] + right * (table[entry + 1] - table[entry])
        return np.asarray(upper + down * (lower - upper))


_LOG_THINNEST = math.log(float(THICKNESS[-1]))


def mobility(widths_over_diameter: Sequence[float]) -> Mobility:
    """Return the maps of bearings of these widths."""
    own, which = np.unique(widths_over_diameter, return_inverse=True)
    found = np.stack([_map(float(width)) for width in own])
    table = found.transpose(0, 2, 3, 1).reshape(-1, 3)
    return Mobility(np.ascontiguousarray(table[:, :2]), np.ascontiguousarray(table[:, 2:]), which)


@lru_cache(maxsize=8)
def _map(width_over_diameter: float) -> Array:
    """Return the map of a width: direction, logarithm of the force, largest pressure; (3, rows, columns).

    A film narrower than those of the table is one of parabolas along the width, whose force goes with its
    square (Ocvirk); a wider one than the table's is taken as the widest.
    """
    with np.load(MAP_FILE) as file:
        table = file["table"].astype(np.float64)
    at = np.log(np.clip(width_over_diameter, WIDTHS[0], WIDTHS[-1]))
    own = CubicSpline(np.log(WIDTHS), table)(at)  # (thickness, direction, 3)
    rows = np.linspace(0.0, 1.0, _FINE) * _LOG_THINNEST
    own[..., 1] += 2 * min(np.log(width_over_diameter / WIDTHS[0]), 0.0)
    angle, log_force, peak = np.moveaxis(CubicSpline(-np.log(THICKNESS), own)(-rows), -1, 0)
    angles = np.pi * np.linspace(0.0, 1.0, _ANGLES) ** 2
    found = np.empty((3, _FINE, _ANGLES))
    for row in range(_FINE):
        rising = np.maximum.accumulate(angle[row])
        way = np.interp(angles, rising, DIRECTIONS)
        found[:, row] = way, np.interp(way, DIRECTIONS, log_force[row]), np.interp(way, DIRECTIONS, peak[row])
    return found


def entry(width_over_diameter: float, thickness: float) -> Array:
    """Angle of the load, logarithm of the force, and peak pressure for every direction, shape (n, 3)."""
    here = film(1 - thickness, width_over_diameter)
    forces = [here.force(float(direction)) for direction in DIRECTIONS]
    size = np.array([math.hypot(force.radial, force.across) for force in forces])
    angle = np.array([math.atan2(force.across, force.radial) for force in forces])
    angle[[0, -1]] = 0.0, math.pi  # by symmetry
    return np.stack([angle, np.log(size), 4 * np.array([f.peak for f in forces]) / size], axis=1)


if __name__ == "__main__":
    full = np.array([[entry(width, thickness) for thickness in THICKNESS] for width in WIDTHS])
    np.savez_compressed(MAP_FILE, table=full.astype(np.float32))
