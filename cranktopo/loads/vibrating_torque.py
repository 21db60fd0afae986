"""Torque that the throws of a vibrating shaft pass on, for load cases; their stiffness in closed form."""

from __future__ import annotations

import numpy as np

from cranktopo.errors import invalid
from cranktopo.loads.disk_chain import Array
from cranktopo.loads.engine_torque import ShaftTorque
from cranktopo.loads.shaft_chain import ShaftChain, estimated_chain
from cranktopo.loads.torque_harmonics import TorqueHarmonics, torque_harmonics
from cranktopo.loads.varying_inertia import VaryingPart, varying_part
from cranktopo.loads.vibration import (
    CriticalSpeed,
    critical_speeds,
    on_disks,
    section_curves_Nm,
    speeds_to_solve,
    vibration,
)
from cranktopo.scene import Scene
from cranktopo.scene.checks_shaft import speed_range_rpm


def vibrating_torque(scene: Scene, enabled: frozenset[str]) -> ShaftTorque:
    """Torque ahead of and behind every throw over the cycle at the engine's speed.

    Raises:
        CranktopoError: no torque over the cycle, or nothing at the takeoff.
    """
    shaft, harmonics, _, part = _model(scene, enabled)
    speed = scene.engine.speed_rpm if scene.engine else 0.0
    excited = on_disks(shaft, harmonics.of_throws_Nm(speed))
    found = vibration(shaft, harmonics, np.array([speed]), varying_kg_m2=part.counting_kg_m2)
    curves = section_curves_Nm(shaft, excited, found.torque_Nm[0])
    cycle = 360.0 / float(harmonics.orders[1])
    angle = np.arange(curves.shape[1]) * cycle / curves.shape[1]
    return ShaftTorque(angle, curves[shaft.behind], _ahead(shaft, curves))


def worst_speed_rpm(scene: Scene, enabled: frozenset[str]) -> float:
    """Speed in the scene's range at which the torque of the crankshaft swings most, rpm.

    Raises:
        CranktopoError: as `vibrating_torque`.
    """
    shaft, harmonics, critical, part = _model(scene, enabled)
    speeds = speeds_to_solve(speed_range_rpm(scene), critical, rise=part.rise)
    found = vibration(shaft, harmonics, speeds, varying_kg_m2=part.counting_kg_m2)
    return float(found.speeds_rpm[found.worst.speed_index])


def _model(
    scene: Scene, enabled: frozenset[str]
) -> tuple[ShaftChain, TorqueHarmonics, tuple[CriticalSpeed, ...], VaryingPart]:
    """The shaft, the torques of its cylinders, its critical speeds, the varying part of its inertia."""
    shaft, harmonics = estimated_chain(scene), torque_harmonics(scene, enabled)
    if harmonics is None:
        raise invalid("engine.gas", None, "must be given for the torque of a vibrating shaft")
    if len(shaft.names) == shaft.first + shaft.throws:
        raise invalid("shaft.flywheel", None, "must be given, or another part at the takeoff")
    modes = shaft.chain.modes()
    critical = critical_speeds(shaft, modes, harmonics, speed_range_rpm(scene))
    part = varying_part(scene, shaft, harmonics, modes, {found.mode for found in critical})
    return shaft, harmonics, critical, part


def _ahead(shaft: ShaftChain, curves: Array) -> Array:
    free = np.zeros((0 if shaft.first else 1, curves.shape[1]))
    start = max(shaft.first - 1, 0)
    return np.vstack([free, curves[start : shaft.first + shaft.throws - 1]])
