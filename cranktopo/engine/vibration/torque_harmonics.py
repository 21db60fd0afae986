"""Gas and inertia torque of every cylinder as orders of the crank's rotation."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.units import angular_speed_rad_s
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.forces import INERTIA_EFFECTS, throw_forces
from cranktopo.engine.gas import pressure_curve
from cranktopo.numerics.disk_chain import ComplexArray

_ANY_SPEED_RPM = 1000.0
"""Inertia torque goes with the square of the speed, whatever speed it is computed at."""


@dataclass(frozen=True)
class TorqueHarmonics:
    """Torque of the cylinders: at crank angle a it is the real part of the sum of amplitude exp(i order a).

    Attributes:
        orders: of the rotation, from 0 in steps of one over the turns of a cycle.
        gas_Nm: complex amplitudes of one cylinder, a from its own firing dead centre.
        inertia_Nm_s2: the same of its reciprocating mass, over the square of the angular speed in rad/s.
        firing_deg: crank angle at which each cylinder fires, cylinder 1 first.
    """

    orders: Array
    gas_Nm: ComplexArray
    inertia_Nm_s2: ComplexArray
    firing_deg: tuple[float, ...]
    throw_of: tuple[int, ...]

    def of_throws_Nm(self, speed_rpm: float) -> ComplexArray:
        """Complex amplitudes of the torque on every throw at a speed, one clock for all, (orders, throws)."""
        single = self.gas_Nm + angular_speed_rad_s(speed_rpm) ** 2 * self.inertia_Nm_s2
        return np.asarray(single[:, None] * self.shifts)

    def in_phase(self) -> NDArray[np.bool_]:
        """Of which orders the torques of all cylinders have the same phase: the major ones."""
        count = len(self.firing_deg)
        return np.asarray(np.abs(self.shifts.sum(axis=1)) > (1 - 1e-9) * count)

    @cached_property
    def shifts(self) -> ComplexArray:
        """Factor of each order for the times at which the cylinders of a throw fire, (orders, throws)."""
        single = np.exp(-1j * self.orders[:, None] * np.radians(self.firing_deg))
        throws = np.array(self.throw_of)
        return np.stack([single[:, throws == t].sum(axis=1) for t in range(max(throws) + 1)], axis=1)


def torque_harmonics(scene: Scene, enabled: frozenset[str] = INERTIA_EFFECTS) -> TorqueHarmonics | None:
    """Return all orders of the torque that the scene's cycle resolves; None when the scene gives no cycle.

    The inertia counts with `reciprocating_inertia` among the enabled effects.
    """
    engine, curve = scene.engine, pressure_curve(scene)
    if engine is None or curve is None:
        return None
    balance = throw_balance(scene)
    gas, both = (
        throw_forces(
            engine, scene.throw.radius_mm, curve, balance, _ANY_SPEED_RPM, reciprocating=counts
        ).torque_Nm
        for counts in (False, "reciprocating_inertia" in enabled)
    )
    inertia = (both - gas) / angular_speed_rad_s(_ANY_SPEED_RPM) ** 2
    of_gas, of_inertia = _amplitudes(gas), _amplitudes(inertia)
    orders = np.arange(len(of_gas), dtype=float) * 360.0 / engine.cycle_deg
    throws = tuple(engine.throw_of(cylinder) for cylinder in range(1, engine.cylinders + 1))
    return TorqueHarmonics(orders, of_gas, of_inertia, engine.firing_angles_deg, throws)


def curve_of(amplitudes: ComplexArray, points: int) -> Array:
    """Values at evenly spaced angles of a cycle from complex amplitudes of its orders, (..., points)."""
    parts = amplitudes * np.where(np.arange(amplitudes.shape[-1]) == 0, 1.0, 0.5)
    return np.asarray(np.fft.irfft(parts, n=points, axis=-1) * points)


def _amplitudes(torque: Array) -> ComplexArray:
    """Complex amplitudes of the orders below the highest that the points resolve."""
    found = np.fft.rfft(torque) / len(torque)
    return np.asarray(np.where(np.arange(len(found)) == 0, 1.0, 2.0) * found)[: len(torque) // 2]
