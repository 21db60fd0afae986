"""OCC solids of the web: its outline extruded, less its pockets and bores."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

from cranktopo.scene import Scene
from cranktopo.scene.bevel import bevel_arc
from cranktopo.scene.features import Disc, Feature, Wedge, bores, pockets
from cranktopo.scene.geometry import (
    EllipseWeb,
    EndBevel,
    ObroundWeb,
    ProfileWeb,
    RectangleWeb,
    TaperedWeb,
)
from cranktopo.scene.outline import largest_half_width_mm, tangent_sine, y_range_mm
from cranktopo.scene.profile import profile_flank

DimTags = list[tuple[int, int]]


def add_web(occ: Any, scene: Scene) -> DimTags:
    """The web between its two faces, pockets and bores cut out.

    Args:
        occ: `gmsh.model.occ` of the open session.
        scene: the throw.

    Returns:
        Volumes as gmsh (dimension, tag) pairs.
    """
    start, end = scene.web_z_mm
    prism = occ.extrude([(2, _outline(occ, scene, start))], 0, 0, end - start)
    web = [pair for pair in prism if pair[0] == 3]
    tools = [add_feature(occ, feature, feature.z_mm) for feature in (*bores(scene), *pockets(scene))]
    tools += [_bevel_tool(occ, scene, bevel) for bevel in scene.web.bevel]
    if tools:
        web, _ = occ.cut(web, tools)
    return web


def add_feature(occ: Any, feature: Feature, z_mm: tuple[float, float]) -> tuple[int, int]:
    """The body of a bore or pocket over an axial range, as a gmsh (dimension, tag) pair.

    Args:
        occ: `gmsh.model.occ` of the open session.
        feature: the bore or pocket.
        z_mm: axial range (start, end); a slot with sloped walls keeps its own.
    """
    height = z_mm[1] - z_mm[0]
    if isinstance(feature, Wedge):
        return _wedge(occ, feature)
    if isinstance(feature, Disc):
        return 3, occ.addCylinder(feature.x_mm, feature.y_mm, z_mm[0], 0, 0, height, feature.radius_mm)
    (x0, x1), (y0, y1) = feature.x_range_mm, feature.y_range_mm
    return 3, occ.addBox(x0, y0, z_mm[0], x1 - x0, y1 - y0, height)


def _wedge(occ: Any, wedge: Wedge) -> tuple[int, int]:
    """A frustum between the slot's floor and its opening, from six plane faces."""
    opening = wedge.slope * (wedge.outer_mm - wedge.floor_mm)
    rings = []
    for x, more in ((wedge.floor_mm, 0.0), (wedge.outer_mm, opening)):
        half_y, half_z = wedge.half_length_mm + more, wedge.half_height_mm + more
        corners = ((-1, -1), (1, -1), (1, 1), (-1, 1))
        rings.append(
            [
                occ.addPoint(wedge.side * x, wedge.y_mm + j * half_y, wedge.z_centre_mm + k * half_z)
                for j, k in corners
            ]
        )
    floor, mouth = ([occ.addLine(a, b) for a, b in _around(ring)] for ring in rings)
    ribs = [occ.addLine(a, b) for a, b in zip(*rings, strict=True)]
    loops = [floor, mouth]
    loops += [[floor[i], ribs[(i + 1) % 4], mouth[i], ribs[i]] for i in range(4)]
    faces = [_face(occ, loop) for loop in loops]
    return 3, occ.addVolume([occ.addSurfaceLoop(faces, sewing=True)])


def _around(ring: list[int]) -> list[tuple[int, int]]:
    return list(pairwise([*ring, ring[0]]))


def _bevel_tool(occ: Any, scene: Scene, bevel: EndBevel) -> tuple[int, int]:
    """What a bevel takes off: its arc, continued along the tangent beyond the web, extruded across."""
    arc = bevel_arc(scene.web, scene.throw.radius_mm, bevel)
    face, into = (scene.web_z_mm[0], 1.0) if bevel.face == "journal" else (scene.web_z_mm[1], -1.0)
    wide, far = 2 * largest_half_width_mm(scene.web), arc.chord_mm

    def point(depth: float, reach: float) -> int:
        tag: int = occ.addPoint(-wide, arc.outward * reach, face + into * depth)
        return tag

    slope = math.atan2(arc.end_mm - arc.start_mm, arc.depth_mm)
    slope -= 2 * math.atan(2 * arc.crown_mm / arc.chord_mm)
    start, end = point(0.0, arc.start_mm), point(arc.depth_mm, arc.end_mm)
    beyond = point(arc.depth_mm + far * math.cos(slope), arc.end_mm + far * math.sin(slope))
    top = arc.end_mm + 2 * far
    corners = [end, beyond, point(arc.depth_mm + far * math.cos(slope), top), point(-far, top)]
    corners += [point(-far, arc.start_mm), start]
    straight = math.isinf(arc.radius_mm)
    curved = occ.addLine(start, end) if straight else occ.addCircleArc(start, point(*arc.centre_mm), end)
    section = _face(occ, [curved, *(occ.addLine(a, b) for a, b in pairwise(corners))])
    made = occ.extrude([(2, section)], 2 * wide, 0, 0)
    return next((dim, tag) for dim, tag in made if dim == 3)


