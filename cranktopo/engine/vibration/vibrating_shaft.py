"""The vibrating shaft of a scene: modes, critical speeds, response at any speed, torque for load cases."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import invalid
from cranktopo.design.checks.engine import speed_range_rpm
from cranktopo.design.schema import Effects, Optimise, Scene
from cranktopo.engine.forces import ShaftTorque
from cranktopo.engine.gas import FileState, trace_states
from cranktopo.engine.vibration.barred import ranges_above
from cranktopo.engine.vibration.shaft_chain import ShaftChain, estimated_chain
from cranktopo.engine.vibration.steady import (
    CriticalSpeed,
    Vibration,
    critical_speeds,
    on_disks,
    order_words,
    orders_to_solve,
    section_curves_Nm,
    speeds_to_solve,
    vibration,
)
from cranktopo.engine.vibration.torque_harmonics import (
    TorqueHarmonics,
    VaryingPart,
    torque_harmonics,
    varying_part,
)
from cranktopo.numerics.disk_chain import DampedMode


@dataclass(frozen=True)
class VibratingShaft:
    """A shaft with the torques of its cylinders, and its critical speeds in the scene's range.

    Attributes:
        engine_rpm: speed of the engine, in the range or not.
        orders: how many are solved.
        barred_rpm: ranges that the engine only passes through.
    """

    shaft: ShaftChain
    harmonics: TorqueHarmonics
    range_rpm: tuple[float, float]
    engine_rpm: float
    modes: tuple[DampedMode, ...]
    critical: tuple[CriticalSpeed, ...]
    varying: VaryingPart
    orders: int
    barred_rpm: tuple[tuple[float, float], ...]

    def at(self, speeds_rpm: Array) -> Vibration:
        """Return the steady response, with the varying inertia where it counts."""
        varying = self.varying.harmonics_kg_m2 if self.varying.included else None
        return self._passing(vibration(self.shaft, self.harmonics, speeds_rpm, self.orders, varying))

    def _passing(self, found: Vibration) -> Vibration:
        return replace(found, barred_rpm=self.barred_rpm)

    def over_the_range(self) -> Vibration:
        """Return the steady response over the scene's range, dense around its critical speeds.

        The engine's own speed is among these, where it lies in the range, and the ends of barred ranges.
        """
        speeds = speeds_to_solve(self.range_rpm, self.critical, rise=self.varying.rise)
        own = np.array([self.engine_rpm, *(end for ends in self.barred_rpm for end in ends)])
        return self.at(np.union1d(speeds, np.clip(own, *self.range_rpm)))

    def with_mean_inertia(self, worst_rpm: float) -> Vibration:
        """Return the steady response with the mean inertia alone where it is largest.

        That is at a critical speed, an end of the range, or the worst speed of the whole response: the range
        is not solved again.
        """
        speeds = [*self.range_rpm, worst_rpm, *(found.speed_rpm for found in self.critical)]
        return self._passing(vibration(self.shaft, self.harmonics, np.unique(speeds), self.orders))


def vibrating_shaft(scene: Scene, shaft: ShaftChain, harmonics: TorqueHarmonics) -> VibratingShaft:
    """Modes, critical speeds and varying inertia of a shaft over the scene's range of speeds."""
    speeds, modes = speed_range_rpm(scene), shaft.chain.damped_modes()
    orders = orders_to_solve(shaft, modes, harmonics, speeds)
    critical = critical_speeds(shaft, modes, harmonics, speeds, orders)
    part = varying_part(scene, shaft, harmonics, modes, {found.mode for found in critical})
    own = scene.engine.speed_rpm if scene.engine else 0.0
    barred = scene.shaft.barred_rpm if scene.shaft else None
    return VibratingShaft(
        shaft, harmonics, speeds, own, tuple(modes), critical, part, orders, tuple(barred or ())
    )


