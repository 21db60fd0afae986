"""Motion of what the ends of a crankshaft carry, in the shaft without mass: it follows the outer journal."""

from __future__ import annotations

import numpy as np

from cranktopo.base.units import UM_PER_MM
from cranktopo.bodies.crank_ends import SIDES, end_length_mm
from cranktopo.design.crank import Side
from cranktopo.design.schema import Scene
from cranktopo.design.shaft import Carried, ShaftTable
from cranktopo.numerics.tetrahedra.rigid_motions import RX, RY, UX, UY
from cranktopo.tasks.shaft.cycle import ShaftCycle
from cranktopo.tasks.shaft.result import CarriedMotion

_MRAD_PER_RAD = 1000.0


def carried_motions(cycle: ShaftCycle, scene: Scene) -> tuple[CarriedMotion, ...]:
    """Return offset and tilt of the parts whose mass the ends of the crank carry, from the free end.

    Nothing loads the ends, so they stay straight and lead on from the middle of the outer main journal.
    """
    motion = cycle.motion.reshape(-1, 6, cycle.angle_deg.size)
    found = []
    for side, own in zip(SIDES, (motion[0], motion[-1]), strict=True):
        outward = -1.0 if side == "free" else 1.0
        for name, part in _carried(scene.shaft or ShaftTable(), side):
            arm_mm = outward * (end_length_mm(scene, side) + part.overhang_mm)
            offset = np.hypot(own[UX] + arm_mm * own[RY], own[UY] - arm_mm * own[RX])
            found.append(
                CarriedMotion(
                    part=name,
                    offset_um=float(offset.max()) * UM_PER_MM,
                    tilt_mrad=float(np.hypot(own[RX], own[RY]).max()) * _MRAD_PER_RAD,
                )
            )
    return tuple(found)


def _carried(shaft: ShaftTable, side: Side) -> list[tuple[str, Carried]]:
    """Return the parts of an end whose mass is given, from the crank outwards."""
    behind = {} if shaft.coupling else {"driven machine": shaft.driven, "propeller": shaft.propeller}
    output = {"flywheel": shaft.flywheel, **behind}
    free = {"pulley": shaft.pulley, "damper": shaft.damper}
    parts = (free if side == "free" else output).items()
    return [(name, part) for name, part in parts if part is not None and part.mass_kg is not None]
