"""OCC solids of half throw and full throw, each checked, and of the primitives they are made of.

`occ` is `gmsh.model.occ` of the open session. The rounding of an outlet is the kernel's own fillet, made on a
plain piece of the cylinder: what that piece loses is the tool, whatever else the throw has there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, solver_error
from cranktopo.bodies.volume import half_throw_volume_mm3, throw_volume_mm3
from cranktopo.design.checks.scene import check_solid
from cranktopo.design.halves import drilled_alike, halves, mirror_image, require_equal_halves
from cranktopo.design.schema import Scene
from cranktopo.throw.drilling.table import drill_bores
from cranktopo.throw.feature import Body
from cranktopo.throw.journal import Journal
from cranktopo.throw.primitives import (
    Arc,
    Bezier,
    Box,
    Cylinder,
    EllipseCurve,
    Extrusion,
    Frustum,
    LineSegment,
    Loft,
    Point,
    Rectangle,
    Revolution,
    RoundedOutlet,
    Solid,
)
from cranktopo.throw.web import web_bodies

DimTags = list[tuple[int, int]]
_PIECE = 2.5
"""Radius of the piece of a cylinder over that of the outlet with its rounding."""
_ON_EDGE_MM = 1e-3
_ROUND_MM = 1e-9
"""Sides of a rounded rectangle that are shorter are none."""


def add_solid(occ: Any, solid: Solid) -> DimTags:
    """Add one primitive body; return its gmsh (dimension, tag) pairs."""
    match solid:
        case Cylinder(start, axis, radius):
            return [(3, occ.addCylinder(*start, *axis, radius))]
        case Box(low, size):
            return [(3, occ.addBox(*low, *size))]
        case Frustum(floor, mouth, corner_radii):
            return [(3, _frustum(occ, floor, mouth) if not any(corner_radii) else _rounded(occ, solid))]
        case Extrusion(contour, path):
            made = occ.extrude([(2, _Contour(occ).face(contour))], *path)
            return [(dim, tag) for dim, tag in made if dim == 3]
        case Revolution(contour, on_axis):
            section = (2, _Contour(occ).face(contour))
            made = occ.revolve([section], *on_axis, 0, 0, 1, 2 * math.pi)
            occ.remove([section], recursive=True)
            return [(dim, tag) for dim, tag in made if dim == 3]
        case Loft(near, far):
            loops = [_Contour(occ).loop(contour) for contour in (near, far)]
            made = occ.addThruSections(loops, -1, True, True)
            return [(dim, tag) for dim, tag in made if dim == 3]
        case RoundedOutlet():
            return _rounding(occ, solid)


def _rounding(occ: Any, outlet: RoundedOutlet) -> DimTags:
    piece = _piece(occ, outlet)
    bored, _ = occ.cut(occ.copy(piece), add_solid(occ, outlet.hole))
    occ.synchronize()  # curves can be asked for their points only then
    edges = _edges(bored, outlet)
    if not edges:
        raise solver_error(
            f"{outlet.key}: the CAD kernel finds no edge at the outlet on {outlet.on}.",
            "Change diameter_mm slightly.",
        )
    rounded = occ.fillet([tag for _, tag in bored], edges, [outlet.rounding_mm])
    return list(occ.cut(piece, rounded)[0])


def _piece(occ: Any, outlet: RoundedOutlet) -> DimTags:
    wide = _PIECE * (outlet.hole.radius + outlet.rounding_mm)
    outward, point = np.array(outlet.outward), np.array(outlet.at)
    deep = min(2 * wide, outlet.surface_mm)
    low = point[2] - 4 * wide
    journal = 3, occ.addCylinder(0, outlet.y_mm, low, 0, 0, 8 * wide, outlet.surface_mm)
    around = 3, occ.addCylinder(*(point - deep * outward), *((deep + 2 * wide) * outward), wide)
    return list(occ.intersect([journal], [around])[0])


def _edges(body: DimTags, outlet: RoundedOutlet) -> list[int]:
    import gmsh

    start, along = np.array(outlet.hole.start), np.array(outlet.outward)
    found = []
    for _, face in gmsh.model.getBoundary(body, oriented=False):
        for _, curve in gmsh.model.getBoundary([(2, face)], oriented=False):
            (low,), (high,) = gmsh.model.getParametrizationBounds(1, curve)
            at = gmsh.model.getValue(1, curve, np.linspace(low, high, 7)[1:-1]).reshape(-1, 3)
            away = np.linalg.norm(np.cross(at - start, along), axis=1) - outlet.hole.radius
            deep = np.hypot(at[:, 0], at[:, 1] - outlet.y_mm) - outlet.surface_mm
            if max(np.abs(away).max(), np.abs(deep).max()) < _ON_EDGE_MM:
                found.append(int(curve))
    return sorted(set(found))


def _frustum(occ: Any, floor: tuple[Point, ...], mouth: tuple[Point, ...]) -> int:
    rings = [[occ.addPoint(*point) for point in ring] for ring in (floor, mouth)]
    low, high = ([occ.addLine(a, b) for a, b in pairwise([*ring, ring[0]])] for ring in rings)
    ribs = [occ.addLine(a, b) for a, b in zip(*rings, strict=True)]
    loops = [low, high, *([low[i], ribs[(i + 1) % 4], high[i], ribs[i]] for i in range(4))]
    faces = [occ.addPlaneSurface([occ.addCurveLoop(loop)]) for loop in loops]
    tag: int = occ.addVolume([occ.addSurfaceLoop(faces, sewing=True)])
    return tag


def _rounded(occ: Any, frustum: Frustum) -> int:
    """Add planes and quarters of cones between two rectangles with round corners; round the floor's edge."""
    rings = zip((frustum.floor, frustum.mouth), frustum.corner_radii, strict=True)
    loops = [_rounded_loop(occ, np.array(ring), radius) for ring, radius in rings]
    ((_, tag),) = (pair for pair in occ.addThruSections(loops, -1, True, True) if pair[0] == 3)
    if not frustum.floor_radius:
        return int(tag)
    ((_, rounded),) = occ.fillet([tag], _floor_edges(occ, int(tag), frustum.floor), [frustum.floor_radius])
    return int(rounded)


