"""Bush, shells and bolts of the rod, and the holes of oblique bolts, as masses at points."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cranktopo.base.quadrature import gauss_legendre
from cranktopo.base.units import density_kg_per_mm3
from cranktopo.design.rod import Rod
from cranktopo.design.rod_split import in_rod

_BOLT_KG_PER_MM3 = density_kg_per_mm3(7850.0)
_ALONG_HOLE = 64
"""Gauss points along a hole of an oblique bolt."""


@dataclass(frozen=True)
class FittedMass:
    """A mass at a point of the plane of motion, or at two with the same place along the rod.

    Attributes:
        x_mm: of their middle.
        across2_mm2: mean of the squared distance across the rod, its own spread included.
    """

    x_mm: float
    y_mm: float
    kg: float
    across2_mm2: float


def bush_kg(rod: Rod) -> float:
    """Return the mass of the bush."""
    bush = math.pi / 4 * (rod.small_end_bore_mm**2 - rod.pin_diameter_mm**2) * rod.small_end_width_mm
    return density_kg_per_mm3(rod.bush_density_kg_m3) * bush


def bolts_kg(rod: Rod) -> float:
    """Return the mass of both bolts."""
    return sum(mass for _, mass in _bolts(rod))


def fitted(rod: Rod, length_mm: float) -> list[FittedMass]:
    """Return bush, shells, then heads and shanks of both bolts."""
    found = [FittedMass(0.0, length_mm, bush_kg(rod), 0.0), FittedMass(0.0, 0.0, rod.shells_kg, 0.0)]
    for v, mass in _bolts(rod):
        if rod.split_angle_deg:
            found += [_turned(rod, side, v, mass / 2, 0.0) for side in (-1, 1)]
        else:
            found.append(FittedMass(0.0, v, mass, rod.bolt_distance_mm**2 / 4))
    return found


def turned_holes(rod: Rod, kg_per_mm3: float) -> list[FittedMass]:
    """Return what the holes of both bolts of an oblique split take from its bosses, as negative masses."""
    if not rod.bolt_hole_mm:
        return []
    at, weight = gauss_legendre(_ALONG_HOLE)
    half, middle = (rod.boss_above_mm + rod.boss_below_mm) / 2, (rod.boss_above_mm - rod.boss_below_mm) / 2
    spread_mm2 = rod.bolt_hole_mm**2 / 16
    kg = -kg_per_mm3 * math.pi / 4 * rod.bolt_hole_mm**2 * half * weight
    return [
        _turned(rod, side, middle + half * place, mass, spread_mm2)
        for side in (-1, 1)
        for place, mass in zip(at, kg, strict=True)
    ]


def _turned(rod: Rod, side: int, v: float, kg: float, spread_mm2: float) -> FittedMass:
    """A mass on the axis of a bolt; how far it spreads across its bolt counts as across the rod."""
    x, y = in_rod(rod, np.array(side * rod.bolt_distance_mm / 2), np.array(v))
    return FittedMass(float(x), float(y), float(kg), float(x) ** 2 + spread_mm2)


def _bolts(rod: Rod) -> list[tuple[float, float]]:
    """Place along the bolts and mass of heads and shanks of both bolts."""
    found: list[tuple[float, float]] = []
    if rod.bolt is not None:
        bolt, diameter = rod.bolt, rod.bolt.nominal.diameter_mm
        head = 2 * _BOLT_KG_PER_MM3 * math.pi / 4 * bolt.head_mm**2 * diameter
        found.append((-rod.boss_below_mm - diameter / 2, head))
        reach = bolt.grip_mm + bolt.engaged_mm
        in_cap = min(rod.boss_below_mm, reach)
        per_mm = 2 * _BOLT_KG_PER_MM3 * math.pi / 4 * diameter**2
        found.append((-rod.boss_below_mm + in_cap / 2, per_mm * in_cap))
        if reach > in_cap:
            found.append(((reach - in_cap) / 2, per_mm * (reach - in_cap)))
    return found
