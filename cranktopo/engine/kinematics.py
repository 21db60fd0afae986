"""Exact kinematics of a central crank mechanism, and the textbook series beside it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, shared
from cranktopo.base.errors import invalid

Curve = TypeVar("Curve", Array, NDArray[np.complex128])
"""Values at evenly spaced crank angles of a cycle."""
_HARMONIC_POINTS = 4096


@dataclass(frozen=True)
class Motion:
    """Motion of the piston: distance from top dead centre, velocity over r w, acceleration over r w^2."""

    displacement_mm: Array
    velocity_ratio: Array
    acceleration_ratio: Array


@dataclass(frozen=True)
class ForceRatios:
    """Forces of the mechanism per unit of force along the cylinder axis; b is the angle of the rod to it.

    Attributes:
        side: force of the piston on the cylinder wall, tan b.
        rod: force along the rod, 1 / cos b.
        radial: force on the crankpin toward the crank axis, cos(a + b) / cos b.
        tangential: force on the crankpin in the direction of rotation, sin(a + b) / cos b.
    """

    side: Array
    rod: Array
    radial: Array
    tangential: Array


@dataclass(frozen=True)
class ExactMotion:
    """Motion of the piston in closed form at crank angles a from top dead centre; curves as of `Motion`.

    With lam = r/l and q = sqrt(1 - lam^2 sin^2 a):
    x = r + l - r cos a - l q, v = r w sin a (1 + lam cos a / q),
    acc = r w^2 (cos a + lam cos 2a / q + lam^3 sin^2 2a / (4 q^3)).
    Each is computed once it is asked for: the gas needs the first two, and thousands of times.
    """

    angle_rad: Array
    radius_mm: float
    rod_length_mm: float
    lam: float

    @cached_property
    def _sin(self) -> Array:
        return shared(np.sin(self.angle_rad))

    @cached_property
    def _cos(self) -> Array:
        return shared(np.cos(self.angle_rad))

    @cached_property
    def _q(self) -> Array:
        return shared(np.sqrt(1.0 - (self.lam * self._sin) ** 2))

    @cached_property
    def displacement_mm(self) -> Array:
        """Distance from top dead centre: both brackets of r (1 - cos a) + l (1 - q) free of cancellation."""
        near = 2.0 * self.radius_mm * np.sin(self.angle_rad / 2) ** 2
        return shared(near + self.rod_length_mm * (self.lam * self._sin) ** 2 / (1.0 + self._q))

    @cached_property
    def velocity_ratio(self) -> Array:
        """Velocity over r w."""
        return shared(self._sin * (1.0 + self.lam * self._cos / self._q))

    @cached_property
    def acceleration_ratio(self) -> Array:
        """Acceleration over r w^2."""
        twice, lam, q = 2 * self.angle_rad, self.lam, self._q
        return shared(self._cos + lam * np.cos(twice) / q + lam**3 * np.sin(twice) ** 2 / (4 * q**3))

    @cached_property
    def force_ratios(self) -> ForceRatios:
        """Split of a force along the cylinder axis at the rod and the crankpin."""
        rod_angle = np.arcsin(self.lam * self._sin)
        cos_b = np.cos(rod_angle)
        return ForceRatios(
            side=shared(np.tan(rod_angle)),
            rod=shared(1.0 / cos_b),
            radial=shared(np.cos(self.angle_rad + rod_angle) / cos_b),
            tangential=shared(np.sin(self.angle_rad + rod_angle) / cos_b),
        )


def exact_motion(angle_rad: Array, radius_mm: float, rod_length_mm: float) -> ExactMotion:
    """Return the piston's motion; raises CranktopoError where the rod is not longer than the throw."""
    lam = _crank_ratio(radius_mm, rod_length_mm)
    angle_rad = np.asarray(angle_rad, np.float64)
    return _motion_at(angle_rad.tobytes(), angle_rad.shape, radius_mm, rod_length_mm, lam)


@lru_cache(maxsize=32)
def _motion_at(
    angles: bytes, shape: tuple[int, ...], radius_mm: float, rod_length_mm: float, lam: float
) -> ExactMotion:
    """Return a motion that is computed once: a plan asks for that of one mechanism dozens of times."""
    return ExactMotion(np.frombuffer(angles).reshape(shape), radius_mm, rod_length_mm, lam)


def acceleration_harmonics(radius_mm: float, rod_length_mm: float, orders: Sequence[int]) -> Array:
    """Return Fourier coefficients of the exact acceleration over r w^2: acc = r w^2 sum of c_n cos(n a).

    The mean over evenly spaced angles is exact to rounding as soon as they resolve the last harmonic that
    counts: those of order n fall as exp(-n arcosh(l/r)).
    """
    angle = 2.0 * np.pi * np.arange(_HARMONIC_POINTS) / _HARMONIC_POINTS
    acceleration = exact_motion(angle, radius_mm, rod_length_mm).acceleration_ratio
    return np.array([2.0 * np.mean(acceleration * np.cos(order * angle)) for order in orders])


def phase_shift(curve: Curve, angle_deg: Array, by_deg: float, cycle_deg: float) -> Curve:
    """Return a curve over the cycle, later by a crank angle."""
    before, split = (angle_deg - by_deg) % cycle_deg, -round(by_deg / cycle_deg * len(angle_deg))
    if np.array_equal(before, _turned(angle_deg, split)):  # from point to point, as most engines fire
        return _turned(curve, split)
    return np.asarray(np.interp(before, angle_deg, curve, period=cycle_deg))


def _turned(curve: Curve, split: int) -> Curve:
    """Return a curve that begins at another of its points; `np.roll` takes four times as long."""
    return np.asarray(np.concatenate((curve[split:], curve[:split])))


def series_motion(angle_rad: Array, radius_mm: float, rod_length_mm: float) -> Motion:
    """Return the piston's motion by the textbook series to the first order of r/l."""
    lam = _crank_ratio(radius_mm, rod_length_mm)
    sin, cos = np.sin(angle_rad), np.cos(angle_rad)
    return Motion(
        radius_mm * (1.0 - cos + lam / 2 * sin**2),
        sin + lam / 2 * np.sin(2 * angle_rad),
        cos + lam * np.cos(2 * angle_rad),
    )


def force_ratios(angle_rad: Array, radius_mm: float, rod_length_mm: float) -> ForceRatios:
    """Return how a force along the cylinder axis splits at the rod and the crankpin."""
    return exact_motion(angle_rad, radius_mm, rod_length_mm).force_ratios


def _crank_ratio(radius_mm: float, rod_length_mm: float) -> float:
    if not 0 < radius_mm < rod_length_mm:
        raise invalid(
            "engine.rod_length_mm", rod_length_mm, f"must be longer than the throw radius {radius_mm:g} mm"
        )
    return radius_mm / rod_length_mm
