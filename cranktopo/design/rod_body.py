"""The rod as a body: its cross-sections, its mass along its length, and the two masses that stand for it.

Frame: y from the axis of the big end to that of the small end, x across in the plane of motion, z along the
pins. Every cross-section is a set of strips of constant x-range, each with one range of z: areas and moments
are exact. Along y they are added up by Gauss points, to some 1e-6 of the mass.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.quadrature import gauss_legendre
from cranktopo.base.units import density_kg_per_mm3
from cranktopo.design.material import Material
from cranktopo.design.rod import Rod
from cranktopo.design.rod_fitted import fitted, turned_holes
from cranktopo.design.rod_split import boss_marks_mm, boss_range_mm, in_split

_PANELS = 1660
"""Panels over the length of a rod."""
_SHELL_CENTRE = 2 / math.pi
"""Distance of the centre of half a thin ring from its axis, over the radius."""


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
        across_mm3: first moment of area toward positive x; 0 but at the bosses of an oblique split.
    """

    area_mm2: Array
    swing_mm4: Array
    side_mm4: Array
    edge_mm: Array
    across_mm3: Array


@dataclass(frozen=True)
class RodMass:
    """Masses of the rod with bush, shells and bolts, kg.

    Attributes:
        centre_mm: distance of the centre of mass from the axis of the big end.
        reciprocating_kg, rotating_kg: the two masses at the ends with the same sum and centre of mass.
        inertia_kg_mm2: about the centre of mass, for swinging.
        y_mm, y_kg: places along the rod and the mass at each.
        split_kg: of cap, its shell and the heads of the bolts, below the split.
        split_centre_mm: distance of their centre of mass from the split, along the bolts.
        across_mm: distance of the centre of mass from the rod's axis toward positive x, of an oblique split.
    """

    body_kg: float
    total_kg: float
    centre_mm: float
    reciprocating_kg: float
    rotating_kg: float
    inertia_kg_mm2: float
    split_kg: float
    split_centre_mm: float
    across_mm: float
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
    right = _one_side(rod, length_mm, y, 1)
    left = _one_side(rod, length_mm, y, -1) if rod.split_angle_deg else right
    return RodSection(
        2 * (right.area_mm2 + left.area_mm2),
        2 * (right.swing_mm4 + left.swing_mm4),
        2 * (right.side_mm4 + left.side_mm4),
        np.maximum(right.edge_mm, left.edge_mm),
        2 * (right.across_mm3 - left.across_mm3),
    )


def _one_side(rod: Rod, length_mm: float, y: Array, side: int) -> RodSection:
    """The quarter of the cross-sections on one side of the rod's axis."""
    bored = np.maximum(_disc(rod.small_end_bore_mm, y - length_mm), _disc(rod.big_end_bore_mm, y))
    marks = np.sort(np.stack([0 * y, *_extents(rod, length_mm, y, side), bored]), axis=0)
    low, high = marks[:-1], marks[1:]
    x = (low + high) / 2
    disc, start, end = _heights(rod, length_mm, x, y, side)
    solid = x > bored
    dx = (high - low) * solid
    dx2 = (high**2 - low**2) / 2 * solid
    dx3 = (high**3 - low**3) / 3 * solid
    height = disc + end - start
    wide = (disc**3 + end**3 - start**3) / 3
    edge = np.where(solid & (height > 0) & (high > low), high, 0.0).max(axis=0)
    across = (height * dx2).sum(axis=0)
    return RodSection(
        (height * dx).sum(axis=0), (height * dx3).sum(axis=0), (wide * dx).sum(axis=0), edge, across
    )


def width_mm(rod: Rod, length_mm: float, x: Array, y: Array) -> Array:
    """Return the material along the pins at points of the rod, bores not cut, holes of bolts cut."""
    sides = (1, -1) if rod.split_angle_deg else (1,)
    found = [_width(rod, length_mm, np.abs(x), y, side) for side in sides]
    u, v = in_split(rod, x, y)
    hole = 2 * _disc(rod.bolt_hole_mm, np.abs(u) - rod.bolt_distance_mm / 2) * _in_boss(rod, v)
    return np.maximum(np.where(x < 0, found[-1], found[0]) - hole, 0.0)


def _width(rod: Rod, length_mm: float, x: Array, y: Array, side: int) -> Array:
    disc, start, end = _heights(rod, length_mm, x, y, side)
    return np.asarray(2 * (disc + end - start))


def _extents(rod: Rod, length_mm: float, y: Array, side: int) -> tuple[Array, ...]:
    """Half the width on a side: small end, big end, shank, inside of its flanges, bosses from and to."""
    small, big = _disc(rod.small_end_diameter_mm, y - length_mm), _disc(rod.big_end_diameter_mm, y)
    filleted, plain = _edge(rod, length_mm, y)
    between = (y >= 0) & (y <= length_mm)
    shank = np.where(between, filleted, 0.0)
    inner = np.where(between, plain - rod.flange_mm, 0.0) if rod.shank == "I" else 0 * y
    inner = np.where(between, rod.web_mm / 2, 0.0) if rod.shank == "H" else inner
    return small, big, shank, inner, *boss_range_mm(rod, y, side)


