"""OCC solids of the primitives that bodies are made of, and what they leave of each other.

`occ` is `gmsh.model.occ` of the open session. The rounding of an outlet is the kernel's own fillet, made on a
plain piece of the cylinder: what that piece loses is the tool, whatever else the throw has there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import solver_error
from cranktopo.base.frames import about_z_deg
from cranktopo.bodies.solid.round_hole import ROUND_MM, add_round_hole, is_round, straight_sides_mm
from cranktopo.bodies.solid.seams import has_splines, seam_turned, seams_closed
from cranktopo.numerics.gmsh_session import DimTags, with_option
from cranktopo.throw.feature import Body
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

_PIECE = 2.5
"""Radius of the piece of a cylinder over that of the outlet with its rounding."""
_TURNS = (0.0, 0.7, 1.4)
"""Of the seam of a hole whose rounding the kernel leaves open, radians."""
_ON_EDGE_MM = 1e-3
_UNIFY = "Geometry.OCCUnionUnify"


def add_solid(occ: Any, solid: Solid, *, in_arcs: bool = False) -> DimTags:
    """Add one primitive body; return its gmsh (dimension, tag) pairs.

    Args:
        in_arcs: make an ellipse of two arcs, which meet on its axis in x, where its seam would be in the way.
    """
    match solid:
        case Cylinder(start, axis, radius):
            body = [(3, occ.addCylinder(*start, *axis, radius))]
            return seam_turned(occ, body, solid) if solid.seam else body
        case Box(low, size):
            return [(3, occ.addBox(*low, *size))]
        case Frustum(floor, mouth, corner_radii):
            tag = _rounded(occ, solid) if any(corner_radii) else _frustum(occ, floor, mouth)
            return [(3, _with_round_floor(occ, tag, solid) if solid.floor_radius else tag)]
        case Extrusion(contour, path):
            solid_tags = occ.extrude([(2, _Contour(occ, in_arcs=in_arcs).face(contour))], *path)
            return [(dim, tag) for dim, tag in solid_tags if dim == 3]
        case Revolution(contour, on_axis):
            section = (2, _Contour(occ).face(contour))
            solid_tags = occ.revolve([section], *on_axis, 0, 0, 1, 2 * math.pi)
            occ.remove([section], recursive=True)
            return [(dim, tag) for dim, tag in solid_tags if dim == 3]
        case Loft(near, far):
            loops = [_Contour(occ).loop(contour) for contour in (near, far)]
            solid_tags = occ.addThruSections(loops, -1, True, True)
            return [(dim, tag) for dim, tag in solid_tags if dim == 3]
        case RoundedOutlet():
            return _rounding(occ, solid)


def _rounding(occ: Any, outlet: RoundedOutlet) -> DimTags:
    piece = _piece(occ, outlet)
    rounded: DimTags = []
    for turn in _TURNS:
        occ.remove(rounded, recursive=True)
        rounded = _rounded_piece(occ, piece, outlet, turn)
        if seams_closed(occ, rounded):
            break
    return list(occ.cut(piece, rounded)[0])


def _rounded_piece(occ: Any, piece: DimTags, outlet: RoundedOutlet, turn: float) -> DimTags:
    """Return a copy of a piece with the hole and its rounding; the seam of the hole turned by radians."""
    hole = add_solid(occ, outlet.hole)
    if turn:
        occ.rotate(hole, *outlet.hole.start, *outlet.hole.axis, turn)
    bored, _ = occ.cut(occ.copy(piece), hole)
    occ.synchronize()  # curves can be asked for their points only then
    edges = outlet_edges(bored, outlet)
    if not edges:
        raise solver_error(
            f"{outlet.key}: the CAD kernel finds no edge at the outlet on {outlet.on}.",
            "Change diameter_mm slightly.",
        )
    return list(occ.fillet([tag for _, tag in bored], edges, [outlet.rounding_mm]))


def _piece(occ: Any, outlet: RoundedOutlet) -> DimTags:
    wide = _PIECE * (outlet.hole.radius + outlet.rounding_mm)
    outward, point = np.array(outlet.outward), np.array(outlet.at)
    deep = min(2 * wide, outlet.surface_mm)
    low = point[2] - 4 * wide
    journal = 3, occ.addCylinder(0, outlet.y_mm, low, 0, 0, 8 * wide, outlet.surface_mm)
    around = 3, occ.addCylinder(*(point - deep * outward), *((deep + 2 * wide) * outward), wide)
    return list(occ.intersect([journal], [around])[0])


def outlet_edges(body: DimTags, outlet: RoundedOutlet) -> list[int]:
    """Return the curves of a synchronized body in which an outlet's hole meets its cylinder."""
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
    """Add planes and quarters of cones between two rectangles with round corners."""
    rings = zip((frustum.floor, frustum.mouth), frustum.corner_radii, strict=True)
    loops = [_rounded_loop(occ, np.array(ring), radius) for ring, radius in rings]
    ((_, tag),) = (pair for pair in occ.addThruSections(loops, -1, True, True) if pair[0] == 3)
    return int(tag)


