"""OCC solids of the web: what its features are made of, added and taken away.

`occ` is `gmsh.model.occ` of the open session.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from cranktopo.design.schema import Scene
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
    Point,
    Rectangle,
    Solid,
)
from cranktopo.throw.web import web_bodies

DimTags = list[tuple[int, int]]


def add_web(occ: Any, scene: Scene) -> DimTags:
    """The web between its two faces, bores and features cut out, as gmsh (dimension, tag) pairs."""
    return add_bodies(occ, web_bodies(scene))


def add_bodies(occ: Any, bodies: Sequence[Body]) -> DimTags:
    """The material that bodies leave, as gmsh (dimension, tag) pairs."""
    web, *more = (add_solid(occ, solid) for body in bodies if body.adds for solid in body.solids())
    material = [web] if not more else list(occ.fuse([web], more)[0])
    tools = [add_solid(occ, solid) for body in bodies if not body.adds for solid in body.solids()]
    if tools:
        material, _ = occ.cut(material, tools)
    return material


def add_solid(occ: Any, solid: Solid) -> tuple[int, int]:
    """One primitive body as a gmsh (dimension, tag) pair."""
    match solid:
        case Cylinder(start, axis, radius):
            return 3, occ.addCylinder(*start, *axis, radius)
        case Box(low, size):
            return 3, occ.addBox(*low, *size)
        case Frustum(floor, mouth):
            return 3, _frustum(occ, floor, mouth)
        case Extrusion(contour, path):
            made = occ.extrude([(2, _Contour(occ).face(contour))], *path)
            return next((dim, tag) for dim, tag in made if dim == 3)


def _frustum(occ: Any, floor: tuple[Point, ...], mouth: tuple[Point, ...]) -> int:
    """A body between two quadrilaterals, from six plane faces."""
    rings = [[occ.addPoint(*point) for point in ring] for ring in (floor, mouth)]
    low, high = ([occ.addLine(a, b) for a, b in pairwise([*ring, ring[0]])] for ring in rings)
    ribs = [occ.addLine(a, b) for a, b in zip(*rings, strict=True)]
    loops = [low, high, *([low[i], ribs[(i + 1) % 4], high[i], ribs[i]] for i in range(4))]
    faces = [occ.addPlaneSurface([occ.addCurveLoop(loop)]) for loop in loops]
    tag: int = occ.addVolume([occ.addSurfaceLoop(faces, sewing=True)])
    return tag


class _Contour:
    """A closed loop of curves whose ends share their points."""

    def __init__(self, occ: Any) -> None:
        self._occ = occ
        self._points: dict[Point, int] = {}

    def face(self, curves: tuple[Any, ...]) -> int:
        """The plane surface inside the loop."""
        if isinstance(curves[0], Rectangle):
            rectangle: Rectangle = curves[0]
            size = rectangle.size_x, rectangle.size_y
            tag: int = self._occ.addRectangle(*rectangle.low, *size, -1, rectangle.corner_radius)
            return tag
        loop = self._occ.addCurveLoop([self._curve(curve) for curve in curves])
        tag = self._occ.addPlaneSurface([loop])
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
