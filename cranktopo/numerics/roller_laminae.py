"""Radial roller bearing by laminae, its life and tilt: rollers of finite length under a radial force.

Source: ISO/TS 16281:2008, load distribution and basic reference rating life, for needles and cylindrical
rollers of steel on an inner ring that turns. Profile and stress at the edges are those of the standard.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import solver_error

_LINE_N_PER_MM = 35948.0
"""Force of a steel roller over its length^(8/9) and its approach^(10/9), N/mm2."""
_POWER = 10 / 9
_REDUCTION = 0.83
"""Factor that the rating of radial roller bearings holds for uneven contact (lambda nu)."""
_INNER, _OUTER = 4.0, 4.5
"""Exponents of the mean load of the ring that turns under the load, and of the other."""
_STEPS, _WITHIN = 60, 1e-9
"""Of Newton's method, and the part of the load that counts as none."""


@dataclass(frozen=True)
class RollerSet:
    """Rollers of a radial bearing.

    Attributes:
        clearance_mm: radial internal clearance, of the diameters.
        laminae: even number of slices of a roller.
    """

    count: int
    diameter_mm: float
    length_mm: float
    pitch_diameter_mm: float
    clearance_mm: float = 0.0
    laminae: int = 30

    @property
    def along_mm(self) -> Array:
        """Middles of the laminae along the roller, from its middle, (laminae,)."""
        return np.asarray((np.arange(self.laminae) + 0.5) / self.laminae - 0.5) * self.length_mm

    @property
    def lamina_stiffness(self) -> float:
        """Force of a lamina over its approach^(10/9), N and mm."""
        return _LINE_N_PER_MM * self.length_mm ** (8 / 9) / self.laminae

    @property
    def profile_mm(self) -> Array:
        """Depth of the surface of a roller below a cylinder, at the laminae, (laminae,)."""
        crowned = min(self.length_mm, 2.5 * self.diameter_mm)
        drop = 0.00035 if self.length_mm <= 2.5 * self.diameter_mm else 0.0005
        inside = 2 * np.abs(self.along_mm) - (self.length_mm - crowned)
        return -drop * self.diameter_mm * np.log(1 - (np.maximum(inside, 0.0) / crowned) ** 2)

    @property
    def edge_factor(self) -> Array:
        """Factor of the load of each lamina for the stress at the edges, (laminae,)."""
        number, last = np.arange(1, self.laminae + 1), self.laminae - 1
        return np.asarray(1 - 0.01 / np.log(1.985 * np.abs((2 * number - self.laminae - 1) / (2 * last))))

    @property
    def round_about(self) -> Array:
        """Directions of the rollers, (rollers, 2)."""
        turn = 2 * np.pi * np.arange(self.count) / self.count
        return np.stack([np.cos(turn), np.sin(turn)], axis=1)


def lamina_loads(rollers: RollerSet, load_N: Array, tilt: Array) -> Array:
    """Return the load of every lamina of every roller in states, N, (states, rollers, laminae).

    Args:
        load_N: force of the shaft on the bearing, (states, 2); none of them zero.
        tilt: how far the shaft leads off that bearing's axis per length, (states, 2).

    Raises:
        CranktopoError: a state without an answer.
    """
    about, along = rollers.round_about, rollers.along_mm
    stiffness = rollers.lamina_stiffness
    off = (tilt @ about.T)[..., None] * along - rollers.clearance_mm / 2 - 2 * rollers.profile_mm
    size = np.linalg.norm(load_N, axis=1)
    even = (5 * size / (rollers.count * stiffness * rollers.laminae)) ** (1 / _POWER)
    reach = even + rollers.clearance_mm / 2 + np.linalg.norm(tilt, axis=1) * rollers.length_mm / 2
    moved = load_N * (reach / size)[:, None]
    for _ in range(_STEPS):
        pressed = np.maximum((moved @ about.T)[..., None] + off, 0.0)
        force = stiffness * pressed**_POWER
        left = load_N - force.sum(axis=2) @ about
        if (np.linalg.norm(left, axis=1) <= _WITHIN * size).all():
            return np.asarray(force)
        slope = _POWER * stiffness * (pressed ** (_POWER - 1) * (pressed > 0)).sum(axis=2)
        matrix = np.einsum("sj,ja,jb->sab", slope, about, about)
        moved = moved + np.linalg.solve(matrix, left[..., None])[..., 0]
    raise solver_error(
        "roller bearing: the load of its rollers was not found.",
        "Check clearance, tilt and load of the bearing.",
    )


def tilt_stiffness_Nmm_per_rad(rollers: RollerSet, load_N: float) -> float:
    """Return the moment by which loaded rollers resist a small tilt of the shaft, over that tilt, N mm/rad.

    It is the mean of those of a tilt in the plane of the load and across it: a load that turns about the
    shaft meets either. It grows with the ninth root of the approach, so that the load hardly matters where
    rollers have neither profile nor play.

    Raises:
        CranktopoError: as of `lamina_loads`.
    """
    (force,) = lamina_loads(rollers, np.array([[load_N, 0.0]]), np.zeros((1, 2)))
    slope = _POWER * rollers.lamina_stiffness ** (1 / _POWER) * force ** (1 - 1 / _POWER)
    return float((slope * rollers.along_mm**2).sum() / 2)


def reference_life_turns(rollers: RollerSet, rating_N: float, load_N: Array, tilt: Array) -> Array:
    """Return the basic reference rating life under the load of each state alone, turns, (states,).

    Arguments and errors as of `lamina_loads`.
    """
    own = lamina_loads(rollers, load_N, tilt) * rollers.edge_factor
    used = np.zeros((len(own), rollers.laminae))
    for power, rated in zip((_INNER, _OUTER), _lamina_ratings_N(rollers, rating_N), strict=True):
        used += ((own**power).mean(axis=1) ** (1 / power) / rated) ** 4.5
    return np.asarray(1e6 * used.sum(axis=1) ** (-8 / 9))


def _lamina_ratings_N(rollers: RollerSet, rating_N: float) -> tuple[float, float]:
    """Return the load of a lamina at the inner and at the outer ring that is rated for a million turns."""
    gamma = rollers.diameter_mm / rollers.pitch_diameter_mm
    ratio = (1.038 * ((1 - gamma) / (1 + gamma)) ** (143 / 108)) ** 4.5
    even = rating_N / (_REDUCTION * rollers.count) * rollers.laminae ** (-7 / 9)
    inner = even / 0.378 * math.pow(1 + ratio, 2 / 9)
    return inner, even / 0.364 * math.pow(1 + 1 / ratio, 2 / 9)