def _with_round_floor(occ: Any, tag: int, frustum: Frustum) -> int:
    """Round the edge of the floor; without round corners that along its first and its third side alone.

    Of a round hole the kernel now and then makes a quarter of the torus a spline: its section is turned then.
    """
    edges = _floor_edges(occ, tag, frustum.floor)
    if not any(frustum.corner_radii):
        edges = [edge for edge in edges if _along(edge, frustum.floor)]
    rounded = occ.fillet([tag], edges, [frustum.floor_radius])
    if is_round(frustum) and has_splines(occ, rounded):
        occ.remove(rounded, recursive=True)
        return add_round_hole(occ, frustum)
    return int(rounded[0][1])


def _along(curve: int, floor: tuple[Point, ...]) -> bool:
    """Tell whether a straight edge runs along the first side of a floor."""
    import gmsh

    (low,), (high,) = gmsh.model.getParametrizationBounds(1, curve)
    start, end = gmsh.model.getValue(1, curve, np.array([low, high])).reshape(-1, 3)
    side = np.array(floor[1]) - np.array(floor[0])
    return bool(np.linalg.norm(np.cross(end - start, side)) < _ON_EDGE_MM * np.linalg.norm(side))


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


def _rectangle(occ: Any, rectangle: Rectangle) -> int:
    """Add the edge of a rectangle; the kernel's own refuses corners that leave no straight side."""
    size = np.array([rectangle.size_x, rectangle.size_y, 0.0])
    ring = np.array(rectangle.low) + np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]) * size
    if rectangle.corner_radius:
        return _rounded_loop(occ, ring, rectangle.corner_radius)
    points = [occ.addPoint(*corner) for corner in ring]
    loop: int = occ.addCurveLoop([occ.addLine(a, b) for a, b in pairwise([*points, points[0]])])
    return loop


def _rounded_loop(occ: Any, ring: Array, radius: float) -> int:
    before, after = (np.roll(ring, shift, axis=0) - ring for shift in (1, -1))
    start, end = (ring + radius * way / np.linalg.norm(way, axis=1)[:, None] for way in (before, after))
    points = [[occ.addPoint(*p) for p in arc] for arc in zip(start, start + end - ring, end, strict=True)]
    straight = straight_sides_mm(ring, radius) > ROUND_MM
    curves = []
    for k, arc in enumerate(points):
        curves.append(occ.addCircleArc(*arc))
        if straight[k]:
            curves.append(occ.addLine(arc[2], points[(k + 1) % 4][0]))
    loop: int = occ.addCurveLoop(curves)
    return loop


