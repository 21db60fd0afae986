"""The piston pin in closed form: bending, shear, ovalisation and pressures.

Source: A. Kolchin, V. Demidov, Design of Automotive Engines (Mir, 1984), chapter 11, after Kinasoshvili: even
load in the rod, a triangle in each boss, and a ring under pressure by the sine, whose ovalisation is raised
by half for the share of the length that carries.
"""

from __future__ import annotations

import math

from cranktopo.base.result import Result
from cranktopo.base.units import MM_PER_M, MPA_PER_GPA
from cranktopo.design.rod import PistonPin, Rod

_SHEAR = 0.85


class PinCheck(Result):
    """Stresses, ovalisation and pressures of the piston pin under the largest push."""

    force_N: float
    bending_MPa: float
    shear_MPa: float
    """Largest shear stress between rod and boss."""
    ovalisation_um: float
    """Largest increase of the diameter."""
    hoop_MPa: float
    """Largest stress of the ovalisation, at the bore in the plane of the load's normal."""
    eye_pressure_MPa: float
    boss_pressure_MPa: float


def check_pin(rod: Rod, pin: PistonPin, force_N: float) -> PinCheck:
    """Return the check of a piston pin under a force of the rod."""
    d, length, width = rod.pin_diameter_mm, pin.length_mm, rod.small_end_width_mm
    ratio = pin.bore_diameter_mm / d
    ring = 1 - ratio**4
    slender = 0.1 - (ratio - 0.4) ** 3
    ovalisation = 1.35 * force_N / (pin.E_GPa * MPA_PER_GPA * length)
    ovalisation *= ((1 + ratio) / (1 - ratio)) ** 3 * slender
    moment = force_N * (length + 2 * pin.boss_distance_mm - 1.5 * width) / 12
    return PinCheck(
        force_N=force_N,
        bending_MPa=moment / (math.pi / 32 * d**3 * ring),
        shear_MPa=_SHEAR * force_N * (1 + ratio + ratio**2) / (ring * d**2),
        ovalisation_um=ovalisation * MM_PER_M,
        hoop_MPa=_hoop_MPa(force_N / (length * d), ratio) * slender,
        eye_pressure_MPa=force_N / (d * width),
        boss_pressure_MPa=force_N / (d * (length - pin.boss_distance_mm)),
    )


def _hoop_MPa(pressure_MPa: float, ratio: float) -> float:
    """Return the stress at the bore across the load; of a solid pin that at its surface below the load."""
    thick = (1 + ratio) / (1 - ratio) ** 2
    if not ratio:
        return 15 * pressure_MPa * (0.174 * 2 * thick + 0.636)
    return 15 * pressure_MPa * (0.19 * (1 + 2 * ratio) * thick / ratio + 1 / (1 - ratio))
