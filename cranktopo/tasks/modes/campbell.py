"""Modes over speed: followed from rest by their shapes, and where orders of the forces meet them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array, Complex, Index
from cranktopo.base.frames import about_z_deg
from cranktopo.base.units import angular_speed_rad_s
from cranktopo.numerics.turning_body import FreeModes, TurningBody, whirling_modes

_BASIS = 4
"""Modes at rest that span the motion over speed, over those that are followed."""
_NEAR = 1e-3
"""Weight of equal frequencies beside equal shapes where modes are followed."""


@dataclass(frozen=True)
class OverSpeed:
    """Modes over speed.

    Attributes:
        frequency_Hz: in the frame that turns with the shaft, (modes, speeds).
        whirl: 1 in the sense of rotation, -1 against it, (modes, speeds).
    """

    frequency_Hz: Array
    whirl: Array


def over_speed(body: TurningBody, rest: FreeModes, count: int, speeds_rpm: Sequence[float]) -> OverSpeed:
    """Return the first modes of a shaft over speeds, rising, in the order that they have at rest."""
    basis = rest.shape[:, : rest.rigid + _BASIS * count]
    small = body.over(basis)
    shapes = np.eye(basis.shape[1], dtype=complex)[:, rest.rigid : rest.rigid + count]
    at = rest.frequency_Hz[rest.rigid : rest.rigid + count]
    found, whirl = [], []
    for rpm in speeds_rpm:
        modes = whirling_modes(small, about_z_deg(angular_speed_rad_s(rpm)))
        chosen = _followed(shapes, at, modes.shape, modes.frequency_Hz)
        shapes, at = modes.shape[:, chosen], modes.frequency_Hz[chosen]
        found.append(at)
        whirl.append(about_z_deg(1.0) * modes.whirl[chosen])
    return OverSpeed(np.stack(found, axis=1), np.stack(whirl, axis=1))


def _followed(shapes: Complex, at: Array, others: Complex, frequencies: Array) -> Index:
    """Return which of other modes go on from some, by shape and, where that is even, by frequency."""
    from scipy.optimize import linear_sum_assignment

    alike = np.abs(shapes.conj().T @ others) ** 2
    away = np.abs(frequencies / at[:, None] - 1)
    rows, columns = linear_sum_assignment(_NEAR * np.minimum(away, 1.0) - alike)
    return np.asarray(columns[np.argsort(rows)])


def crossings(speeds_rpm: Array, frequency_Hz: Array, orders: Array) -> list[tuple[float, float]]:
    """Return speed and order of each crossing of orders with a mode over speed, the slowest first."""
    found = []
    for order in orders:
        above = frequency_Hz - order * speeds_rpm / 60
        for index in np.flatnonzero(above[:-1] * above[1:] <= 0):
            step = above[index] / (above[index] - above[index + 1]) if above[index] else 0.0
            speed = speeds_rpm[index] + step * (speeds_rpm[index + 1] - speeds_rpm[index])
            found.append((float(speed), float(order)))
    return sorted(set(found))