class _Contour:
    def __init__(self, occ: Any, *, in_arcs: bool = False) -> None:
        self._occ, self._in_arcs = occ, in_arcs
        self._points: dict[Point, int] = {}

    def face(self, curves: tuple[Any, ...]) -> int:
        """Return the plane surface inside the loop."""
        tag: int = self._occ.addPlaneSurface([self.loop(curves)])
        return tag

    def loop(self, curves: tuple[Any, ...]) -> int:
        """Return the loop of curves, each of which begins where the last ends."""
        if isinstance(curves[0], Rectangle):
            return _rectangle(self._occ, curves[0])
        tag: int = self._occ.addCurveLoop([tag for curve in curves for tag in self._curve(curve)])
        return tag

    def _curve(self, curve: LineSegment | Arc | Bezier | EllipseCurve) -> list[int]:
        match curve:
            case LineSegment(start, end):
                return [self._occ.addLine(self._point(start), self._point(end))]
            case Arc(start, centre, end):
                return [self._occ.addCircleArc(self._point(start), self._point(centre), self._point(end))]
            case Bezier(points):
                return [self._occ.addBezier([self._point(point) for point in points])]
            case EllipseCurve():
                return self._ellipse(curve)

    def _ellipse(self, ellipse: EllipseCurve) -> list[int]:
        """Add an ellipse; gmsh wants the longer axis first, which angles are counted from."""
        half_x, half_y = ellipse.half_x, ellipse.half_y
        axis = [1.0, 0.0, 0.0] if half_x > half_y else [0.0, 1.0, 0.0]
        sizes = *ellipse.centre, max(half_x, half_y), min(half_x, half_y), -1
        start = math.pi / 2 if self._in_arcs and half_x <= half_y else 0.0
        turns = (0, 0.5, 1) if self._in_arcs else (0, 1)
        ends = [start + 2 * math.pi * turn for turn in turns]
        return [self._occ.addEllipse(*sizes, low, high, [0, 0, 1], axis) for low, high in pairwise(ends)]

    def _point(self, point: Point) -> int:
        if point not in self._points:
            self._points[point] = self._occ.addPoint(*point)
        return self._points[point]


def add_bodies(occ: Any, bodies: Sequence[Body], *, in_arcs: bool = False) -> DimTags:
    """Add the material that bodies leave; return (dimension, tag) pairs. `in_arcs` as of `add_solid`."""
    web, *more = add_all(occ, [body for body in bodies if body.adds], in_arcs=in_arcs)
    material = [web] if not more else list(occ.fuse([web], more)[0])
    return cut(occ, material, add_all(occ, [body for body in bodies if not body.adds]))


def cut(occ: Any, material: DimTags, tools: DimTags) -> DimTags:
    """Take solids away from material; the material itself where there are none."""
    return list(occ.cut(material, tools)[0]) if tools else material


def turned(occ: Any, bodies: DimTags, angle_deg: float) -> DimTags:
    """Turn bodies, which may be none, about the crank axis in the sense of rotation; return them."""
    if bodies and angle_deg:
        occ.rotate(bodies, 0, 0, 0, 0, 0, 1, math.radians(about_z_deg(angle_deg)))
    return bodies


def turned_half(occ: Any, bodies: DimTags, pitch_mm: float) -> DimTags:
    """Turn bodies of the second half of a throw, in its own frame, into that of the throw; return them."""
    if bodies:
        occ.rotate(bodies, 0, 0, pitch_mm / 2, 0, 1, 0, math.pi)
    return bodies


def fused(occ: Any, bodies: Sequence[DimTags], *, one_face: bool = True) -> DimTags:
    """Return the union of bodies.

    Args:
        one_face: make one face of those that go on in each other. Cylinders whose seams lie at different
            angles, as of throws that are turned, make one with a seam in steps, which the kernel may not cut
            a hole across nor gmsh mesh.
    """
    first, *more = bodies
    if not more:
        return first
    with with_option(_UNIFY, one_face):
        return list(occ.fuse(first, [pair for body in more for pair in body])[0])


def add_all(occ: Any, bodies: Sequence[Body], *, in_arcs: bool = False) -> DimTags:
    """Add the exact solids of bodies, whether material or tools; `in_arcs` as of `add_solid`."""
    solids = [solid for body in bodies for solid in body.solids()]
    return [pair for solid in solids for pair in add_solid(occ, solid, in_arcs=in_arcs)]
