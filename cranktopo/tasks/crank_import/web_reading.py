"""The web of a half throw read back as a web of a design: outline, counterweight, bevels, drillings.

Dimensions come from exact faces. Outlines that fit these are compared with the silhouette of the body, and
the nearest one is taken; a silhouette that is none of them becomes a profile through stations.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.prisms import segments
from cranktopo.bodies.solid.step import kernel_surface
from cranktopo.bodies.solid.throw import add_half_throw
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.numerics.surfaces.mesh import solid_of
from cranktopo.tasks.crank_import.faces import CylinderFace, PlaneFace
from cranktopo.tasks.crank_import.half_body import HalfBody
from cranktopo.tasks.crank_import.oil_drillings import read_drillings, with_outlet_radius
from cranktopo.throw.web import web_bodies

if TYPE_CHECKING:
    from manifold3d import CrossSection, Manifold

_EXACT = 2e-4
"""Distance of silhouettes over the throw radius below which an outline counts as the body's own."""
_FLAT = 1e-6
_OUTLETS = 0.5
"""Rounded outlets are believed where they take away half of what differs."""
_STATIONS = 17
_DIGITS = 9
_EDGE = 0.15
"""Share of the web's thickness at its faces that chamfers of a counterweight may take."""


@dataclass(frozen=True)
class ReadWeb:
    """A scene with the web that comes nearest to a body, and how near.

    Attributes:
        outline: its outline and counterweight in words.
        outline_mm: largest distance of both silhouettes along the crank.
        missing_mm3, extra_mm3: what the body has and the design lacks, and the other way round.
    """

    scene: Scene
    outline: str
    outline_mm: float
    missing_mm3: float
    extra_mm3: float


@dataclass(frozen=True)
class ImportedWeb:
    """A distinct half throw beside the design read from it."""

    body: HalfBody
    read: ReadWeb
    name: str


def read_web(body: HalfBody, throw: Mapping[str, Any], material: Mapping[str, Any], name: str) -> ReadWeb:
    """Return the scene with the web of a half throw.

    Raises:
        CranktopoError: no web of the family fits the throw.
    """
    solid, exact_mm = solid_of(body.shown, name), _EXACT * throw["radius_mm"]
    found: list[tuple[float, tuple[float, int], str, Scene]] = []
    refusals: list[CranktopoError] = []
    start = throw["main_journal"]["length_mm"] / 2
    own = _silhouette(solid, start, start + body.half.thickness_mm)
    for rank, (words, web) in enumerate(_webs(body, throw, own)):
        data = {"name": name, "throw": dict(throw), "web": web, "material": dict(material)}
        try:
            scene = scene_from_dict(data, name)
        except CranktopoError as error:
            refusals.append(error)
            continue
        drawn = _drawn(scene)
        off, area = _apart_mm(own, drawn), ((own - drawn) + (drawn - own)).area()
        found.append((off, (round(area / own.area(), 4), rank), words, scene))
        if off < exact_mm:
            break
    if not found:
        raise refusals[-1]
    off, _, words, scene = min(found, key=lambda one: (one[0] > exact_mm, one[1]))
    scene, shown = _with_features(body, scene, solid, shown_half(scene))
    return ReadWeb(scene, words, off, float((solid - shown).volume()), float((shown - solid).volume()))


def shown_half(scene: Scene) -> Manifold:
    """Return the half throw of a scene in the kernel's own triangles."""
    with cad_session(f"half of {scene.name}") as gmsh:
        body = add_half_throw(gmsh.model.occ, scene)
        gmsh.model.occ.remove([p for p in gmsh.model.occ.getEntities(3) if p != body[0]], recursive=True)
        gmsh.model.occ.synchronize()
        shown = kernel_surface(gmsh)
    return solid_of(shown, scene.name)


def _drawn(scene: Scene) -> CrossSection:
    """Return the outline of a scene's web and counterweight along the crank."""
    from manifold3d import CrossSection, FillRule

    polygons = [body.polygon_mm(_sides) for body in web_bodies(scene) if body.adds]
    return CrossSection(polygons, FillRule.NonZero)


def _sides(radius_mm: float) -> int:
    return 4 * segments(radius_mm)


def _silhouette(solid: Manifold, low: float, high: float) -> CrossSection:
    between = solid.trim_by_plane((0.0, 0.0, 1.0), low).trim_by_plane((0.0, 0.0, -1.0), -high)
    return between.project()


def _apart_mm(one: CrossSection, other: CrossSection) -> float:
    """Return the largest distance of the outer edges of two sections."""
    first, second = (_dense(section) for section in (one, other))
    return float(max(_from(first, second), _from(second, first)))


