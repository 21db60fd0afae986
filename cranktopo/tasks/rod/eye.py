"""The small end as a curved beam: an arch that the shank holds, bush and interference, and the cap.

Sources: R. S. Kinasoshvili's model as A. Kolchin, V. Demidov, Design of Automotive Engines (Mir, 1984),
chapter 12 have it: the pull loads the upper half evenly, the push the lower half by the cosine. The redundant
moment and force follow here from least energy, not from fitted coefficients. Stresses by Winkler and Bach.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.units import MM_PER_M, MPA_PER_GPA
from cranktopo.design.material import Material
from cranktopo.design.rod import Rod
from cranktopo.design.rod_body import fillet

_POINTS = 721
"""Points of an arch; its integrals are exact to 1e-5."""
_CAP_BENDING, _CAP_TENSION = 0.023, 0.4
"""Coefficients of the cap, Kolchin and Demidov (12.36): between a beam and a ring, for rigid joints."""
_BUSH_POISSON = 0.34


@dataclass(frozen=True)
class Arch:
    """Section forces of an arch with its ends held, per newton of load and millimetre of radius.

    Attributes:
        angle_rad: from the crown to where the shank holds it.
        moment: over load and radius; positive stretches the outside.
        normal: over load; positive is tension.
    """

    angle_rad: Array
    moment: Array
    normal: Array


def held_angle_rad(rod: Rod, length_mm: float) -> float:
    """Return the angle from the crown of the small end to where its ring meets shank or fillet."""
    arc = fillet(rod, length_mm, small=True)
    if arc is not None:
        return math.pi - math.atan2(arc.eye_x_mm, length_mm - arc.eye_y_mm)
    return math.pi - math.asin(min(rod.shank_small_mm / rod.small_end_diameter_mm, 1.0))


def pulled_arch(held_rad: float) -> Arch:
    """Return the arch under a pull: even pressure on its upper half."""
    angle = np.linspace(0.0, held_rad, _POINTS)
    sine, cosine = np.sin(angle), np.cos(angle)
    upper = angle <= math.pi / 2
    moment = np.where(upper, -(1 - cosine) / 2, -(sine - cosine) / 2)
    normal = np.where(upper, (1 - cosine) / 2, (sine - cosine) / 2)
    return _least_energy(angle, moment, normal)


def pushed_arch(held_rad: float) -> Arch:
    """Return the arch under a push: pressure by the cosine on its lower half, as far as it is free."""
    angle = np.linspace(0.0, held_rad, _POINTS)
    load = np.sin(angle) / 2 - angle / math.pi * np.sin(angle) - np.cos(angle) / math.pi
    load = np.where(angle <= math.pi / 2, 0.0, load)
    return _least_energy(angle, -load, load)


def _least_energy(angle: Array, moment: Array, normal: Array) -> Arch:
    """Add the moment and normal force at the crown that leave both ends where they are."""
    rise = 1 - np.cos(angle)
    ones = np.ones_like(angle)

    def total(a: Array, b: Array) -> float:
        return float(np.trapezoid(a * b, angle))

    matrix = [[total(ones, ones), total(ones, rise)], [total(ones, rise), total(rise, rise)]]
    crown, thrust = np.linalg.solve(matrix, [-total(ones, moment), -total(rise, moment)])
    return Arch(angle, moment + crown + thrust * rise, normal + thrust * np.cos(angle))


def ring_stress_MPa(
    inner_mm: float, outer_mm: float, width_mm: float, moment_Nmm: Array, normal_N: Array, share: float
) -> tuple[Array, Array]:
    """Return the stresses at inner and outer face of a curved beam of rectangular section.

    Args:
        share: of the normal force that the beam takes beside the bush in it.
    """
    height = outer_mm - inner_mm
    neutral = height / math.log(outer_mm / inner_mm)
    eccentric = (inner_mm + outer_mm) / 2 - neutral
    area = width_mm * height
    even = share * normal_N / area
    bending = moment_Nmm / (area * eccentric)
    return even + bending * (inner_mm - neutral) / inner_mm, even + bending * (outer_mm - neutral) / outer_mm


def bush_pressure_MPa(rod: Rod, material: Material) -> float:
    """Return the pressure between bush and eye by Lame; 0 without interference."""
    if not rod.bush_thickness_mm or not rod.bush_interference_um:
        return 0.0
    bore, outer, inner = rod.small_end_bore_mm, rod.small_end_diameter_mm, rod.pin_diameter_mm
    eye = ((outer**2 + bore**2) / (outer**2 - bore**2) + material.poisson) / material.E_GPa
    bush = ((bore**2 + inner**2) / (bore**2 - inner**2) - _BUSH_POISSON) / rod.bush_E_GPa
    return rod.bush_interference_um / MM_PER_M * MPA_PER_GPA / (bore * (eye + bush))


def press_fit_MPa(rod: Rod, pressure_MPa: float) -> tuple[float, float]:
    """Return the hoop stresses of the bush's pressure at inner and outer face of the eye."""
    bore2, outer2 = rod.small_end_bore_mm**2, rod.small_end_diameter_mm**2
    outer = pressure_MPa * 2 * bore2 / (outer2 - bore2)
    return outer + pressure_MPa, outer


def bush_share(rod: Rod, material: Material) -> float:
    """Return the share of a normal force that the eye takes beside its bush."""
    eye = material.E_GPa * (rod.small_end_diameter_mm - rod.small_end_bore_mm) / 2
    return eye / (eye + rod.bush_E_GPa * rod.bush_thickness_mm)


def cap_stress_MPa(rod: Rod, force_N: float) -> float:
    """Return the stress of the cap in its middle under the force that parts the big end."""
    height = (rod.big_end_diameter_mm - rod.big_end_bore_mm) / 2
    modulus, area = rod.big_end_width_mm * height**2 / 6, rod.big_end_width_mm * height
    return force_N * (_CAP_BENDING * rod.bolt_distance_mm / modulus + _CAP_TENSION / area)
