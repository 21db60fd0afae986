"""Forces inside the rod over the cycle: push of the gas, pull of inertia, and the whip of its own mass.

The rod is rigid. Along the cylinder its points accelerate between piston and crankpin in proportion to their
place; across the rod alike. A force on a section is what lies between it and the gas must be given.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.base.units import MM_PER_M, angular_speed_rad_s
from cranktopo.design.checks.rod import rod_of
from cranktopo.design.rod_body import RodMass, rod_mass
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import at_speed, engine_of
from cranktopo.engine.gas import gas_force_N, pressure_curve
from cranktopo.engine.kinematics import exact_motion


@dataclass(frozen=True)
class RodMotion:
    """Gas force and accelerations over a cycle at one speed; all arrays of shape (angles,).

    Attributes:
        piston_m_s2, pin_m_s2: of piston and crankpin along the cylinder, toward the crank.
        small_m_s2, big_m_s2: of both ends across the rod.
        small_along_m_s2, big_along_m_s2: of both ends along the rod, toward the big end.
        cosine, sine: of the rod's angle to the cylinder.
    """

    speed_rpm: float
    angle_deg: Array
    gas_N: Array
    piston_kg: float
    piston_m_s2: Array
    pin_m_s2: Array
    small_m_s2: Array
    big_m_s2: Array
    small_along_m_s2: Array
    big_along_m_s2: Array
    cosine: Array
    sine: Array

    def pin_force_N(self) -> Array:
        """Return the force of the piston pin on the rod along the cylinder, positive a push."""
        return self.gas_N - self.piston_kg * self.piston_m_s2

    def small_end_push_N(self, mass: RodMass, length_mm: float) -> Array:
        """Return the force of the piston pin along the rod, positive a push.

        Its part across the rod is what turns the rod's mass about the big end.
        """
        share = mass.y_mm / length_mm
        by_small, by_big = (float((share * weight * mass.y_kg).sum()) for weight in (share, 1 - share))
        across = by_small * self.small_m_s2 + by_big * self.big_m_s2
        return (self.pin_force_N() - across * self.sine) / self.cosine

    def big_end_force_N(self, mass: RodMass, length_mm: float) -> tuple[Array, Array]:
        """Return the force of the crankpin on the rod across it and along it, toward the small end."""
        share = mass.y_mm / length_mm
        by_small, by_big = (float((weight * mass.y_kg).sum()) for weight in (share, 1 - share))
        along = self.small_end_push_N(mass, length_mm)
        along = along - by_small * self.small_along_m_s2 - by_big * self.big_along_m_s2
        turned = (1 - share) * mass.y_kg
        by_small, by_big = (float((weight * turned).sum()) for weight in (share, 1 - share))
        return by_small * self.small_m_s2 + by_big * self.big_m_s2, along

    def section_force_N(self, mass: RodMass, length_mm: float, y_mm: float) -> Array:
        """Return the compression of the rod at a place, with the inertia of what lies beyond it."""
        beyond = mass.y_mm > y_mm
        share, kg = mass.y_mm[beyond] / length_mm, mass.y_kg[beyond]
        upper, lower = float((share * kg).sum()), float(((1 - share) * kg).sum())
        return (self.pin_force_N() - upper * self.piston_m_s2 - lower * self.pin_m_s2) / self.cosine

    def whip_moment_Nmm(self, mass: RodMass, length_mm: float, y_mm: float) -> Array:
        """Return the bending moment of the rod's mass at a place of a beam on both pins."""
        share = mass.y_mm / length_mm
        by_small, by_big = (_moment_mm_kg(mass, length_mm, y_mm, weight) for weight in (share, 1 - share))
        return by_small * self.small_m_s2 + by_big * self.big_m_s2


def _moment_mm_kg(mass: RodMass, length_mm: float, y_mm: float, weight: Array) -> float:
    """Moment at a place under loads of weight times mass, from the side of the small end."""
    loads = weight * mass.y_kg
    support = float((loads * mass.y_mm).sum()) / length_mm
    beyond = mass.y_mm > y_mm
    return support * (length_mm - y_mm) - float((loads * (mass.y_mm - y_mm))[beyond].sum())


def rod_motions(scene: Scene) -> tuple[RodMotion, ...]:
    """Return the motion at the engine's speed, and at its overspeed where one is given.

    Raises:
        CranktopoError: no rod, no engine or no gas pressure.
    """
    rod_of(scene)
    return tuple(_motion(scene, speed) for speed in engine_of(scene).own_speeds_rpm)


def _motion(scene: Scene, speed_rpm: float) -> RodMotion:
    engine, curve = engine_of(scene), pressure_curve(at_speed(scene, speed_rpm))
    if curve is None:
        raise CranktopoError(
            f"{scene.name}: engine.gas is missing: the rod's forces need the pressure over the cycle.",
            hint="Add [engine.gas] with peak_pressure_MPa and peak_angle_deg, or indicator_csv.",
        )
    radius, length = scene.throw.radius_mm, engine.rod_length_mm
    angle = np.radians(curve.angle_deg)
    centripetal = radius / MM_PER_M * angular_speed_rad_s(speed_rpm) ** 2
    piston = centripetal * exact_motion(angle, radius, length).acceleration_ratio
    tilt = np.arcsin(radius / length * np.sin(angle))
    return RodMotion(
        speed_rpm,
        curve.angle_deg,
        gas_force_N(curve.pressure_MPa, engine),
        engine.masses.piston_group_kg,
        piston,
        centripetal * np.cos(angle),
        piston * np.sin(tilt),
        centripetal * np.sin(angle + tilt),
        piston * np.cos(tilt),
        centripetal * np.cos(angle + tilt),
        np.cos(tilt),
        np.sin(tilt),
    )


def rod_bolt_force_N(scene: Scene) -> tuple[float, float]:
    """Return the largest and the smallest force on one bolt of a square cap, positive parting the split."""
    rod, length = rod_of(scene)
    mass = rod_mass(rod, length, scene.material)
    pulls = [-motion.section_force_N(mass, length, 0.0) / 2 for motion in rod_motions(scene)]
    return max(float(pull.max()) for pull in pulls), 0.0
