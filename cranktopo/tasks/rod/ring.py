"""A bored eye as a closed curved beam of variable section: what radial loads make of its diameters.

Half of it is looked at, from the crown, where the eye is free, to the middle of the shank; both ends neither
turn nor leave the axis. The redundant moment and force follow from least energy with bending, stretch, their
coupling and shear, by Winkler and Bach.

Source: S. Timoshenko, Strength of Materials, on deflections of curved bars (their strain energy).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cranktopo.base.arrays import Array

_SHEAR = 1.2
"""Shear factor of rectangles."""


@dataclass(frozen=True)
class Forces:
    """Forces in the sections of half a ring, (angles,).

    Attributes:
        normal_N: positive is tension.
        moment_Nmm: positive lessens the curvature.
    """

    normal_N: Array
    shear_N: Array
    moment_Nmm: Array

    def plus(self, share: float, other: Forces) -> Forces:
        """Return these forces with a share of others."""
        return Forces(
            self.normal_N + share * other.normal_N,
            self.shear_N + share * other.shear_N,
            self.moment_Nmm + share * other.moment_Nmm,
        )


@dataclass(frozen=True)
class Ring:
    """Half a ring, its sections radial: arrays over the angle from the crown, 0 to pi.

    Attributes:
        middle_mm, neutral_mm: radii of the centroids and of the neutral fibres.
    """

    angle_rad: Array
    area_mm2: Array
    middle_mm: Array
    neutral_mm: Array
    E_MPa: float
    poisson: float

    def opened_mm(self, across_N: Array, along_N: Array) -> tuple[float, float]:
        """Return the changes of diameter across and along, under radial loads.

        Args:
            across_N, along_N: what half of the loads between crown and each angle adds up to, outward and
                toward the crown.
        """
        found = self._carried(across_N, along_N)
        at_side = (self.angle_rad >= np.pi / 2).astype(float)
        at_crown = np.ones_like(self.angle_rad)
        side = self._energy(found, self._sections(at_side, 0 * at_crown))
        return 2 * side, self._energy(found, self._sections(0 * at_crown, at_crown))

    def _carried(self, across_N: Array, along_N: Array) -> Forces:
        """Forces with the moment and force at the crown that leave both ends where they are."""
        loaded, redundant = self._sections(across_N, along_N), self._redundant
        matrix = [[self._energy(a, b) for b in redundant] for a in redundant]
        values = np.linalg.solve(matrix, [-self._energy(one, loaded) for one in redundant])
        for value, one in zip(values, redundant, strict=True):
            loaded = loaded.plus(float(value), one)
        return loaded

    @property
    def _redundant(self) -> tuple[Forces, ...]:
        """Forces of a thrust and of a moment at the crown."""
        none = np.zeros_like(self.angle_rad)
        thrust = self._sections(none - 1.0, none).plus(-self.middle_mm[0], self._turned)
        return thrust, self._turned

    @cached_property
    def _turned(self) -> Forces:
        """Forces of a moment of 1 N mm at the crown."""
        none = np.zeros_like(self.angle_rad)
        return Forces(none, none, none + 1.0)

    def _sections(self, across_N: Array, along_N: Array) -> Forces:
        """Forces in sections that resultants through the centre of the ring make."""
        sine, cosine = np.sin(self.angle_rad), np.cos(self.angle_rad)
        normal = along_N * sine - across_N * cosine
        return Forces(normal, -across_N * sine - along_N * cosine, normal * self.middle_mm)

    def _energy(self, one: Forces, other: Forces) -> float:
        """Work of forces on what others deform, mm per newton."""
        bent = one.moment_Nmm * other.moment_Nmm / (self.middle_mm - self.neutral_mm)
        coupled = one.moment_Nmm * other.normal_N + one.normal_N * other.moment_Nmm
        sheared = 2 * (1 + self.poisson) * _SHEAR * one.shear_N * other.shear_N
        stretched = one.normal_N * other.normal_N + sheared
        each = (bent - coupled + stretched * self.middle_mm) / (self.E_MPa * self.area_mm2)
        return float(np.trapezoid(each, self.angle_rad))


@dataclass(frozen=True)
class ClosedRing(Ring):
    """A whole ring whose sides differ: arrays over the angle from where it is held, around to there again.

    Angles are those from the crown; of a ring that its shank holds they go from -pi to pi.
    """

    def changes_mm(self, across_N: Array, along_N: Array, towards_rad: Array) -> Array:
        """Return the changes of diameters in directions from the crown, under radial loads.

        Args:
            across_N, along_N: what the loads between where the ring is held and each angle add up to, outward
                on the side of positive angles and toward the crown.
        """
        found = self._carried(across_N, along_N)
        return np.array([self._energy(found, self._pair(float(angle))) for angle in towards_rad])

    def _pair(self, towards_rad: float) -> Forces:
        """Forces that 1 N outward at both ends of a diameter adds up to."""
        start, step = self.angle_rad[0], self.angle_rad[1] - self.angle_rad[0]
        ends = [start + (towards_rad + turn - start) % (2 * np.pi) for turn in (0.0, np.pi)]
        passed = [np.clip((self.angle_rad - end) / step + 0.5, 0.0, 1.0) for end in ends]
        across, along = (
            sum(step * part(end) for step, end in zip(passed, ends, strict=True)) for part in (np.sin, np.cos)
        )
        return self._sections(np.asarray(across), np.asarray(along))

    @property
    def _redundant(self) -> tuple[Forces, ...]:
        """Forces across and along and a moment where the ring is held."""
        none = np.zeros_like(self.angle_rad)
        return self._sections(none + 1.0, none), self._sections(none, none + 1.0), self._turned
