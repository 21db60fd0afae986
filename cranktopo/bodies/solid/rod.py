"""OCC solid of the rod with its cap, without what is fitted; checked against the mass of its sections."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.solid.checked import ClosedForm, check_body
from cranktopo.bodies.solid.shapes import cut
from cranktopo.design.checks.rod import rod_of
from cranktopo.design.rod import Rod
from cranktopo.design.rod_body import fillet, rod_mass
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import DimTags


def add_rod(occ: Any, scene: Scene) -> DimTags:
    """Return rod and cap in one, big end at the origin, the small end along y, pins along z."""
    rod, length = rod_of(scene)
    small = _eye(occ, length, rod.small_end_diameter_mm, rod.small_end_width_mm)
    big = _eye(occ, 0.0, rod.big_end_diameter_mm, rod.big_end_width_mm)
    low, width = (-rod.boss_width_mm / 2, -rod.boss_below_mm, -rod.big_end_width_mm / 2), rod.big_end_width_mm
    boss = (3, occ.addBox(*low, rod.boss_width_mm, rod.boss_below_mm + rod.boss_above_mm, width))
    _turn(occ, rod, [boss])
    shank = cut(occ, _prism(occ, _outline(occ, rod, length), rod.shank_width_mm), _pockets(occ, rod, length))
    body, _ = occ.fuse(shank, [small, big, boss])
    wide = 2 * max(rod.small_end_width_mm, rod.big_end_width_mm)
    holes = [
        _eye(occ, length, rod.small_end_bore_mm, wide),
        _eye(occ, 0.0, rod.big_end_bore_mm, wide),
    ]
    if rod.bolt_hole_mm:
        deep = rod.boss_below_mm + rod.boss_above_mm
        bolts: DimTags = []
        for side in (-1, 1):
            x = side * rod.bolt_distance_mm / 2
            bolts.append((3, occ.addCylinder(x, -rod.boss_below_mm, 0, 0, deep, 0, rod.bolt_hole_mm / 2)))
        _turn(occ, rod, bolts)
        holes += bolts
    if rod.oil_hole_mm:
        holes.append((3, occ.addCylinder(0, 0, 0, 0, length, 0, rod.oil_hole_mm / 2)))
    body = cut(occ, body, holes)
    material = rod.material or scene.material
    density = density_kg_per_mm3(material.density_kg_m3)
    check_body(occ, body, ClosedForm(rod_mass(rod, length, material).body_kg / density), "rod")
    return list(body)


def _turn(occ: Any, rod: Rod, bodies: DimTags) -> None:
    """Turn what stands on a square split by the angle of the split."""
    if rod.split_angle_deg:
        occ.rotate(bodies, 0, 0, 0, 0, 0, 1, -math.radians(rod.split_angle_deg))


def _eye(occ: Any, y: float, diameter: float, width: float) -> tuple[int, int]:
    return 3, occ.addCylinder(0, y, -width / 2, 0, 0, width, diameter / 2)


def _outline(occ: Any, rod: Rod, length: float) -> int:
    """The face of the shank between both axes, its fillets as arcs."""
    bottom, top = (occ.addPoint(0, y, 0) for y in (0.0, length))
    up, down = (_side(occ, rod, length, side, bottom, top) for side in (1, -1))
    return int(occ.addPlaneSurface([occ.addCurveLoop([*up, *reversed(down)])]))


def _side(occ: Any, rod: Rod, length: float, side: int, bottom: int, top: int) -> list[int]:
    """Curves of one side of the shank from the axis of the big end to that of the small end."""
    big, small = rod.shank_big_mm / 2, rod.shank_small_mm / 2
    arcs = [fillet(rod, length, at_small) for at_small in (False, True)]
    points: list[int] = [bottom]
    centres: list[int] = []
    for arc, y, half in zip(arcs, (0.0, length), (big, small), strict=True):
        if arc is None:
            points.append(occ.addPoint(side * half, y, 0))
            continue
        edge = side * (big + arc.edge_y_mm / length * (small - big))
        ends = [
            occ.addPoint(side * arc.eye_x_mm, arc.eye_y_mm, 0),
            occ.addPoint(edge, arc.edge_y_mm, 0),
        ]
        points += ends if not y else reversed(ends)
        centres.append(occ.addPoint(side * arc.x_mm, arc.y_mm, 0))
    pairs = [*pairwise([*points, top])]
    arc_of = {1: centres[0], 3: centres[1]} if centres else {}
    return [
        occ.addCircleArc(a, arc_of[n], b) if n in arc_of else occ.addLine(a, b)
        for n, (a, b) in enumerate(pairs)
    ]


def _prism(occ: Any, face: int, width: float) -> DimTags:
    """The body over a face in z = 0, as far on both sides."""
    occ.translate([(2, face)], 0, 0, -width / 2)
    extruded = occ.extrude([(2, face)], 0, 0, width)
    return [(dim, tag) for dim, tag in extruded if dim == 3]


def _pockets(occ: Any, rod: Rod, length: float) -> DimTags:
    """Bodies that the section of the shank leaves out on both sides; they run into both eyes."""
    if rod.shank == "H":
        deep = rod.shank_width_mm - 2 * rod.flange_mm
        wide = rod.boss_width_mm + rod.big_end_diameter_mm
        starts = (rod.web_mm / 2, -rod.web_mm / 2 - wide)
        return [(3, occ.addBox(x, 0, -deep / 2, wide, length, deep)) for x in starts]
    if rod.shank == "plain":
        return []
    deep = (rod.shank_width_mm - rod.web_mm) / 2
    found: DimTags = []
    for z in (rod.web_mm / 2, -rod.shank_width_mm / 2):
        big, small = rod.shank_big_mm / 2 - rod.flange_mm, rod.shank_small_mm / 2 - rod.flange_mm
        corners = ((-big, 0.0), (big, 0.0), (small, length), (-small, length))
        points = [occ.addPoint(x, y, z) for x, y in corners]
        lines = [occ.addLine(a, b) for a, b in pairwise([*points, points[0]])]
        face = occ.addPlaneSurface([occ.addCurveLoop(lines)])
        found += [pair for pair in occ.extrude([(2, face)], 0, 0, deep) if pair[0] == 3]
    return found
