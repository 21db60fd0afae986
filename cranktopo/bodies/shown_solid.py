"""The half throw in the boolean engine, for a picture that follows a drag: in milliseconds, not for export.

Curves are chains of chords; the CAD kernel, which is exact, takes a second and makes every file.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from manifold3d import CrossSection, FillRule, Manifold

from cranktopo.base.arrays import Array
from cranktopo.base.spans import polygon_area
from cranktopo.bodies.prisms import drillings
from cranktopo.design.schema import Scene
from cranktopo.throw.feature import Body
from cranktopo.throw.journal import Journal
from cranktopo.throw.primitives import (
    Arc,
    Bezier,
    Box,
    Curve,
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

_AROUND = 72
"""Chords of a full circle: off by a thousandth of its radius."""
_AROUND_DRILLING, _MOST_CHORDS = 36, 32
_FILLET_STEPS = 8


def display_half(scene: Scene) -> Manifold:
    """Return the half throw with fillets, bores and drillings, z from the mid-main-journal plane on."""
    throw, (start, end) = scene.throw, scene.web_z_mm
    bodies = web_bodies(scene)
    web = _joined(bodies, adds=True) - _joined(bodies, adds=False)
    main = _journal(scene, throw.main_journal, 0.0, (0.0, start), toward=1)
    pin = _journal(scene, throw.crankpin, throw.radius_mm, (end, scene.pitch_mm / 2), toward=-1)
    whole = web + main + pin
    return whole - drillings(scene, _AROUND_DRILLING) if throw.drilling else whole


def _joined(bodies: Sequence[Body], *, adds: bool) -> Manifold:
    solids = [_solid(solid) for body in bodies if body.adds == adds for solid in body.solids()]
    return sum(solids, Manifold())


def _solid(solid: Solid) -> Manifold:
    match solid:
        case Cylinder(start, axis, radius):
            height = float(np.linalg.norm(axis))
            upright = Manifold.cylinder(height, radius, radius, _AROUND)
            return upright.transform(np.column_stack([_turned_to(np.array(axis) / height), start]))
        case Box(low, size):
            return Manifold.cube(size).translate(low)
        case Frustum(floor, mouth, radii):
            rings = [_ring(np.array(ring), r) for ring, r in zip((floor, mouth), radii, strict=True)]
            return Manifold.hull_points(np.concatenate(rings))
        case Extrusion(contour, path):
            return _swept(np.concatenate([_points(curve) for curve in _onward(contour)]), np.array(path))
        case _:
            return Manifold()  # roundings of outlets come with the drillings


def _turned_to(axis: Array) -> Array:
    """Return unit vectors as columns, the last of them the axis."""
    aside = np.eye(3)[int(np.argmin(np.abs(axis)))]
    one = np.cross(aside, axis)
    one /= np.linalg.norm(one)
    return np.column_stack([one, np.cross(axis, one), axis])


def _swept(contour: Array, path: Array) -> Manifold:
    """Return the prism of a flat contour (n, 3) along a vector out of its plane."""
    corners = contour - contour[0]
    normal = np.cross(corners, np.roll(corners, -1, axis=0)).sum(axis=0)
    normal *= np.sign(normal @ path) / np.linalg.norm(normal)
    frame, height = _turned_to(normal), float(normal @ path)
    flat = corners @ frame[:, :2]
    prism = CrossSection([flat], FillRule.NonZero if polygon_area(flat) > 0 else FillRule.Negative).extrude(
        height
    )
    return prism.transform(np.column_stack([frame[:, :2], path / height, contour[0]]))


def _onward(contour: Sequence[Curve]) -> Iterator[Curve]:
    """Yield the edges of a contour, each from where the last one ends; both flanks are listed upwards."""
    at = None
    for curve in contour:
        ends = _ends(curve)
        if at is not None and ends and math.dist(ends[1], at) < math.dist(ends[0], at):
            curve, ends = _reversed(curve), ends[::-1]
        at = ends[1] if ends else None
        yield curve


def _ends(curve: Curve) -> tuple[Point, Point] | None:
    """Return where an edge begins and ends; None of a closed one."""
    match curve:
        case LineSegment(start, end) | Arc(start, _, end):
            return start, end
        case Bezier(points):
            return points[0], points[-1]
    return None


def _reversed(curve: Curve) -> Curve:
    match curve:
        case LineSegment(start, end):
            return LineSegment(end, start)
        case Arc(start, centre, end):
            return Arc(end, centre, start)
        case Bezier(points):
            return Bezier(points[::-1])
    return curve


def _points(curve: Curve) -> Array:
    """Return the points of a curve, (n, 3), without its last one."""
    match curve:
        case LineSegment(start, _):
            return np.array([start])
        case Arc(start, centre, end):
            return _arc(np.array(start), np.array(centre), np.array(end))
        case Bezier(points):
            t = np.linspace(0, 1, _chords(np.array(points)) + 1)[:-1, None]
            order = len(points) - 1
            weights = [math.comb(order, k) * t**k * (1 - t) ** (order - k) for k in range(order + 1)]
            return np.asarray(sum(w * np.array(p) for w, p in zip(weights, points, strict=True)))
        case EllipseCurve(centre, half_x, half_y):
            turn = np.linspace(0, 2 * np.pi, _AROUND, endpoint=False)
            around = np.stack([half_x * np.cos(turn), half_y * np.sin(turn), 0 * turn], axis=1)
            return around + np.array(centre)
        case Rectangle(low, size_x, size_y, radius):
            corners = np.array(low) + np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]) * [
                size_x,
                size_y,
                0,
            ]
            return _ring(corners, radius)


def _chords(corners: Array) -> int:
    """Return the chords of a curve that turns as its control polygon: as many as arcs have for the turn."""
    ways = np.diff(corners, axis=0)
    ways = ways[ways.any(axis=1)]
    sines = np.linalg.norm(np.cross(ways[:-1], ways[1:]), axis=1)
    turn = float(np.arctan2(sines, (ways[:-1] * ways[1:]).sum(axis=1)).sum())
    return min(max(math.ceil(_AROUND * turn / (2 * np.pi)), 2), _MOST_CHORDS)


def _arc(start: Array, centre: Array, end: Array) -> Array:
    """Return points of the arc of less than half a turn, its end left out."""
    one, other = start - centre, end - centre
    angle = math.acos(float(np.clip(one @ other / np.linalg.norm(one) / np.linalg.norm(other), -1, 1)))
    across = other - one * (one @ other) / (one @ one)
    across *= np.linalg.norm(one) / max(float(np.linalg.norm(across)), 1e-12)
    steps = max(2, math.ceil(_AROUND * angle / (2 * np.pi)))
    turn = np.linspace(0, angle, steps + 1)[:-1, None]
    return np.asarray(centre + np.cos(turn) * one + np.sin(turn) * across)


def _ring(corners: Array, radius: float) -> Array:
    """Return a quadrilateral (4, 3) with round corners as points."""
    if not radius:
        return corners
    found = []
    for here, before, after in zip(corners, np.roll(corners, 1, 0), np.roll(corners, -1, 0), strict=True):
        start, end = (here + radius * (way - here) / np.linalg.norm(way - here) for way in (before, after))
        found += [_arc(start, start + end - here, end), end[None]]
    return np.concatenate(found)


def _journal(scene: Scene, journal: Journal, y: float, z_mm: tuple[float, float], toward: int) -> Manifold:
    """Return the journal at y with its fillet and bore, its web at the upper end if `toward` is +1."""
    length, fillet, radius = z_mm[1] - z_mm[0], journal.fillet, journal.radius_mm
    turn = np.linspace(0, np.pi / 2, _FILLET_STEPS)
    arc = np.column_stack(
        [
            radius + fillet.radial_mm * (1 - np.cos(turn)),
            length - fillet.axial_mm * (1 - np.sin(turn)),
        ]
    )
    outside = [[radius, 0]], arc if journal.fillet_mm else [[radius, length]]
    bore = journal.bore_radius_mm
    section = np.concatenate([[[bore, 0]], *outside, [[bore, length]]])
    body = CrossSection([section]).revolve(_AROUND)
    body = body if toward > 0 else body.mirror((0, 0, 1)).translate((0, 0, length))
    return body.translate((0, y, z_mm[0])) - _over_pockets(scene, journal, y, z_mm, toward)


def _over_pockets(
    scene: Scene, journal: Journal, y: float, z_mm: tuple[float, float], toward: int
) -> Manifold:
    """Return the columns over pockets and bores that open under the fillet, outside the journal."""
    face, reach = z_mm[toward > 0], journal.radius_mm + journal.fillet_mm
    z = (face - journal.fillet.axial_mm, face) if toward > 0 else (face, face + journal.fillet.axial_mm)
    cuts = [body for body in web_bodies(scene) if not body.adds and face in body.z_mm]
    found = [
        _solid(solid)
        for body in (cuts if journal.fillet_mm else ())
        if 0 < body.distance_mm(y, face) < reach
        for solid in body.continued(z)
    ]
    core = Manifold.cylinder(z[1] - z[0], journal.radius_mm, -1.0, _AROUND).translate((0, y, z[0]))
    return sum(found, Manifold()) - core if found else Manifold()