def _outer(section: CrossSection) -> Array:
    return max((np.asarray(c) for c in section.to_polygons()), key=lambda c: abs(_area(c)))


def _area(points: Array) -> float:
    x, y = points.T
    return float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2)


def _dense(section: CrossSection, step_mm: float = 0.25) -> Array:
    points = _outer(section)
    after = np.roll(points, -1, axis=0)
    counts = np.maximum(1, np.ceil(np.linalg.norm(after - points, axis=1) / step_mm)).astype(int)
    return np.concatenate(
        [a + (b - a) * np.arange(n)[:, None] / n for a, b, n in zip(points, after, counts, strict=True)]
    )


def _from(points: Array, edge: Array) -> float:
    """Largest distance of points from a closed polygon of short sides."""
    from scipy.spatial import cKDTree

    _, nearest = cKDTree(edge).query(points)
    distances = []
    for step in (-1, 0):
        a, b = edge[(nearest + step) % len(edge)], edge[(nearest + step + 1) % len(edge)]
        along = b - a
        share = np.clip(((points - a) * along).sum(1) / np.maximum((along**2).sum(1), 1e-30), 0, 1)
        distances.append(np.linalg.norm(a + share[:, None] * along - points, axis=1))
    return float(np.min(distances, axis=0).max())


def _webs(
    body: HalfBody, throw: Mapping[str, Any], silhouette: CrossSection
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield webs that the faces speak for, the plainest first, and profiles through the silhouette last."""
    radius, thickness = float(throw["radius_mm"]), round(body.half.thickness_mm, _DIGITS)
    weights = [None, *_counterweights(body, throw)]
    for words, outline in _outlines(body, radius):
        for weight in weights:
            extra = {} if weight is None else {"counterweight": weight}
            said = words if weight is None else f"{words} with a counterweight"
            yield said, {"thickness_mm": thickness, **outline, **extra}
    points = _outer(silhouette)
    for weight in weights:
        extra = {} if weight is None else {"counterweight": weight}
        said = "profile through stations" + ("" if weight is None else " with a counterweight")
        low = None if weight is None else _arm_mm(body, throw)
        yield said, {"thickness_mm": thickness, **_profile(points, radius, low), **extra}


def _vertical(plane: PlaneFace) -> bool:
    return abs(float(plane.normal[2])) < _FLAT


def _outlines(body: HalfBody, radius: float) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield outlines whose sides are planes: hulls of two circles, and rectangles."""
    sides = [p for p in body.faces.planes if _vertical(p) and p.normal[0] > 0.3]
    for side in sorted(sides, key=lambda p: -p.area_mm2)[:2]:
        main = float(side.normal @ side.point_mm)
        pin = float(side.normal @ (side.point_mm - np.array([0.0, radius, 0.0])))
        main, pin = round(main, _DIGITS), round(pin, _DIGITS)
        if min(main, pin) <= 0:
            continue
        if abs(main - pin) < _FLAT * radius:
            yield "obround", {"outline": "obround", "width_mm": 2 * main}
            yield from _rectangles(body, radius, main)
        else:
            yield "tapered", {"outline": "tapered", "main_radius_mm": main, "pin_radius_mm": pin}
    yield from _ellipses(body, radius)


def _rectangles(body: HalfBody, radius: float, half: float) -> Iterator[tuple[str, dict[str, Any]]]:
    ends = [p for p in body.faces.planes if _vertical(p) and abs(float(p.normal[1])) > 1 - _FLAT]
    tops = {round(float(p.point_mm[1]) - radius, _DIGITS) for p in ends if p.normal[1] > 0}
    tops.add(round(float(body.shown.vertices_mm[:, 1].max()) - radius, 6))
    tops = {top for top in tops if top > 0}
    for top in sorted(tops, reverse=True)[:2]:
        corners = {
            round(c.radius_mm, _DIGITS)
            for c in body.faces.cylinders
            if c.outward
            and abs(abs(c.point_mm[0]) - (half - c.radius_mm)) < 1e-4 * half
            and abs(c.axis[2]) > 1 - _FLAT
        }
        for corner in [*sorted(corners), 0.0]:
            table = {"outline": "rectangle", "width_mm": 2 * half, "overhang_mm": top}
            yield "rectangle", table | ({"corner_radius_mm": corner} if corner else {})


def _ellipses(body: HalfBody, radius: float) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the ellipse about half the throw that the box of the web allows."""
    z = body.half.main_length_mm / 2 + body.half.thickness_mm * np.array([0.05, 0.95])
    points = body.shown.vertices_mm
    inside = points[
        (points[:, 2] > z[0] - body.half.thickness_mm) & (points[:, 2] < z[1] + body.half.thickness_mm)
    ]
    if len(inside):
        along = round(float(inside[:, 1].max()) - radius / 2, 6)
        across = round(float(inside[:, 0].max()), 6)
        yield "ellipse", {"outline": "ellipse", "semi_axis_throw_mm": along, "semi_axis_lateral_mm": across}


def _counterweights(body: HalfBody, throw: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield the counterweight that a rim about the crank axis shows, without and with its fillets."""
    rims = [
        c
        for c in body.faces.cylinders
        if c.outward
        and not c.full
        and _on_axis(c)
        and _mid_y(c) <= 0
        and c.radius_mm > throw["main_journal"]["outer_diameter_mm"] / 2
    ]
    sides = [p for p in body.faces.planes if _vertical(p) and p.normal[0] > 0.3]
    ends = {float(side.normal @ side.point_mm) for side in sides}  # radii of round ends that sides touch
    rims = [c for c in rims if all(abs(c.radius_mm - end) > 1e-6 * end for end in ends)]
    if not rims:
        return
    rim = max(rims, key=lambda c: c.radius_mm)
    flanks = [
        p
        for p in body.faces.planes
        if _vertical(p)
        and p.normal[0] >= -_FLAT
        and abs(float(p.normal @ p.point_mm)) < 1e-6 * rim.radius_mm
        and p.point_mm[0] > 0
    ]
    if flanks:
        normal = max(flanks, key=lambda p: p.area_mm2).normal
        angle = math.degrees(math.atan2(abs(normal[1]), abs(normal[0])))
    else:
        angle = min(90.0, math.degrees(rim.turn_rad) / 2)
    table: dict[str, Any] = {
        "outer_radius_mm": round(rim.radius_mm, _DIGITS),
        "half_angle_deg": round(min(angle, 90.0), _DIGITS),
        **_weight_depth(body, rim),
    }
    yield table
    concave = {
        round(c.radius_mm, _DIGITS)
        for c in body.faces.cylinders
        if not c.outward and not c.full and abs(c.axis[2]) > 1 - _FLAT
    }
    for fillet in sorted(concave)[:2]:
        yield {**table, "fillet_mm": fillet}


def _on_axis(face: CylinderFace) -> bool:
    return abs(face.axis[2]) > 1 - _FLAT and float(np.hypot(*face.point_mm[:2])) < 1e-5 * face.radius_mm


def _mid_y(face: CylinderFace) -> float:
    return float(face.middle_mm[1])


def _weight_depth(body: HalfBody, rim: CylinderFace) -> dict[str, Any]:
    """Return thickness and face of a counterweight that is thinner than its web, chamfers aside."""
    start, thickness = body.half.main_length_mm / 2, body.half.thickness_mm
    sign = 1.0 if rim.axis[2] > 0 else -1.0
    low, high = sorted(float(rim.point_mm[2]) + sign * end - start for end in rim.span_mm)
    if low < _EDGE * thickness and high > (1 - _EDGE) * thickness:
        return {}
    face = "journal" if low < thickness - high else "pin"
    depth = high if face == "journal" else thickness - low
    return {"thickness_mm": round(depth, _DIGITS), "face": face}


def _arm_mm(body: HalfBody, throw: Mapping[str, Any]) -> float:
    """Half-width of the web beside its counterweight, from the largest plane side."""
    sides = [p for p in body.faces.planes if _vertical(p) and p.normal[0] > 0.3]
    if not sides:
        return float(throw["main_journal"]["outer_diameter_mm"]) * 0.6
    return float(max(sides, key=lambda p: p.area_mm2).point_mm[0])


def _profile(points: Array, radius: float, arm_mm: float | None) -> dict[str, Any]:
    """Return the profile through a silhouette; `arm_mm`: below the crank axis it is round, so wide."""
    low, high = float(points[:, 1].min()), float(points[:, 1].max())
    if arm_mm is not None:
        low = -arm_mm
    stations = low + (high - low) * (1 - np.cos(np.linspace(0, np.pi, _STATIONS))) / 2
    stations = np.round(stations, 4)
    widths = np.array([_half_width(points, float(y)) for y in stations])
    if arm_mm is not None:
        round_end = np.sqrt(np.maximum(arm_mm**2 - np.minimum(stations, 0.0) ** 2, 0.0))
        widths = np.where(stations < 0, round_end, np.minimum(widths, arm_mm))
    edge = max(1e-3, 0.02 * float(widths.max()))
    ends = [_half_width(points, float(y)) for y in (low + 1e-3 * (high - low), high - 1e-3 * (high - low))]
    straight = [end > 0.35 * widths.max() for end in ends]
    widths[0] = 0.0 if arm_mm is not None or not straight[0] else ends[0]
    widths[-1] = ends[1] if straight[1] else 0.0
    widths[1:-1] = np.maximum(widths[1:-1], edge)
    return {
        "outline": "profile",
        "stations_mm": stations.tolist(),
        "half_widths_mm": np.round(widths, 4).tolist(),
    }


def _half_width(points: Array, y: float) -> float:
    """Largest |x| of a polygon at a height."""
    a, b = points, np.roll(points, -1, axis=0)
    crossing = (np.minimum(a[:, 1], b[:, 1]) <= y) & (np.maximum(a[:, 1], b[:, 1]) >= y)
    a, b = a[crossing], b[crossing]
    if not len(a):
        return 0.0
    rise = np.where(a[:, 1] == b[:, 1], 1.0, b[:, 1] - a[:, 1])
    return float(np.abs(a[:, 0] + (b[:, 0] - a[:, 0]) * (y - a[:, 1]) / rise).max())


def _with_features(body: HalfBody, scene: Scene, solid: Manifold, shown: Manifold) -> tuple[Scene, Manifold]:
    """Return the scene with the bevels and drillings that bring it nearer to the body."""
    data = scene.model_dump(mode="json", exclude_none=True)
    bevels = sorted(_bevels(body, scene), key=lambda bevel: bevel[1]["face"])
    for path, feature in [*bevels, *read_drillings(body, scene)]:
        table, key = path
        tried = {**data, table: {**data[table], key: [*data[table].get(key, ()), feature]}}
        try:
            candidate = scene_from_dict(tried, scene.name)
            now = shown_half(candidate)
        except CranktopoError:
            continue
        if _differ_mm3(solid, now) < _differ_mm3(solid, shown):
            data, scene, shown = tried, candidate, now
    rounded = with_outlet_radius(body, scene) if scene.throw.drilling else None
    if rounded is None:
        return scene, shown
    now = shown_half(rounded)
    better = _differ_mm3(solid, now) < _OUTLETS * _differ_mm3(solid, shown)
    return (rounded, now) if better else (scene, shown)


def _differ_mm3(one: Manifold, other: Manifold) -> float:
    return float((one - other).volume() + (other - one).volume())


def _bevels(body: HalfBody, scene: Scene) -> Iterator[tuple[tuple[str, str], dict[str, Any]]]:
    """Yield bevels that slanted planes, or cylinders across the web, show."""
    low, high = scene.web.y_range_mm(scene.throw.radius_mm)
    journal_face, pin_face = scene.web_z_mm
    for plane in body.faces.planes:
        nx, ny, nz = plane.normal
        if abs(nx) > _FLAT or min(abs(ny), abs(nz)) < 1e-3:
            continue
        at = float(plane.normal @ plane.point_mm)
        if nz < 0 < ny:
            y, depth = (at - nz * journal_face) / ny, (at - ny * high) / nz - journal_face
            yield ("web", "bevel"), _bevel("journal", y, depth)
        elif ny < 0 < nz:
            y, depth = (at - nz * pin_face) / ny, pin_face - (at - ny * low) / nz
            yield ("web", "bevel"), _bevel("pin", y, depth)
    for face in body.faces.cylinders:
        if abs(abs(face.axis[0]) - 1) < _FLAT:
            yield from _crowned(face, (low, high), (journal_face, pin_face))


def _crowned(
    face: CylinderFace, ends: tuple[float, float], faces: tuple[float, float]
) -> Iterator[tuple[tuple[str, str], dict[str, Any]]]:
    """Yield the bevel of a cylinder across the web."""
    y0, z0, radius = float(face.point_mm[1]), float(face.point_mm[2]), face.radius_mm
    for name, end, at, inward in (("journal", ends[1], faces[0], 1.0), ("pin", ends[0], faces[1], -1.0)):
        reach, run = radius**2 - (at - z0) ** 2, radius**2 - (end - y0) ** 2
        if reach < 0 or run < 0 or (face.middle_mm[1] - sum(ends) / 2) * (end - sum(ends) / 2) < 0:
            continue
        side = 1.0 if face.outward else -1.0
        toward = math.copysign(1.0, end - sum(ends) / 2)
        y = y0 + side * toward * math.sqrt(reach)
        z = z0 - side * inward * math.sqrt(run)
        depth = inward * (z - at)
        chord = math.hypot(end - y, z - at)
        rise = radius - math.sqrt(max(radius**2 - chord**2 / 4, 0.0))
        if depth > 0 and chord > 0:
            yield ("web", "bevel"), {**_bevel(name, y, depth), "crown_mm": round(side * rise, _DIGITS)}


def _bevel(face: str, y: float, depth: float) -> dict[str, Any]:
    return {"face": face, "y_mm": round(y, _DIGITS), "depth_mm": round(depth, _DIGITS)}