def _floor_edges(occ: Any, tag: int, floor: tuple[Point, ...]) -> list[int]:
    """Return the edges of a solid that lie in the plane of its floor."""
    import gmsh

    occ.synchronize()  # curves can be asked for their boxes only then
    corner, one, other = (np.array(point) for point in floor[:3])
    normal = np.cross(one - corner, other - corner)
    edges = gmsh.model.getBoundary([(3, tag)], recursive=False, oriented=False)
    curves = {curve for face in edges for curve in gmsh.model.getBoundary([face], oriented=False)}
    found = []
    for _, curve in sorted(curves):
        (low,), (high,) = gmsh.model.getParametrizationBounds(1, curve)
        at = gmsh.model.getValue(1, curve, np.linspace(low, high, 3)).reshape(-1, 3)
        away = np.abs((at - corner) @ normal) / np.linalg.norm(normal)
        found += [int(curve)] if away.max() < _ON_EDGE_MM else []
    return found


def _rounded_loop(occ: Any, ring: Array, radius: float) -> int:
    before, after = (np.roll(ring, shift, axis=0) - ring for shift in (1, -1))
    start, end = (ring + radius * way / np.linalg.norm(way, axis=1)[:, None] for way in (before, after))
    points = [[occ.addPoint(*p) for p in arc] for arc in zip(start, start + end - ring, end, strict=True)]
    straight = np.linalg.norm(np.roll(start, -1, axis=0) - end, axis=1) > _ROUND_MM
    curves = []
    for k, arc in enumerate(points):
        curves.append(occ.addCircleArc(*arc))
        if straight[k]:
            curves.append(occ.addLine(arc[2], points[(k + 1) % 4][0]))
    loop: int = occ.addCurveLoop(curves)
    return loop


class _Contour:
    def __init__(self, occ: Any) -> None:
        self._occ = occ
        self._points: dict[Point, int] = {}

    def face(self, curves: tuple[Any, ...]) -> int:
        """Return the plane surface inside the loop."""
        if isinstance(curves[0], Rectangle):
            rectangle: Rectangle = curves[0]
            size = rectangle.size_x, rectangle.size_y
            tag: int = self._occ.addRectangle(*rectangle.low, *size, -1, rectangle.corner_radius)
            return tag
        tag = self._occ.addPlaneSurface([self.loop(curves)])
        return tag

    def loop(self, curves: tuple[Any, ...]) -> int:
        """Return the loop of curves, each of which begins where the last ends."""
        tag: int = self._occ.addCurveLoop([self._curve(curve) for curve in curves])
        return tag

    def _curve(self, curve: LineSegment | Arc | Bezier | EllipseCurve) -> int:
        tag: int
        match curve:
            case LineSegment(start, end):
                tag = self._occ.addLine(self._point(start), self._point(end))
            case Arc(start, centre, end):
                tag = self._occ.addCircleArc(self._point(start), self._point(centre), self._point(end))
            case Bezier(points):
                tag = self._occ.addBezier([self._point(point) for point in points])
            case EllipseCurve(centre, half_x, half_y):
                # gmsh wants the longer axis first; the local x axis follows it.
                axis = [1.0, 0.0, 0.0] if half_x > half_y else [0.0, 1.0, 0.0]
                long, short = max(half_x, half_y), min(half_x, half_y)
                tag = self._occ.addEllipse(*centre, long, short, -1, 0, 2 * math.pi, [0, 0, 1], axis)
        return tag

    def _point(self, point: Point) -> int:
        if point not in self._points:
            self._points[point] = self._occ.addPoint(*point)
        return self._points[point]


