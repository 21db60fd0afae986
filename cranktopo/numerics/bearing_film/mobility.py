"""Mobility of a journal in a bearing of finite width: which way and how fast a load moves it.

The map is that of Reynolds' equation (`reynolds.py`), computed once by
`python -m cranktopo.numerics.bearing_film.mobility` for several widths; between them the logarithm of the
force is interpolated over that of the width.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

from cranktopo.base.arrays import Array
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
    """The map of one width, over (film thickness, angle of the load).

    Rows are even in the logarithm of 1 - eccentricity; the angle of the load from the eccentricity grows with
    the square of the column, since a load near the thinnest film moves the journal any way.

    Attributes:
        direction: of the velocity, rad.
        log_force: logarithm of the force of a unit velocity.
        peak: largest pressure over the load per projected area.
    """

    direction: Array
    log_force: Array
    peak: Array

    def velocity(self, eccentricity: complex, load: complex) -> complex:
        """Return the velocity of the journal's centre over the load's magnitude, dimensionless."""
        turn, angle = self._from_eccentricity(eccentricity, load)
        cell = self._cell(abs(eccentricity), abs(angle))
        way = math.copysign(_mixed(self.direction, cell), angle)
        return cmath.rect(math.exp(-_mixed(self.log_force, cell)), turn + way)

    def peak_pressure(self, eccentricity: complex, load: complex) -> float:
        """Return the largest pressure over the load per projected area."""
        _, angle = self._from_eccentricity(eccentricity, load)
        return _mixed(self.peak, self._cell(abs(eccentricity), abs(angle)))

    @staticmethod
    def _from_eccentricity(eccentricity: complex, load: complex) -> tuple[float, float]:
        turn = cmath.phase(eccentricity)
        return turn, math.remainder(cmath.phase(load) - turn, 2 * math.pi)

    @staticmethod
    def _cell(eccentricity: float, angle: float) -> tuple[int, int, float, float]:
        thickness = max(1 - eccentricity, THICKNESS[-1])
        row = math.log(thickness) / _LOG_THINNEST * (_FINE - 1)
        column = math.sqrt(angle / math.pi) * (_ANGLES - 1)
        i, j = min(int(row), _FINE - 2), min(int(column), _ANGLES - 2)
        return i, j, row - i, column - j


_LOG_THINNEST = math.log(float(THICKNESS[-1]))


def _mixed(table: Array, cell: tuple[int, int, float, float]) -> float:
    i, j, down, right = cell
    (a, b), (c, d) = table[i, j : j + 2].tolist(), table[i + 1, j : j + 2].tolist()
    upper, lower = a + right * (b - a), c + right * (d - c)
    return float(upper + down * (lower - upper))


@lru_cache(maxsize=8)
def mobility(width_over_diameter: float) -> Mobility:
    """Return the map of a width.

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
    asked = np.pi * np.linspace(0.0, 1.0, _ANGLES) ** 2
    found = np.empty((3, _FINE, _ANGLES))
    for row in range(_FINE):
        rising = np.maximum.accumulate(angle[row])
        way = np.interp(asked, rising, DIRECTIONS)
        found[:, row] = way, np.interp(way, DIRECTIONS, log_force[row]), np.interp(way, DIRECTIONS, peak[row])
    return Mobility(*found)


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
