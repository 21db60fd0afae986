"""The chain of the fast twin's shaft, written out by hand: pulley, throw with its pistons and rods, flywheel.

Its stiffness matrix in complex numbers, driven by the harmonics of the slider crank's own torque.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array, Complex
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.gas import pressure_curve
from tests.fast_twin import LOSS, PULLEY_NM, THROW_NM

_RADIUS_M, _ROD_M, _BORE_M, _RECIPROCATING_KG, _ROTATING_KG = 0.03375, 0.124, 0.1, 0.53, 0.3
_AMBIENT_PA, _SECOND_FIRES_DEG, _ORDERS, _STATES = 101325.0, 450, 120, 1440


@dataclass(frozen=True)
class TwinByHand:
    """Gas force, acceleration at 1 rad/s and lever over a cycle of one cylinder; disks and their springs."""

    gas_N: Array
    acceleration_m: Array
    lever_m: Array
    disks_kg_m2: tuple[float, ...]
    springs_Nm: Complex

    @classmethod
    def of(cls, scene: Scene) -> TwinByHand:
        """Return that of a twin; without a pulley the throw is the first disk."""
        curve, r, lam = pressure_curve(scene), _RADIUS_M, _RADIUS_M / _ROD_M
        assert curve is not None
        angle, pressure = np.radians(curve.angle_deg), curve.pressure_MPa * 1e6
        sin, cos = np.sin(angle), np.cos(angle)
        lean = np.sqrt(1 - (lam * sin) ** 2)
        acceleration = r * (cos + lam * (cos**2 - sin**2) / lean + lam**3 * (sin * cos) ** 2 / lean**3)
        moving = _ROTATING_KG + _RECIPROCATING_KG / 2
        half, shaft = 2 * THROW_NM * (1 + 1j * LOSS), scene.shaft
        assert shaft is not None
        assert shaft.flywheel is not None
        disks = [throw_balance(scene).inertia_kg_mm2 * 1e-6 + 2 * moving * r**2, shaft.flywheel.inertia_kg_m2]
        springs = [half]
        if shaft.pulley is not None:
            disks.insert(0, shaft.pulley.inertia_kg_m2)
            springs.insert(0, 1 / (1 / half + 1 / (PULLEY_NM * (1 + 1j * LOSS))))
        gas = (pressure - _AMBIENT_PA) * math.pi * _BORE_M**2 / 4
        return cls(gas, acceleration, r * sin * (1 + lam * cos / lean), tuple(disks), np.array(springs))

    def torques_Nm(self, rpm: float) -> Array:
        """Return the torque ahead of and behind the throw at every half degree of the cycle, (2, 1440)."""
        w, orders = rpm * math.pi / 30, np.arange(1, _ORDERS + 1) / 2
        one = (self.gas_N - _RECIPROCATING_KG * self.acceleration_m * w**2) * self.lever_m
        torque = one + np.roll(one, round(_SECOND_FIRES_DEG / 720 * len(one)))
        count, driven = len(self.disks_kg_m2), len(self.disks_kg_m2) - 2
        stiffness = np.zeros((count, count), dtype=complex)
        for i, k in enumerate(self.springs_Nm):
            stiffness[i : i + 2, i : i + 2] += k * np.array([[1, -1], [-1, 1]])
        dynamic = stiffness - (orders * w)[:, None, None] ** 2 * np.diag(self.disks_kg_m2)
        load = np.zeros((_ORDERS, count, 1), dtype=complex)
        load[:, driven, 0] = 2 * np.fft.rfft(torque)[1 : _ORDERS + 1] / len(torque)
        twist = np.linalg.solve(dynamic, load)[..., 0]
        relative = np.pad((twist[:, :-1] - twist[:, 1:]) * self.springs_Nm, ((1, 0), (0, 0)))
        swings = np.fft.irfft(relative, _STATES, axis=0).T * (_STATES / 2)
        ahead = swings[0] if driven else np.zeros(_STATES)
        return np.stack([ahead, swings[-1] + torque.mean()])