VOLUME_TOLERANCE = 2e-5
"""Relative difference between the CAD kernel's volume and the closed form that is let through.

The kernel integrates over faces that end in intersection curves, such as a crowned bevel through a spline
outline, to about 5e-6 of the half throw; the smallest pocket is 1e-4 of it.
"""


@dataclass(frozen=True)
class SolidProperties:
    """Mass properties of a body of unit density; inertia is the integral of x2 + y2 about the crank axis."""

    volume_mm3: float
    centre_mm: tuple[float, float, float]
    inertia_z_mm5: float


def add_half_throw(occ: Any, scene: Scene) -> DimTags:
    """Return the half throw, z from the mid-main-journal plane to the mid-pin plane, as one checked body.

    A bore runs through its journal and the web and ends at the web's far face.
    """
    require_equal_halves(scene)
    return _add_half(occ, scene)


def _add_half(occ: Any, scene: Scene) -> DimTags:
    check_solid(scene)
    expected = half_throw_volume_mm3(scene)
    throw, (start, end) = scene.throw, scene.web_z_mm
    tools = add_drillings(occ, scene)
    main = _add_journal(occ, scene, throw.main_journal, 0.0, (0.0, start), 1) if start else []
    pin = _add_journal(occ, scene, throw.crankpin, throw.radius_mm, (end, scene.pitch_mm / 2), -1)
    body, _ = occ.fuse(add_web(occ, scene), main + pin)
    body = cut(occ, body, tools)
    check_body(occ, body, expected, "half throw")
    return list(body)


def add_full_throw(occ: Any, scene: Scene) -> DimTags:
    """Return the throw between its two mid-main-journal planes as one checked body.

    The second half is a half throw mirrored in x and turned half a revolution about the throw direction:
    gmsh's own mirror approximates every face by a spline and is 0.2 % off in volume. What one half alone is
    drilled with may reach into the other, and comes last.
    """
    first, second = halves(scene)
    half, other = _add_half(occ, drilled_alike(first)), _add_half(occ, mirror_image(drilled_alike(second)))
    tools, more = add_drillings(occ, first, alone=True), add_drillings(occ, mirror_image(second), alone=True)
    occ.rotate([*other, *more], 0, 0, scene.pitch_mm / 2, 0, 1, 0, math.pi)
    body, _ = occ.fuse(half, other)
    body = cut(occ, body, [*tools, *more])
    check_body(occ, body, throw_volume_mm3(scene), "full throw")
    return list(body)


def check_body(occ: Any, body: DimTags, expected_mm3: float, name: str) -> None:
    """Check that the kernel gave one body, its volume by the closed form, else raise CranktopoError."""
    solids = [pair for pair in body if pair[0] == 3]
    if len(solids) != 1:
        raise CranktopoError(
            f"{name}: falls apart into {len(solids)} bodies.",
            hint="A pocket cuts the web through, or the outline does not join the journals.",
        )
    volume = occ.getMass(*solids[0])
    if abs(volume - expected_mm3) > VOLUME_TOLERANCE * expected_mm3:
        raise solver_error(
            f"{name}: the CAD kernel built {volume:.2f} mm3, the closed form is {expected_mm3:.2f} mm3.",
            "Features touch or overlap in a way it cannot resolve: move them apart by 0.1 mm.",
        )


def solid_properties(occ: Any, body: DimTags) -> SolidProperties:
    """Return volume, centre and inertia about the crank axis of one body, from the kernel's exact faces."""
    (tag,) = [tag for dim, tag in body if dim == 3]
    volume = occ.getMass(3, tag)
    x, y, z = occ.getCenterOfMass(3, tag)
    about_centre = occ.getMatrixOfInertia(3, tag)[8]
    return SolidProperties(volume, (x, y, z), about_centre + volume * (x**2 + y**2))


