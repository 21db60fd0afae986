"""The rod as a body: its cross-sections, its mass along its length, and the two masses that stand for it.

Frame: y from the axis of the big end to that of the small end, x across in the plane of motion, z along the
pins. Every cross-section is a set of strips of constant x-range, each with one range of z: areas and moments
are exact. Along y they are added up by Gauss points, to some 1e-6 of the mass.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.units import density_kg_per_mm3
from cranktopo.design.material import Material
from cranktopo.design.rod import Rod

_PANELS = 1660
"""Panels over the length of a rod."""
_BOLT_KG_PER_MM3 = density_kg_per_mm3(7850.0)


@dataclass(frozen=True)
class Fillet:
    """The arc between the shank's edge and an eye: centre, and where it leaves edge and eye, mm."""

    x_mm: float
    y_mm: float
    edge_y_mm: float
    eye_x_mm: float
    eye_y_mm: float


@dataclass(frozen=True)
class RodSection:
    """Cross-sections at places along the rod; arrays of their shape.

    Attributes:
        swing_mm4: second moment of area for bending in the plane of motion.
        side_mm4: for bending along the crank.
        edge_mm: farthest x.
    """

    area_mm2: Array
    swing_mm4: Array
    side_mm4: Array
    edge_mm: Array


@dataclass(frozen=True)
class RodMass:
    """Masses of the rod with bush, shells and bolts, kg.

    Attributes:
        centre_mm: distance of the centre of mass from the axis of the big end.
        reciprocating_kg, rotating_kg: the two masses at the ends with the same sum and centre of mass.
        inertia_kg_mm2: about the centre of mass, for swinging.
        y_mm, y_kg: places along the rod and the mass at each.
        split_kg: of cap, its shell and the heads of the bolts, below the split.
    """

    body_kg: float
    total_kg: float
    centre_mm: float
    reciprocating_kg: float
    rotating_kg: float
    inertia_kg_mm2: float
    split_kg: float
    y_mm: Array
    y_kg: Array


def fillet(rod: Rod, length_mm: float, small: bool) -> Fillet | None:
    """Return the arc between shank and small or big end; None for a sharp corner."""
    radius, slope = rod.shank_fillet_mm, (rod.shank_small_mm - rod.shank_big_mm) / 2 / length_mm
    if not radius:
        return None
    eye_y = length_mm if small else 0.0
    eye = (rod.small_end_diameter_mm if small else rod.big_end_diameter_mm) / 2
    stretch = math.hypot(1, slope)
    base = rod.shank_big_mm / 2 + radius * stretch
    half_b, c = base * slope - eye_y, base**2 + eye_y**2 - (eye + radius) ** 2
    root = math.sqrt(max(half_b**2 - stretch**2 * c, 0.0))
    y = (-half_b - root if small else -half_b + root) / stretch**2
    x = base + slope * y
    share = eye / (eye + radius)
    return Fillet(x, y, y + radius * slope / stretch, share * x, eye_y + share * (y - eye_y))


def _edge(rod: Rod, length_mm: float, y: Array) -> tuple[Array, Array]:
    """Half the height of the shank, with and without its fillets."""
    plain = (rod.shank_big_mm + (rod.shank_small_mm - rod.shank_big_mm) * y / length_mm) / 2
    found = plain
    for small in (False, True):
        arc = fillet(rod, length_mm, small)
        if arc is not None:
            low, high = sorted((arc.edge_y_mm, arc.eye_y_mm))
            drop = np.sqrt(np.maximum(rod.shank_fillet_mm**2 - (y - arc.y_mm) ** 2, 0.0))
            found = np.where((y >= low) & (y <= high), np.maximum(arc.x_mm - drop, plain), found)
    return found, plain


def shank_edge_mm(rod: Rod, length_mm: float, y: Array) -> Array:
    """Return half the height of the shank in the plane of motion at places, with its fillets."""
    return _edge(rod, length_mm, y)[0]


def _disc(diameter_mm: float, y: Array) -> Array:
    return np.sqrt(np.maximum(diameter_mm**2 / 4 - y**2, 0.0))


