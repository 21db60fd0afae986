"""Torque of all cylinders by firing order, and what each throw of the shaft passes on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.engine.kinematics import phase_shift


@dataclass(frozen=True)
class ShaftTorque:
    """Torque along the shaft over the cycle.

    Attributes:
        angle_deg: crank angles from firing top dead centre of the cylinder that fires first, deg.
        passed_on_Nm: torque behind each throw, from the free end to the takeoff, (throws, angles), N m.
        ahead_Nm: of a vibrating shaft, torque ahead of each throw; else what is passed on less its own.
    """

    angle_deg: Array
    passed_on_Nm: Array
    ahead_Nm: Array | None = None

    @property
    def engine_Nm(self) -> Array:
        """Torque at the takeoff, N m."""
        return np.asarray(self.passed_on_Nm[-1])


def shaft_torque(
    angle_deg: Array, rod_torque_Nm: Array, firing_deg: tuple[float, ...], throws: int, cycle_deg: float
) -> ShaftTorque:
    """Torque behind each throw of a shaft; where a pin has two rods, they are a bank apart.

    Args:
        angle_deg: evenly spaced crank angles over one cycle, deg.
        rod_torque_Nm: torque of one rod at these angles after its own firing dead centre, N m.
        firing_deg: crank angle at which each cylinder fires, deg; cylinder 1, at the free end, first.
    """
    single = np.array([phase_shift(rod_torque_Nm, angle_deg, fires, cycle_deg) for fires in firing_deg])
    by_throw = single.reshape(-1, throws, len(angle_deg)).sum(axis=0)
    return ShaftTorque(angle_deg, np.cumsum(by_throw, axis=0))