def add_web(occ: Any, scene: Scene) -> DimTags:
    """Add the web between its two faces, bores and features cut out; return (dimension, tag) pairs."""
    return add_bodies(occ, web_bodies(scene))


def add_bodies(occ: Any, bodies: Sequence[Body]) -> DimTags:
    """Add the material that bodies leave; return (dimension, tag) pairs."""
    web, *more = _solids(occ, [body for body in bodies if body.adds])
    material = [web] if not more else list(occ.fuse([web], more)[0])
    return cut(occ, material, _solids(occ, [body for body in bodies if not body.adds]))


def cut(occ: Any, material: DimTags, tools: DimTags) -> DimTags:
    """Take solids away from material; the material itself where there are none."""
    return list(occ.cut(material, tools)[0]) if tools else material


def add_drillings(occ: Any, scene: Scene, *, alone: bool = False) -> DimTags:
    """Add the tools that drill the half throw, or `alone` those without a mirror image in the other half."""
    return _solids(occ, [bore for bore in drill_bores(scene) if bore.alone or not alone])


def _solids(occ: Any, bodies: Sequence[Body]) -> DimTags:
    return [pair for body in bodies for solid in body.solids() for pair in add_solid(occ, solid)]


def _add_journal(
    occ: Any, scene: Scene, journal: Journal, y: float, z_mm: tuple[float, float], toward: int
) -> DimTags:
    """Return the journal at y from its mid-plane to the web face, its upper end if `toward` is +1."""
    face = z_mm[1] if toward > 0 else z_mm[0]
    far = z_mm[0] if toward > 0 else z_mm[1]
    if journal.fillet_mm:
        body = [_revolve(occ, journal, y, far, face, toward)]
    else:
        body = [(3, occ.addCylinder(0, y, z_mm[0], 0, 0, z_mm[1] - z_mm[0], journal.radius_mm))]
    tools = _under_fillet(occ, scene, journal, y, face, toward) if journal.fillet_mm else []
    if journal.bore_diameter_mm:
        length = z_mm[1] - z_mm[0]
        tools.append((3, occ.addCylinder(0, y, z_mm[0], 0, 0, length, journal.bore_radius_mm)))
    return cut(occ, body, tools)


def _revolve(occ: Any, journal: Journal, y: float, far: float, face: float, toward: int) -> tuple[int, int]:
    radius, fillet = journal.radius_mm, journal.fillet
    near, centre_radius = face - toward * fillet.reach_mm, radius + fillet.radial_mm
    reach = centre_radius - fillet.half_mouth_mm
    corners = (0.0, far), (radius, far), (radius, near), (reach, face), (0.0, face), (centre_radius, near)
    axis_far, rim, top, foot, axis_face, centre = (occ.addPoint(x, y, z) for x, z in corners)
    longer = foot if fillet.axial_mm > fillet.radial_mm else top  # the kernel wants the major axis
    curves = [
        occ.addLine(axis_far, rim),
        occ.addLine(rim, top),
        occ.addCircleArc(top, centre, foot) if fillet.round else occ.addEllipseArc(top, centre, longer, foot),
        occ.addLine(foot, axis_face),
        occ.addLine(axis_face, axis_far),
    ]
    section = occ.addPlaneSurface([occ.addCurveLoop(curves)])
    made = occ.revolve([(2, section)], 0, y, 0, 0, 0, 1, 2 * math.pi)
    occ.remove([(2, section)], recursive=True)
    return next((dim, tag) for dim, tag in made if dim == 3)


def _under_fillet(occ: Any, scene: Scene, journal: Journal, y: float, face: float, toward: int) -> DimTags:
    """Columns over pockets and bores that open under the fillet ring, which would end in a knife edge."""
    reach = journal.radius_mm + journal.fillet_mm
    along = journal.fillet.reach_mm
    z = (face - along, face) if toward > 0 else (face, face + along)
    tools: DimTags = []
    cuts = [body for body in web_bodies(scene) if not body.adds and face in body.z_mm]
    for body in cuts if journal.bore_radius_mm < reach else ():
        if 0 < body.distance_mm(y, face) < reach:
            column = [pair for solid in body.continued(z) for pair in add_solid(occ, solid)]
            if column:  # a recess has none: the fillet goes on in it
                core = [(3, occ.addCylinder(0, y, z[0], 0, 0, z[1] - z[0], journal.radius_mm))]
                tools += occ.cut(column, core)[0]
    return tools