def section(rod: Rod, length_mm: float, y: Array) -> RodSection:
    """Return the cross-sections across the rod at places, without holes along it."""
    bored = np.maximum(_disc(rod.small_end_bore_mm, y - length_mm), _disc(rod.big_end_bore_mm, y))
    marks = np.sort(np.stack([0 * y, *_extents(rod, length_mm, y), bored]), axis=0)
    low, high = marks[:-1], marks[1:]
    x = (low + high) / 2
    disc, start, end = _heights(rod, length_mm, x, y)
    solid = x > bored
    dx = (high - low) * solid
    dx3 = (high**3 - low**3) / 3 * solid
    height = disc + end - start
    side = (disc**3 + end**3 - start**3) / 3
    edge = np.where(solid & (height > 0) & (high > low), high, 0.0).max(axis=0)
    return RodSection(
        4 * (height * dx).sum(axis=0), 4 * (height * dx3).sum(axis=0), 4 * (side * dx).sum(axis=0), edge
    )


def width_mm(rod: Rod, length_mm: float, x: Array, y: Array) -> Array:
    """Return the material along the pins at points x >= 0 of the rod, bores not cut, holes of bolts cut."""
    disc, start, end = _heights(rod, length_mm, x, y)
    hole = 2 * _disc(rod.bolt_hole_mm, x - rod.bolt_distance_mm / 2) * _in_boss(rod, y)
    return np.maximum(2 * (disc + end - start) - hole, 0.0)


def _extents(rod: Rod, length_mm: float, y: Array) -> tuple[Array, Array, Array, Array, Array]:
    """Half the width across at places: small end, big end, bosses, shank, inside of its flanges."""
    small, big = _disc(rod.small_end_diameter_mm, y - length_mm), _disc(rod.big_end_diameter_mm, y)
    boss = rod.boss_width_mm / 2 * _in_boss(rod, y)
    filleted, plain = _edge(rod, length_mm, y)
    between = (y >= 0) & (y <= length_mm)
    shank = np.where(between, filleted, 0.0)
    inner = np.where(between, plain - rod.flange_mm, 0.0) if rod.shank == "I" else 0 * y
    inner = np.where(between, rod.web_mm / 2, 0.0) if rod.shank == "H" else inner
    return small, big, boss, shank, inner


def _heights(rod: Rod, length_mm: float, x: Array, y: Array) -> tuple[Array, Array, Array]:
    """Ranges of z >= 0 that are material: from 0 to the first, and from the second to the third."""
    small, big, boss, shank, inner = _extents(rod, length_mm, y)
    disc = np.where(x < small, rod.small_end_width_mm / 2, 0.0)
    disc = np.maximum(disc, np.where((x < big) | (x < boss), rod.big_end_width_mm / 2, 0.0))
    start, end = _shank_z(rod, x, shank, inner)
    start = np.maximum(start, disc)
    return disc, start, np.maximum(end, start)


def _shank_z(rod: Rod, x: Array, shank: Array, inner: Array) -> tuple[Array, Array]:
    """Range of z that the shank fills at each x, in the first quadrant."""
    full = np.where(x < shank, rod.shank_width_mm / 2, 0.0)
    if rod.shank == "I":
        return 0 * x, np.where(x < inner, np.minimum(full, rod.web_mm / 2), full)
    if rod.shank == "H":
        return np.where(x < inner, 0.0, np.maximum(full - rod.flange_mm, 0.0)), full
    return 0 * x, full


def drilled(rod: Rod, found: RodSection) -> RodSection:
    """Return sections of the shank less the oil hole in their middle."""
    hole = rod.oil_hole_mm
    area, moment = math.pi / 4 * hole**2, math.pi / 64 * hole**4
    return RodSection(found.area_mm2 - area, found.swing_mm4 - moment, found.side_mm4 - moment, found.edge_mm)


def rod_mass(rod: Rod, length_mm: float, material: Material) -> RodMass:
    """Return the masses of a rod of a length, of its own material or else of that given."""
    return _mass(rod, length_mm, (rod.material or material).density_kg_m3)


