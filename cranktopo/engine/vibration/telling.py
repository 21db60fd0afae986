"""Critical speeds that are worth a line: those whose order is felt beside all others."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.engine.vibration.steady import TELLING_SHARE, CriticalSpeed, Vibration
from cranktopo.numerics.disk_chain import DampedMode

WEAK = 0.05
"""Share of the cylinders that help each other below which a critical speed is only named."""


def order_torque_Nm(response: Vibration, found: CriticalSpeed, rise: float) -> Array:
    """Return the torque amplitude of a critical speed's order alone, by section, N m.

    The largest from the critical speed to the share `rise` above it: the varying inertia moves the peak.
    """
    near = is_near(response, found, rise)
    place = int(np.argmin(np.abs(response.orders - found.order)))
    return np.asarray(np.abs(response.torque_Nm[near, place]).max(axis=0))


def is_near(response: Vibration, found: CriticalSpeed, rise: float) -> Array:
    """Tell of every solved speed whether it belongs to a critical speed."""
    low, high = found.speed_rpm, found.speed_rpm * (1 + rise)
    return np.asarray((response.speeds_rpm >= low) & (response.speeds_rpm <= high))


def telling(critical: Sequence[CriticalSpeed], response: Vibration, rise: float) -> tuple[CriticalSpeed, ...]:
    """Return the critical speeds whose order alone has a hundredth of a section's largest torque amplitude.

    That amplitude is of the sum of all orders, at any speed of the range. Where cylinders cancel each other
    the torque says nothing of one that misfires: those are kept.
    """
    least = TELLING_SHARE * response.torque_amplitude_Nm.max(axis=0)
    return tuple(
        found
        for found in critical
        if found.share < WEAK or bool((order_torque_Nm(response, found, rise) >= least).any())
    )


def left_out(
    told: Sequence[CriticalSpeed], modes: Sequence[DampedMode], response: Vibration
) -> tuple[int, ...]:
    """Return how many crossings of the solved orders in the range are not told, of every mode."""
    low, high = response.speeds_rpm[[0, -1]]
    met = [60.0 * mode.frequency_Hz / response.orders for mode in modes]
    return tuple(
        int(((speeds >= low) & (speeds <= high)).sum()) - sum(one.mode == number for one in told)
        for number, speeds in enumerate(met, start=1)
    )
