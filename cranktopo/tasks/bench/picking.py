"""Name what of a design lies under the pointer: the ray meets the shown bodies, the features say whose it is.

A body of the web holds the point just inside of the surface, or the one just outside, and says itself whether
it does; pixels and colours are not asked.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from manifold3d import Manifold

from cranktopo.base.arrays import Array
from cranktopo.base.frames import X, Y, Z
from cranktopo.bodies.prisms import bolted_counterweight
from cranktopo.bodies.shown_solid import display_half
from cranktopo.design.halves import WebName, halves, named_in_throw
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.tasks.bench.live_picture import turns_deg
from cranktopo.throw.drilling.table import drill_bores
from cranktopo.throw.feature import Body, Face
from cranktopo.throw.web import WebTable, web_bodies

_NEAR = 0.004
"""Step off a surface over the throw's radius: more than chords are off their circles, less than any wall."""
_FLAT = 0.7
"""Least part of a normal along the crank axis on a web face."""
_JOURNALS = ("throw.main_journal", "throw.crankpin")


@dataclass(frozen=True)
class Sight:
    """Line of sight of a page, in the frame of the first throw, mm.

    Attributes:
        start: point before everything that is shown.
        along: direction of sight.
        whole: the half beyond the crankpin is shown, too.
        crank: all throws are shown, each turned.
        section: place x beyond which nothing is shown; None without a section.
    """

    start: Array
    along: Array
    whole: bool = False
    crank: bool = False
    section: float | None = None

    @classmethod
    def of(cls, asked: Mapping[str, Any]) -> Sight:
        """Return what a page sent; raises ValueError, TypeError or KeyError for anything else."""
        start, along = (np.asarray([float(part) for part in asked[name]]) for name in ("start", "along"))
        if start.shape != (3,) or along.shape != (3,) or not np.isfinite([start, along]).all():
            raise ValueError("a sight is two vectors.")
        section = asked.get("section")
        shown = bool(asked.get("whole")), bool(asked.get("crank"))
        return cls(start, along, *shown, None if section is None else float(section))


@dataclass(frozen=True)
class _Hit:
    """Nearest point of a half that a ray meets, in the frame of that half."""

    distance: float
    half: Scene
    side: WebName
    point: Array
    normal: Array
    inside: bool
    """It is seen from inside of the body, through the section."""
    bolted: bool


def picked(data: dict[str, Any], asked: Mapping[str, Any]) -> dict[str, Any]:
    """Return the key of what is seen along a line of sight; on a web face its name and the place on it, too.

    An empty table where nothing is there, or where the section is seen.
    """
    scene, sight = scene_from_dict(data, "design", whole=True), Sight.of(asked)
    hit = min(_hits(scene, sight), key=lambda one: one.distance, default=None)
    if hit is None or hit.inside:
        return {}
    key, face = ("web.counterweight", None) if hit.bolted else picked_key(hit.half, hit.point, hit.normal)
    named = {"key": named_in_throw(key, scene, hit.side)}
    if face is None:
        return named
    place = {"x_mm": float(hit.point[X]), "y_mm": float(hit.point[Y])}
    return {**named, "face": face, **place, "side": hit.side}


def _hits(scene: Scene, sight: Sight) -> Iterator[_Hit]:
    pair = halves(scene)
    pitch = (pair[0].pitch_mm + pair[1].pitch_mm) / 2
    sides: tuple[WebName, ...] = ("first", "second") if sight.whole or sight.crank else ("first",)
    for side in sides:
        half = pair[side == "second"]
        bodies = [(_triangles(body), bolted) for body, bolted in _shown(half) if not body.is_empty()]
        for number, turn_deg in enumerate(turns_deg(scene) if sight.crank else [0.0]):
            start, along = _own(
                sight, np.radians(turn_deg), number * pitch, pitch if side == "second" else None
            )
            for corners, bolted in bodies:
                found = _nearest(corners, start, along, sight.section)
                if found is not None:
                    distance, normal = found
                    place = start + distance * along
                    yield _Hit(distance, half, side, place, normal, bool(normal @ along > 0), bolted)


def _shown(half: Scene) -> tuple[tuple[Manifold, bool], tuple[Manifold, bool]]:
    return (display_half(half), False), (bolted_counterweight(half), True)


def _triangles(body: Manifold) -> Array:
    """Return the corners of the surface, (n, 3, 3)."""
    mesh = body.to_mesh64()
    return np.asarray(mesh.vert_properties)[:, :3][np.asarray(mesh.tri_verts, np.int64)]


