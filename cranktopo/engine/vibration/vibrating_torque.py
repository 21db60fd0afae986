"""Torque that the throws of a vibrating shaft pass on, for load cases; their stiffness in closed form."""

from __future__ import annotations

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import invalid
from cranktopo.design.schema import Scene
from cranktopo.engine.torque import ShaftTorque
from cranktopo.engine.vibration.shaft_chain import ShaftChain, estimated_chain
from cranktopo.engine.vibration.steady import on_disks, section_curves_Nm
from cranktopo.engine.vibration.torque_harmonics import torque_harmonics
from cranktopo.engine.vibration.vibrating_shaft import VibratingShaft, vibrating_shaft


def vibrating_torque(scene: Scene, enabled: frozenset[str]) -> ShaftTorque:
    """Torque ahead of and behind every throw over the cycle at the engine's speed.

    Raises:
        CranktopoError: no torque over the cycle, or nothing at the takeoff.
    """
    model = _model(scene, enabled)
    shaft = model.shaft
    speed = scene.engine.speed_rpm if scene.engine else 0.0
    excited = on_disks(shaft, model.harmonics.of_throws_Nm(speed))
    found = model.at(np.array([speed]))
    curves = section_curves_Nm(shaft, excited, found.torque_Nm[0])
    cycle = 360.0 / float(model.harmonics.orders[1])
    angle = np.arange(curves.shape[1]) * cycle / curves.shape[1]
    return ShaftTorque(angle, curves[shaft.behind], _ahead(shaft, curves))


def worst_speed_rpm(scene: Scene, enabled: frozenset[str]) -> float:
    """Speed in the scene's range at which the torque of the crankshaft swings most, rpm.

    Raises:
        CranktopoError: as `vibrating_torque`.
    """
    found = _model(scene, enabled).over_the_range()
    return float(found.speeds_rpm[found.worst.speed_index])


def _model(scene: Scene, enabled: frozenset[str]) -> VibratingShaft:
    """The shaft with the torques of its cylinders; refused where the torque or a takeoff is missing."""
    shaft, harmonics = estimated_chain(scene), torque_harmonics(scene, enabled)
    if harmonics is None:
        raise invalid("engine.gas", None, "must be given for the torque of a vibrating shaft")
    if len(shaft.names) == shaft.first + shaft.throws:
        raise invalid("shaft.flywheel", None, "must be given, or another part at the takeoff")
    return vibrating_shaft(scene, shaft, harmonics)


def _ahead(shaft: ShaftChain, curves: Array) -> Array:
    free = np.zeros((0 if shaft.first else 1, curves.shape[1]))
    start = max(shaft.first - 1, 0)
    return np.vstack([free, curves[start : shaft.first + shaft.throws - 1]])
