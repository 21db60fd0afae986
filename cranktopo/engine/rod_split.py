"""Forces in an oblique split of the big end over the cycle: along the bolts, and along its joint face.

The cap is in equilibrium under the crankpin, its own inertia and the joint. The crankpin's force on the big
end presses either at one point, on the half that it points to, or by the cosine over half of the bore, which
may reach beyond the split: both are judged. The rod may be mounted either way round: both are judged as well.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import Literal, get_args

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.checks.rod import rod_of
from cranktopo.design.rod import Rod
from cranktopo.design.rod_body import RodMass, rod_mass
from cranktopo.design.rod_split import turns
from cranktopo.design.schema import Scene
from cranktopo.engine.rod_forces import RodMotion, rod_motions

Pressing = Literal["point", "cosine"]
_PRESSINGS: tuple[Pressing, ...] = get_args(Pressing)


@dataclass(frozen=True)
class SplitForces:
    """Force between cap and rod over a cycle; arrays (angles,).

    Attributes:
        parting_N: along the bolts, positive parts the joint.
        shear_N: along the joint face, positive pushes the cap toward positive u.
        bolt_N: on the bolt that carries more of the parting force.
    """

    speed_rpm: float
    angle_deg: Array
    parting_N: Array
    shear_N: Array
    bolt_N: Array


def split_forces(scene: Scene) -> list[SplitForces]:
    """Return the forces in the oblique split of a scene's rod, of every speed, pressure and way to mount it.

    Raises:
        CranktopoError: no rod, no engine or no gas pressure.
    """
    rod, length = rod_of(scene)
    mass = rod_mass(rod, length, scene.material)
    return [one for motion in rod_motions(scene) for one in _of_motion(rod, length, mass, motion)]


def oblique_bolt_force_N(scene: Scene) -> float:
    """Return the largest force on one bolt of an oblique split."""
    return max(float(one.bolt_N.max()) for one in split_forces(scene))


def _of_motion(rod: Rod, length: float, mass: RodMass, motion: RodMotion) -> Iterator[SplitForces]:
    across, along = motion.big_end_force_N(mass, length)
    cosine, sine = turns(rod)
    for pressed, way in product(_PRESSINGS, (1, -1)):
        v, u = (way * sine, cosine), (way * cosine, -sine)
        on_u, on_v = (across * d[0] + along * d[1] for d in (u, v))
        pushed_u, parting = on_cap_N(on_u, on_v, pressed)
        moved = cap_acceleration_m_s2(
            motion, length, (-mass.split_centre_mm * v[0], -mass.split_centre_mm * v[1])
        )
        inertia_u, inertia_v = (mass.split_kg * (moved[0] * d[0] + moved[1] * d[1]) for d in (u, v))
        total = parting + inertia_v
        uneven = np.abs(inertia_u) * mass.split_centre_mm / rod.bolt_distance_mm
        yield SplitForces(motion.speed_rpm, motion.angle_deg, total, pushed_u - inertia_u, total / 2 + uneven)


def on_cap_N(on_u_N: Array, on_v_N: Array, pressed: Pressing) -> tuple[Array, Array]:
    """Return what of a force on the big end's bore the cap gets: along u, and away from the rod.

    Args:
        on_u_N, on_v_N: force of the crankpin in the frame of the split.
        pressed: at one point, or by the cosine over half of the bore; of that the part on the cap adds up to
            this, where the force points phi away from the middle of the cap.
    """
    force, off = np.hypot(on_u_N, on_v_N), np.arctan2(np.abs(on_u_N), -on_v_N)
    if pressed == "point":
        held = off < math.pi / 2
        return np.where(held, on_u_N, 0.0), np.where(held, -on_v_N, 0.0)
    parting = force / math.pi * ((math.pi - off) * np.cos(off) + np.sin(off))
    return on_u_N * (1 - off / math.pi), parting


def cap_acceleration_m_s2(
    motion: RodMotion, length_mm: float, place_mm: tuple[float, float]
) -> tuple[Array, Array]:
    """Return the acceleration of a point of the rod across it, as both ends' are counted, and toward the
    small end.

    Args:
        place_mm: across and along the rod, from the axis of the big end.
    """
    turning = (motion.small_m_s2 - motion.big_m_s2) / length_mm
    centripetal = (motion.small_along_m_s2 - motion.big_along_m_s2) / length_mm
    x, y = place_mm
    across = motion.big_m_s2 + turning * y - centripetal * x
    return across, -(motion.big_along_m_s2 + centripetal * y + turning * x)