def _outline(occ: Any, scene: Scene, z: float) -> int:
    web, radius = scene.web, scene.throw.radius_mm
    if isinstance(web, EllipseWeb):
        return _ellipse(occ, web, radius, z)
    if isinstance(web, RectangleWeb):
        low, high = y_range_mm(web, radius)
        corner = web.corner_radius_mm
        tag: int = occ.addRectangle(-web.width_mm / 2, low, z, web.width_mm, high - low, -1, corner)
        return tag
    if isinstance(web, ProfileWeb):
        return _face(occ, _profile(occ, web, z))
    main, pin = (
        (web.width_mm / 2, web.width_mm / 2)
        if isinstance(web, ObroundWeb)
        else (web.main_radius_mm, web.pin_radius_mm)
    )
    sine = tangent_sine(web, radius) if isinstance(web, TaperedWeb) else 0.0
    return _face(occ, _hull(occ, (main, pin), radius, sine, z))


def _face(occ: Any, curves: list[int]) -> int:
    tag: int = occ.addPlaneSurface([occ.addCurveLoop(curves)])
    return tag


def _ellipse(occ: Any, web: EllipseWeb, radius: float, z: float) -> int:
    """gmsh wants the longer axis first; the local x axis follows it."""
    long, short = web.semi_axis_throw_mm, web.semi_axis_lateral_mm
    axis = [0.0, 1.0, 0.0]
    if short > long:
        long, short, axis = short, long, [1.0, 0.0, 0.0]
    curve = occ.addEllipse(0, radius / 2, z, long, short, -1, 0, 2 * math.pi, [0, 0, 1], axis)
    return _face(occ, [curve])


def _hull(occ: Any, radii: tuple[float, float], radius: float, sine: float, z: float) -> list[int]:
    """Two round ends joined by their outer tangents, counter-clockwise from the right main tangent point."""
    (main, pin), cosine = radii, math.sqrt(1 - sine**2)
    right_main, right_pin, left_pin, left_main = (
        occ.addPoint(side * r * cosine, y + r * sine, z)
        for side, r, y in ((1, main, 0.0), (1, pin, radius), (-1, pin, radius), (-1, main, 0.0))
    )
    top, bottom = occ.addPoint(0, radius + pin, z), occ.addPoint(0, -main, z)
    centre_main, centre_pin = occ.addPoint(0, 0, z), occ.addPoint(0, radius, z)
    return [
        occ.addLine(right_main, right_pin),
        occ.addCircleArc(right_pin, centre_pin, top),
        occ.addCircleArc(top, centre_pin, left_pin),
        occ.addLine(left_pin, left_main),
        occ.addCircleArc(left_main, centre_main, bottom),
        occ.addCircleArc(bottom, centre_main, right_main),
    ]


def _profile(occ: Any, web: ProfileWeb, z: float) -> list[int]:
    """Right flank, end, left flank, end; a flank is one Bezier cubic per station, exactly the spline.

    One B-spline over all stations would be shorter, but the kernel loses 0.3 % of the volume of such a face.
    """
    y, half = web.stations_mm, web.half_widths_mm
    first, last = (0.0, y[0]), (0.0, y[-1])
    corners = {(x, c): occ.addPoint(x, c, z) for x, c in (first, last)}
    for side in (1.0, -1.0):
        for point in zip((side * h for h in half), y, strict=True):
            corners.setdefault(point, occ.addPoint(*point, z))
    right, left = _flank(occ, web, corners, 1.0, z), _flank(occ, web, corners, -1.0, z)
    top = [(half[-1], y[-1]), last, (-half[-1], y[-1])]
    bottom = [(-half[0], y[0]), first, (half[0], y[0])]
    lines = [
        [occ.addLine(corners[a], corners[b]) for a, b in pairwise(end) if a != b] for end in (top, bottom)
    ]
    return right + lines[0] + left[::-1] + lines[1]


def _flank(
    occ: Any, web: ProfileWeb, corners: dict[tuple[float, float], int], side: float, z: float
) -> list[int]:
    flank = profile_flank(web)
    thirds = flank.slopes / 3
    curves = []
    for i, length in enumerate(flank.lengths_mm):
        (x0, y0), (x1, y1) = flank.points_mm[i : i + 2]
        (dx0, dy0), (dx1, dy1) = thirds[i : i + 2] * length
        leave = occ.addPoint(side * (x0 + dx0), y0 + dy0, z)
        arrive = occ.addPoint(side * (x1 - dx1), y1 - dy1, z)
        curves.append(occ.addBezier([corners[side * x0, y0], leave, arrive, corners[side * x1, y1]]))
    return curves