def vibrating_torque(scene: Scene, enabled: frozenset[str]) -> ShaftTorque:
    """Return the torque ahead of and behind every throw over the cycle at the engine's speed."""
    model = _model(scene, enabled)
    shaft = model.shaft
    speed = scene.engine.speed_rpm if scene.engine else 0.0
    excited = on_disks(shaft, model.harmonics.of_throws_Nm(speed))
    found = model.at(np.array([speed]))
    curves = section_curves_Nm(shaft, excited, found.torque_Nm[0])
    cycle = 360.0 / float(model.harmonics.orders[1])
    angle = np.arange(curves.shape[1]) * cycle / curves.shape[1]
    free = np.zeros((0 if shaft.first else 1, curves.shape[1]))
    ahead = curves[max(shaft.first - 1, 0) : shaft.first + shaft.throws - 1]
    return ShaftTorque(angle, curves[shaft.behind], np.vstack([free, ahead]))


def worst_orders_words(scene: Scene, enabled: frozenset[str]) -> str:
    """Return of which orders the torque of the crankshaft is at the worst speed."""
    return _decisive_speeds(scene, enabled).worst_orders


def worst_speed_rpm(scene: Scene, enabled: frozenset[str]) -> float:
    """Return the speed in the scene's range at which the torque of the crankshaft swings most, rpm."""
    return _decisive_speeds(scene, enabled).worst_rpm


def extreme_speeds_rpm(scene: Scene, enabled: frozenset[str]) -> tuple[float, ...]:
    """Return the speeds in the range with the largest and the smallest torque of the crankshaft, rpm."""
    return _decisive_speeds(scene, enabled).extreme_rpm


def ranges_to_bar_rpm(scene: Scene, enabled: frozenset[str]) -> tuple[tuple[float, float], ...]:
    """Return the ranges of speed above the permitted shear stress; none where the scene gives no stress."""
    return _decisive_speeds(scene, enabled).above_rpm


class _DecisiveSpeeds(NamedTuple):
    worst_rpm: float
    worst_orders: str
    extreme_rpm: tuple[float, ...]
    above_rpm: tuple[tuple[float, float], ...]


def _decisive_speeds(scene: Scene, enabled: frozenset[str]) -> _DecisiveSpeeds:
    """Solve the range once for all that asks: a plan, load states and histories, with one effect or another.

    Of the effects only the reciprocating inertia changes the torque, and the threshold what of it varies.
    """
    effects = Effects(threshold=scene.effects.threshold)
    alike = scene.model_copy(update={"effects": effects, "optimise": Optimise(), "goal": None})
    return _solved_range(alike, enabled & {"reciprocating_inertia"}, trace_states(scene))


@lru_cache(maxsize=16)
def _solved_range(scene: Scene, enabled: frozenset[str], _traces: tuple[FileState, ...]) -> _DecisiveSpeeds:
    model, permitted = _model(scene, enabled), scene.shaft.permitted_shear_MPa if scene.shaft else None
    found = model.over_the_range()
    above = () if permitted is None else ranges_above(found, permitted, model.at)
    worst = found.worst
    worst_rpm = float(found.speeds_rpm[worst.speed_index])
    orders = order_words(worst.order, worst.order_Nm, found.worst_Nm)
    return _DecisiveSpeeds(worst_rpm, orders, found.extreme_speeds_rpm, above)


def _model(scene: Scene, enabled: frozenset[str]) -> VibratingShaft:
    """The shaft with the torques of its cylinders; refused where the torque or a takeoff is missing."""
    shaft, harmonics = estimated_chain(scene), torque_harmonics(scene, enabled)
    if harmonics is None:
        raise invalid("engine.gas", None, "must be given for the torque of a vibrating shaft")
    if scene.shaft is None or not scene.shaft.has_takeoff:
        raise invalid("shaft.flywheel", None, "must be given, or another part at the takeoff")
    return vibrating_shaft(scene, shaft, harmonics)