def _heights(rod: Rod, length_mm: float, x: Array, y: Array, side: int) -> tuple[Array, Array, Array]:
    """Ranges of z >= 0 that are material: from 0 to the first, and from the second to the third."""
    small, big, shank, inner, low, high = _extents(rod, length_mm, y, side)
    disc = np.where(x < small, rod.small_end_width_mm / 2, 0.0)
    in_boss = (x < high) & (x >= low)
    disc = np.maximum(disc, np.where((x < big) | in_boss, rod.big_end_width_mm / 2, 0.0))
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
    return replace(
        found,
        area_mm2=found.area_mm2 - area,
        swing_mm4=found.swing_mm4 - moment,
        side_mm4=found.side_mm4 - moment,
    )


def rod_mass(rod: Rod, length_mm: float, material: Material) -> RodMass:
    """Return the masses of a rod of a length, of its own material or else of that given."""
    return _mass(rod, length_mm, (rod.material or material).density_kg_m3)


@lru_cache(maxsize=64)
def _mass(rod: Rod, length_mm: float, density_kg_m3: float) -> RodMass:
    density = density_kg_per_mm3(density_kg_m3)
    y, step = _places(rod, length_mm)
    sections = section(rod, length_mm, y)
    square = not rod.split_angle_deg
    removed_mm2 = _oil_hole_mm2(rod, length_mm, y) + (_bolt_holes_mm2(rod, y) if square else 0.0)
    kg = density * step * (sections.area_mm2 - removed_mm2)
    swing_mm4 = sections.swing_mm4 - (
        _bolt_holes_mm2(rod, y) * rod.bolt_distance_mm**2 / 4 if square else 0.0
    )
    own_kg_mm2 = density * float((step * swing_mm4).sum())
    body = float(kg.sum())
    more = fitted(rod, length_mm)
    if not square:
        holes = turned_holes(rod, density)
        body += float(sum(hole.kg for hole in holes))
        more = [*holes, *more]
    own_kg_mm2 += sum(one.kg * one.across2_mm2 for one in more)
    y, kg = np.append(y, [one.y_mm for one in more]), np.append(kg, [one.kg for one in more])
    total = float(kg.sum())
    centre = float((kg * y).sum()) / total
    across = density * float((step * sections.across_mm3).sum()) + sum(one.kg * one.x_mm for one in more)
    across /= total
    inertia = own_kg_mm2 + float((kg * (y - centre) ** 2).sum()) - total * across**2
    reciprocating = total * centre / length_mm
    below, below_mm = _below_split(rod, y, kg) if square else _square_cap(rod, length_mm, density_kg_m3)
    return RodMass(
        body,
        total,
        centre,
        reciprocating,
        total - reciprocating,
        inertia,
        below,
        below_mm,
        across,
        y,
        kg,
    )


def _below_split(rod: Rod, y: Array, kg: Array) -> tuple[float, float]:
    """Mass of the cap of a square split with its shell and heads, and how far their centre is below it."""
    cap = y < 0
    mass = float(kg[cap].sum()) + rod.shells_kg / 2
    shell = rod.shells_kg / 2 * _SHELL_CENTRE * rod.big_end_bore_mm / 2
    return mass, (shell - float((kg * y)[cap].sum())) / mass


def _square_cap(rod: Rod, length_mm: float, density_kg_m3: float) -> tuple[float, float]:
    """The same of an oblique split: its cap is that of a square one, turned."""
    square = _mass(rod.model_copy(update={"split_angle_deg": 0.0}), length_mm, density_kg_m3)
    return square.split_kg, square.split_centre_mm


def _places(rod: Rod, length_mm: float) -> tuple[Array, Array]:
    """Gauss points along the rod and the length that each stands for, between all places where it changes."""
    marks = {0.0, length_mm, *boss_marks_mm(rod)}
    marks |= {side * d / 2 for d in (rod.big_end_diameter_mm, rod.big_end_bore_mm) for side in (-1, 1)}
    small = (rod.small_end_diameter_mm, rod.small_end_bore_mm)
    marks |= {length_mm + side * d / 2 for d in small for side in (-1, 1)}
    ordered = sorted(marks)
    pieces = [
        np.linspace(low, high, max(2, math.ceil((high - low) / length_mm * _PANELS) + 1))[:-1]
        for low, high in pairwise(ordered)
    ]
    edges = np.append(np.concatenate(pieces), ordered[-1])
    at, weight = gauss_legendre(3)
    half, middle = np.diff(edges) / 2, (edges[1:] + edges[:-1]) / 2
    return (middle[:, None] + half[:, None] * at).ravel(), (half[:, None] * weight).ravel()


def _in_boss(rod: Rod, y: Array) -> Array:
    return ((y >= -rod.boss_below_mm) & (y <= rod.boss_above_mm)).astype(float)


def _bolt_holes_mm2(rod: Rod, y: Array) -> Array:
    """Area of the holes of both bolts of a square split in each cross-section."""
    return np.asarray(math.pi / 2 * rod.bolt_hole_mm**2 * _in_boss(rod, y))


def _oil_hole_mm2(rod: Rod, length_mm: float, y: Array) -> Array:
    """Area of the oil hole, between both bores, in each cross-section."""
    radius = rod.oil_hole_mm / 2
    from_axis = np.maximum(
        _disc(rod.small_end_bore_mm, y - length_mm) * (y < length_mm), _disc(rod.big_end_bore_mm, y) * (y > 0)
    )
    at = np.minimum(from_axis / radius, 1.0) if radius else 0 * y
    open_share = 1 - 2 / math.pi * (np.arcsin(at) + at * np.sqrt(1 - at**2))
    between = (y > 0) & (y < length_mm)
    return np.asarray(math.pi * radius**2 * open_share * between)
