"""Energy that the damping of a chain of disks takes, for balances against what its torques supply."""

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.numerics.disk_chain import ComplexArray, DiskChain


def dissipated_J(chain: DiskChain, frequency_rad_s: Array, twist_rad: ComplexArray) -> Array:
    """Return what all damping takes in one period of a harmonic vibration, J."""
    relative = np.abs(twist_rad[..., :-1] - twist_rad[..., 1:]) ** 2
    springs = (chain.section_stiffness_Nm_per_rad(frequency_rad_s).imag * relative).sum(axis=-1)
    absolute = np.array(chain.absolute_damping_Nms_per_rad or 0.0)
    disks = np.asarray(frequency_rad_s) * (absolute * np.abs(twist_rad) ** 2).sum(axis=-1)
    return np.asarray(np.pi * (springs + disks))
