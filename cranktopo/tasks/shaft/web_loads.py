"""Loads of each web of a shaft, as those of a throw that stands alone.

A web is loaded by forces and moments on the section beside it: those of its bearing, and those of its
neighbour. A throw that stands alone between its own two bearings has the same on its near section under other
forces on its pin, with a moment on both sections beside them. From that section to the pin all is statics, so
the web has the same stress; whatever takes the loads of a throw alone can take those of one web of a shaft.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.units import NMM_PER_NM
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import WebHistory
from cranktopo.numerics.tetrahedra.rigid_motions import RX, RY, RZ, UX, UY
from cranktopo.tasks.shaft.cycle import CycleForces, ShaftCycle, ShaftSwing, shaft_cycle
from cranktopo.tasks.shaft.loaded_throw import LoadedThrow


def web_histories(
    throws: Sequence[LoadedThrow], scenes: Sequence[Scene], forces: CycleForces, cycle: ShaftCycle
) -> tuple[WebHistory, ...]:
    """Return the loads of every web from the free end, each in the axes of the half nearer to z = 0.

    The web beyond the crankpin is mirrored in the middle of the pin. Centrifugal force on the throw itself is
    the speed's, and no part of the pin forces; nor is the resistance of its mass where the shaft vibrates.
    """
    found = []
    for index, (throw, scene) in enumerate(zip(throws, scenes, strict=True)):
        both = cycle.throw_N[index] - _turning_alone(throw, forces)
        swing_Nmm = None if forces.swing is None else forces.swing.throw_Nm[index] * NMM_PER_NM
        if swing_Nmm is not None:
            both = both - _swinging_alone(throw, swing_Nmm)
        for side, mirror in ((0, 1.0), (1, -1.0)):
            end = both[6 * side : 6 * side + 6]
            radial, tangential = 2 * end[UY], -2 * end[UX]
            passed_on = scene.throw.radius_mm * tangential / 2 - end[RZ]
            if swing_Nmm is not None:
                passed_on = passed_on + swing_Nmm / 2
            number = 2 * index + side + 1
            history = WebHistory(
                radial_N=radial,
                tangential_N=tangential,
                torque_Nm=passed_on / NMM_PER_NM,
                angular_speed_rad_s=np.full(forces.angle_deg.size, forces.angular_speed_rad_s),
                labels=tuple(f"web {number}, {angle:g} deg" for angle in forces.angle_deg),
                moment_Nm=mirror * end[RX] / NMM_PER_NM,
                side_moment_Nm=mirror * end[RY] / NMM_PER_NM,
                swing_Nm=None if swing_Nmm is None else swing_Nmm / NMM_PER_NM,
            )
            found.append(history)
    return tuple(found)


def _turning_alone(throw: LoadedThrow, forces: CycleForces) -> Array:
    """Return the forces on both sections of a throw that turns between its own two bearings, (12, 1)."""
    none = np.zeros((1, 1))
    still = CycleForces(np.zeros(1), none, none, none, none, forces.angular_speed_rad_s)
    return shaft_cycle([throw], (0.0,), still, None).throw_N[0]


def _swinging_alone(throw: LoadedThrow, swing_Nmm: Array) -> Array:
    """Return the forces on both sections of a throw whose own mass swings between its bearings, (12, states).

    Without their torques: these are the shaft's, whoever bears the mass.
    """
    none = np.zeros((1, 1))
    still = np.zeros(1)
    forces = CycleForces(
        still, none, none, none, none, 0.0, ShaftSwing(still, none, np.full((1, 1), 1 / NMM_PER_NM))
    )
    one = shaft_cycle([throw], (0.0,), forces, None).throw_N[0].copy()
    one[[RZ, 6 + RZ]] = 0.0
    return np.asarray(one * swing_Nmm)
