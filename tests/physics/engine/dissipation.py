"""Energy that the damping of a chain of disks takes, for balances against what its torques supply."""

import numpy as np
import pytest

from cranktopo.base.arrays import Array, Complex
from cranktopo.base.units import angular_speed_rad_s
from cranktopo.engine.vibration.shaft_chain import ShaftChain
from cranktopo.engine.vibration.steady import on_disks
from cranktopo.engine.vibration.torque_harmonics import TorqueHarmonics
from cranktopo.numerics.disk_chain import DiskChain


def dissipated_J(chain: DiskChain, frequency_rad_s: Array, twist_rad: Complex) -> Array:
    """Return what all damping takes in one period of a harmonic vibration, J."""
    relative = np.abs(twist_rad[..., :-1] - twist_rad[..., 1:]) ** 2
    springs = (chain.section_stiffness_Nm_per_rad(frequency_rad_s).imag * relative).sum(axis=-1)
    absolute = np.array(chain.absolute_damping_Nms_per_rad or 0.0)
    disks = np.asarray(frequency_rad_s) * (absolute * np.abs(twist_rad) ** 2).sum(axis=-1)
    return np.asarray(np.pi * (springs + disks))


def check_balance(shaft: ShaftChain, harmonics: TorqueHarmonics, rpm: float) -> None:
    """Check that in a period of each of the first 24 orders the damping takes what the torques supply."""
    torque = on_disks(shaft, harmonics.of_throws_Nm(rpm))[1:25]
    frequency = angular_speed_rad_s(rpm) * harmonics.orders[1:25]
    twist = shaft.chain.response_rad(frequency, torque)
    supplied = np.pi * (torque * twist.conj()).imag.sum(axis=-1)
    assert dissipated_J(shaft.chain, frequency, twist) == pytest.approx(supplied, rel=1e-9)
    assert (supplied > 0).all()
