"""The vibrating shaft of a scene: modes, critical speeds and varying inertia, solved at any speeds."""

from __future__ import annotations

from dataclasses import dataclass

from cranktopo.base.arrays import Array
from cranktopo.design.checks.shaft import speed_range_rpm
from cranktopo.design.schema import Scene
from cranktopo.engine.vibration.shaft_chain import ShaftChain
from cranktopo.engine.vibration.steady import (
    CriticalSpeed,
    Vibration,
    critical_speeds,
    speeds_to_solve,
    vibration,
)
from cranktopo.engine.vibration.torque_harmonics import TorqueHarmonics
from cranktopo.engine.vibration.varying_inertia import VaryingPart, varying_part
from cranktopo.numerics.disk_chain import DampedMode


@dataclass(frozen=True)
class VibratingShaft:
    """A shaft with the torques of its cylinders.

    Attributes:
        range_rpm: lowest and highest speed of the scene's range.
        critical: crossings of orders and natural frequencies in the range.
        varying: the varying part of the inertia, and whether the response has it.
    """

    shaft: ShaftChain
    harmonics: TorqueHarmonics
    range_rpm: tuple[float, float]
    modes: tuple[DampedMode, ...]
    critical: tuple[CriticalSpeed, ...]
    varying: VaryingPart

    def at(self, speeds_rpm: Array) -> Vibration:
        """Return the steady response, with the varying inertia where it counts."""
        return vibration(self.shaft, self.harmonics, speeds_rpm, varying_kg_m2=self.varying.counting_kg_m2)

    def over_the_range(self) -> Vibration:
        """Return the steady response over the scene's range, dense around its critical speeds."""
        return self.at(speeds_to_solve(self.range_rpm, self.critical, rise=self.varying.rise))

    def with_mean_inertia(self) -> Vibration:
        """Return the steady response over the range with the mean inertia alone."""
        return vibration(self.shaft, self.harmonics, speeds_to_solve(self.range_rpm, self.critical))


def vibrating_shaft(scene: Scene, shaft: ShaftChain, harmonics: TorqueHarmonics) -> VibratingShaft:
    """Modes, critical speeds and varying inertia of a shaft over the scene's range of speeds."""
    speeds, modes = speed_range_rpm(scene), shaft.chain.damped_modes()
    critical = critical_speeds(shaft, modes, harmonics, speeds)
    part = varying_part(scene, shaft, harmonics, modes, {found.mode for found in critical})
    return VibratingShaft(shaft, harmonics, speeds, tuple(modes), critical, part)