@lru_cache(maxsize=64)
def _mass(rod: Rod, length_mm: float, density_kg_m3: float) -> RodMass:
    density = density_kg_per_mm3(density_kg_m3)
    y, step = _places(rod, length_mm)
    sections = section(rod, length_mm, y)
    removed_mm2 = _holes_mm2(rod, length_mm, y)
    bolts = math.pi / 2 * rod.bolt_distance_mm**2 / 4 * rod.bolt_hole_mm**2 * _in_boss(rod, y)
    kg = density * step * (sections.area_mm2 - removed_mm2)
    own_kg_mm2 = density * float((step * (sections.swing_mm4 - bolts)).sum())
    body = float(kg.sum())
    extra = _fitted(rod, length_mm)
    own_kg_mm2 += sum(mass for _, mass in extra[2:]) * rod.bolt_distance_mm**2 / 4
    y, kg = np.append(y, [place for place, _ in extra]), np.append(kg, [mass for _, mass in extra])
    total = float(kg.sum())
    centre = float((kg * y).sum()) / total
    inertia = own_kg_mm2 + float((kg * (y - centre) ** 2).sum())
    reciprocating = total * centre / length_mm
    below = float(kg[y < 0].sum()) + rod.shells_kg / 2
    return RodMass(body, total, centre, reciprocating, total - reciprocating, inertia, below, y, kg)


def _places(rod: Rod, length_mm: float) -> tuple[Array, Array]:
    """Gauss points along the rod and the length that each stands for, between all places where it changes."""
    marks = {0.0, length_mm, -rod.boss_below_mm, rod.boss_above_mm}
    marks |= {side * d / 2 for d in (rod.big_end_diameter_mm, rod.big_end_bore_mm) for side in (-1, 1)}
    small = (rod.small_end_diameter_mm, rod.small_end_bore_mm)
    marks |= {length_mm + side * d / 2 for d in small for side in (-1, 1)}
    ordered = sorted(marks)
    pieces = [
        np.linspace(low, high, max(2, math.ceil((high - low) / length_mm * _PANELS) + 1))[:-1]
        for low, high in pairwise(ordered)
    ]
    edges = np.append(np.concatenate(pieces), ordered[-1])
    at, weight = np.polynomial.legendre.leggauss(3)
    half, middle = np.diff(edges) / 2, (edges[1:] + edges[:-1]) / 2
    return (middle[:, None] + half[:, None] * at).ravel(), (half[:, None] * weight).ravel()


def _in_boss(rod: Rod, y: Array) -> Array:
    return ((y >= -rod.boss_below_mm) & (y <= rod.boss_above_mm)).astype(float)


def _holes_mm2(rod: Rod, length_mm: float, y: Array) -> Array:
    """Area of the holes of both bolts and of the oil hole, between both bores, in each cross-section."""
    bolts = math.pi / 2 * rod.bolt_hole_mm**2 * _in_boss(rod, y)
    radius = rod.oil_hole_mm / 2
    from_axis = np.maximum(
        _disc(rod.small_end_bore_mm, y - length_mm) * (y < length_mm), _disc(rod.big_end_bore_mm, y) * (y > 0)
    )
    at = np.minimum(from_axis / radius, 1.0) if radius else 0 * y
    open_share = 1 - 2 / math.pi * (np.arcsin(at) + at * np.sqrt(1 - at**2))
    between = (y > 0) & (y < length_mm)
    return np.asarray(bolts + math.pi * radius**2 * open_share * between)


def bush_kg(rod: Rod) -> float:
    """Return the mass of the bush."""
    bush = math.pi / 4 * (rod.small_end_bore_mm**2 - rod.pin_diameter_mm**2) * rod.small_end_width_mm
    return density_kg_per_mm3(rod.bush_density_kg_m3) * bush


def bolts_kg(rod: Rod) -> float:
    """Return the mass of both bolts."""
    return sum(mass for _, mass in _bolts(rod))


def _fitted(rod: Rod, length_mm: float) -> list[tuple[float, float]]:
    """Place and mass of what is fitted: bush, shells, then heads and shanks of both bolts."""
    return [(length_mm, bush_kg(rod)), (0.0, rod.shells_kg), *_bolts(rod)]


def _bolts(rod: Rod) -> list[tuple[float, float]]:
    """Place and mass of heads and shanks of both bolts."""
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