def _own(sight: Sight, turn: float, shift_mm: float, mirror_mm: float | None) -> tuple[Array, Array]:
    """Return start and direction of the sight in the frame of a half of a throw that is turned and shifted.

    Args:
        turn: right-handed about z, rad.
        mirror_mm: pitch of the throw for its second half, which is mirrored at the middle of it.
    """
    cosine, sine = np.cos(turn), np.sin(turn)
    back = np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    start, along = back @ sight.start - [0.0, 0.0, shift_mm], back @ sight.along
    if mirror_mm is None:
        return start, along
    flip = np.array([1.0, 1.0, -1.0])
    return start * flip + [0.0, 0.0, mirror_mm], along * flip


def _nearest(corners: Array, start: Array, along: Array, section: float | None) -> tuple[float, Array] | None:
    """Return the distance to the first triangle that is shown on a ray, and its normal; None where none is.

    Without a section triangles are shown from outside alone, with one those before its plane.
    Source: Moeller and Trumbore, Fast, minimum storage ray/triangle intersection (1997).
    """
    first, one, other = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    across = np.cross(along, other)
    size = np.einsum("ij,ij->i", one, across)
    with np.errstate(divide="ignore", invalid="ignore"):
        away = start - first
        u = np.einsum("ij,ij->i", away, across) / size
        beside = np.cross(away, one)
        v = beside @ along / size
        distance = np.einsum("ij,ij->i", other, beside) / size
        met = (u >= 0) & (v >= 0) & (u + v <= 1) & (distance > 0)
        met &= size > 0 if section is None else start[X] + distance * along[X] <= section
    if not met.any():
        return None
    found = int(np.argmin(np.where(met, distance, np.inf)))
    normal = np.cross(one[found], other[found])
    return float(distance[found]), normal / np.linalg.norm(normal)


def picked_key(half: Scene, point: Array, normal: Array) -> tuple[str, Face | None]:
    """Return the key of what a surface point of a half throw belongs to, and the web face if it is on one."""
    step = _NEAR * half.throw.radius_mm * normal
    inner, outer = point - step, point + step
    cuts = [*drill_bores(half), *(body for body in web_bodies(half) if not body.adds)]
    if (key := _first(cuts, outer)) is not None:
        return key, None
    start, end = half.web_z_mm
    if start < inner[Z] < end:
        return _web_key(half, inner, normal)
    return _journal_key(half, int(inner[Z] >= end), point, inner, outer), None


def _first(bodies: Sequence[Body], point: Array) -> str | None:
    return next((body.key for body in bodies if _holds(body, point)), None)


def _holds(body: Body, point: Array) -> bool:
    x, y, z = point
    return body.z_mm[0] <= z <= body.z_mm[1] and bool(body.contains(np.asarray(x), np.asarray(y), z))


def _web_key(half: Scene, inner: Array, normal: Array) -> tuple[str, Face | None]:
    if abs(normal[Z]) > _FLAT:
        return "web.thickness_mm", "journal" if normal[Z] < 0 else "pin"
    outline, *others = (body for body in web_bodies(half) if body.adds)
    added = None if _holds(outline, inner) else _first(others, inner)
    return added or f"web.{_own_dimension(half)}", None


def _own_dimension(half: Scene) -> str:
    """Return the first dimension that the outline has beside those of all webs."""
    names = type(half.web).model_fields
    return next(name for name in names if name not in WebTable.model_fields and name != "outline")


def _journal_key(half: Scene, number: int, point: Array, inner: Array, outer: Array) -> str:
    """Return the key of a dimension of the main journal, 0, or the crankpin, 1."""
    (journal, axis), key = half.throw.journals[number], _JOURNALS[number]
    face, middle = ((half.web_z_mm[0], 0.0), (half.web_z_mm[1], half.pitch_mm / 2))[number]
    off_inner, off_outer = (float(np.hypot(one[X], one[Y] - axis)) for one in (inner, outer))
    if min(abs(inner[Z] - middle), abs(outer[Z] - middle)) < abs(inner[Z] - outer[Z]):
        return f"{key}.length_mm"
    if off_outer < journal.bore_radius_mm:
        return f"{key}.bore_diameter_mm"
    beside = abs(point[Z] - face) < journal.fillet.axial_mm
    return f"{key}.{'fillet_mm' if beside and off_inner < off_outer else 'outer_diameter_mm'}"
