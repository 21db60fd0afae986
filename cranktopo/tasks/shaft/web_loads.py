"""What each web of a shaft carries, as pin forces and torque on a throw that stands alone.

A web is loaded by the forces of its neighbours on the section beside it. In the middle of the web these have
two bending moments and a torque; a throw between its own two bearings has the same there under other forces
on its pin. So whatever takes the loads of a throw that stands alone can take those of one web of a shaft. The
shear force is not that of the shaft: with the moments it is half the pin force.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.units import NMM_PER_NM
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import LoadHistory
from cranktopo.tasks.fea.condense import RX, RY, RZ, UX, UY
from cranktopo.tasks.shaft.continuous import CycleForces, ShaftCycle, shaft_cycle
from cranktopo.tasks.shaft.loaded_throw import LoadedThrow


def web_histories(
    throws: Sequence[LoadedThrow], scenes: Sequence[Scene], forces: CycleForces, cycle: ShaftCycle
) -> tuple[LoadHistory, ...]:
    """Return the loads of every web from the free end, each in the axes of the half nearer to z = 0.

    The web beyond the crankpin is mirrored in the middle of the pin. Centrifugal force on the throw itself is
    the speed's, and no part of the pin forces.
    """
    found = []
    for index, (throw, scene) in enumerate(zip(throws, scenes, strict=True)):
        ends = cycle.throw_N[index] - _turning_alone(throw, forces)
        for side in (0, 1):
            labels = tuple(f"web {2 * index + side + 1}, {angle:g} deg" for angle in forces.angle_deg)
            found.append(_history(ends, scene, side, forces.angular_speed_rad_s, labels))
    return tuple(found)


def _history(
    ends: Array, scene: Scene, side: int, speed_rad_s: float, labels: tuple[str, ...]
) -> LoadHistory:
    half = halves(scene)[side]
    middle = sum(half.web_z_mm) / 2
    if side:
        end = ends[6:]
        about_x, about_y = middle * end[UY] - end[RX], -(middle * end[UX] + end[RY])
    else:
        end = ends[:6]
        about_x, about_y = middle * end[UY] + end[RX], end[RY] - middle * end[UX]
    radial, tangential = 2 * about_x / middle, 2 * about_y / middle
    passed_on = half.throw.radius_mm * tangential / 2 - end[RZ]
    speed = np.full(len(labels), speed_rad_s)
    return LoadHistory(radial, tangential, passed_on / NMM_PER_NM, speed, labels)


def _turning_alone(throw: LoadedThrow, forces: CycleForces) -> Array:
    """Return the forces on both sections of a throw that turns between its own two bearings, (12, 1)."""
    none = np.zeros((1, 1))
    still = CycleForces(np.zeros(1), none, none, none, none, forces.angular_speed_rad_s)
    return shaft_cycle([throw], (0.0,), still, None).throw_N[0]
