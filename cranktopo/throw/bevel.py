"""End bevels of the web: arcs in the plane of the crank axis and the throw, straight across the web."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, ClassVar, Literal, Self

import numpy as np
from pydantic import Field
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.errors import invalid
from cranktopo.base.spans import Span
from cranktopo.base.table import Length, Place
from cranktopo.throw.bevel_arc import BevelArc
from cranktopo.throw.feature import Body, Face, Feature, JournalsView, ThrowView, least_shoulder_mm
from cranktopo.throw.fitted import (
    CLEAR_MM,
    Axes,
    BodyCells,
    FittedToSections,
    Frame,
    Named,
    Rule,
    Surroundings,
    depth_mm,
    shoulder_rule,
    wall_rule,
)
from cranktopo.throw.journal import ROUNDING_MM
from cranktopo.throw.manufacturing_limits import ManufacturingLimits
from cranktopo.throw.primitives import (
    Arc,
    Curve,
    DimensionLine,
    Extrusion,
    FeatureDrawing,
    LineSegment,
    Point,
    Polyline,
    Solid,
)

_HALF = 0.5
_LEAST_DEPTH_MM = 1.0


class EndBevel(Feature):
    """Bevel across one end of the web, on the face that carries no journal there.

    On the journal face it takes off the crankpin's end of the web, on the pin face the main journal's. It
    starts at `y_mm` on its face and reaches `depth_mm` below that face at the very end of the outline; it is
    straight across the web, and along the throw an arc that rises `crown_mm` over its chord (0 = plane,
    negative = hollow).
    """

    face: Literal["journal", "pin"] = Field(examples=["journal"])
    """Face that it is cut from: `journal` bevels the crankpin's end of the web, `pin` the main journal's."""
    y_mm: Place = Field(examples=[60.0])
    """Where it meets that face, along the throw from the crank axis."""
    depth_mm: Length = Field(examples=[8.0])
    """Depth below that face at the very end of the outline; smaller than the web's thickness."""
    crown_mm: Place = 0.0
    """Rise of its arc over the chord; 0 = plane, negative = hollow."""

    def arc(self, scene: ThrowView) -> BevelArc:
        """Its arc, up to the end of the web's outline."""
        ends = scene.web.y_range_mm(scene.throw.radius_mm)
        return _arc(self.face, self.y_mm, self.depth_mm, self.crown_mm, ends)

    @override
    def bodies(self, scene: ThrowView, key: str) -> tuple[Body, ...]:
        arc, (start, end) = self.arc(scene), scene.web_z_mm
        face, into = (start, 1.0) if arc.outward > 0 else (end, -1.0)
        z_mm = (start, start + self.depth_mm) if arc.outward > 0 else (end - self.depth_mm, end)
        return (_BevelTool(key, z_mm, arc, face, into, 2 * scene.web.largest_half_width_mm),)

    @override
    def check_alone(self, scene: ThrowView, key: str) -> None:
        web = scene.web
        if len({bevel.face for bevel in web.bevel}) < len(web.bevel):
            raise invalid("web.bevel", web.bevel[0].face, "one bevel per face")
        arc = self.arc(scene)
        if self.depth_mm >= web.thickness_mm:
            allowed = f"must be smaller than web.thickness_mm = {web.thickness_mm:g} mm"
            raise scene.invalid(f"{key}.depth_mm", allowed)
        if arc.start_mm >= arc.end_mm:
            end = arc.outward * arc.end_mm
            raise scene.invalid(f"{key}.y_mm", f"lies beyond the end of the outline at {end:g} mm")
        if abs(self.crown_mm) > arc.largest_crown_mm:
            most = math.copysign(arc.largest_crown_mm, self.crown_mm)
            side = "at most" if most > 0 else "at least"
            allowed = f"must be {side} {most:.4g} mm, or the arc turns back"
            raise scene.invalid(f"{key}.crown_mm", allowed)

    def check_in_web(self, scene: ThrowView, key: str) -> None:
        """The two bevels do not meet, and each keeps clear of the journal that stands on its face."""
        starts = {bevel.face: bevel.y_mm for bevel in scene.web.bevel}
        if len(starts) == 2 and starts["pin"] >= starts["journal"]:
            allowed = f"the bevels overlap; the other starts at {starts['journal']:g} mm"
            raise invalid("web.bevel", starts["pin"], allowed)
        arc, (name, journal, axis) = self.arc(scene), _journals(scene.throw, self.face)[0]
        shoulder = least_shoulder_mm(scene.throw)
        room = arc.start_mm - arc.outward * axis - shoulder
        if journal.clear_radius_mm > room + ROUNDING_MM:
            raise scene.invalid(
                f"{key}.y_mm",
                f"starts {room + shoulder:.4g} mm from the axis of throw.{name}, which needs "
                f"{journal.clear_radius_mm + shoulder:.4g} mm for its radius and fillet",
                "Move the bevel outward.",
            )

    @override
    def drawing(self, scene: ThrowView) -> FeatureDrawing:
        arc, (start, end) = self.arc(scene), scene.web_z_mm
        half = float(scene.web.half_width_mm(scene.throw.radius_mm, np.array([self.y_mm]))[0])
        edge = Polyline(((-half, self.y_mm), (half, self.y_mm)), hidden=self.face == "journal")
        face, out, off = (start, -9.0, 5.0) if arc.outward > 0 else (end, 9.0, -3.5)
        tip = arc.outward * arc.end_mm
        depths = sorted((face, face + arc.outward * self.depth_mm))
        angle = np.degrees(np.arctan2(arc.end_mm - arc.start_mm, arc.depth_mm))
        hollow = ", hollow" if arc.radius_mm < 0 else ""
        shape = f"R {abs(arc.radius_mm):.1f}{hollow}" if np.isfinite(arc.radius_mm) else "plane"
        return FeatureDrawing(
            front=(edge,),
            lengthwise=(
                DimensionLine((face, 0.0), (face, self.y_mm), (out, 0.0), f"{self.y_mm:.2f}"),
                DimensionLine((depths[0], tip), (depths[1], tip), (0.0, off), f"{self.depth_mm:.2f}"),
            ),
            lines=(
                "",
                f"BEVEL on the {self.face} face",
                f"   from y {self.y_mm:.2f}, depth {self.depth_mm:.2f}",
                f"   chord {angle:.1f}° to the crank axis, {shape}",
            ),
        )


@dataclass(frozen=True)
class _BevelTool(Body):
    """Cut of a bevel at its face, over the whole width; `into` is +1 if the web lies toward +z."""

    arc: BevelArc
    face_mm: float
    into: float
    wide_mm: float

    @override
    def spans(self, y_mm: Array, z_mm: Array) -> Sequence[Span]:
        cut = self.into * (z_mm - self.face_mm) < self.arc.depth_at_mm(self.arc.outward * y_mm)
        half = np.where(cut, self.wide_mm, 0.0)
        return [(-half, half)]

    @property
    @override
    def y_range_mm(self) -> tuple[float, float]:
        low, high = sorted(self.arc.outward * reach for reach in (self.arc.start_mm, self.arc.end_mm))
        return low, high

    @override
    def z_breaks_mm(self, y_mm: Array, half_width_mm: Array) -> list[Array]:
        return [self.face_mm + self.into * self.arc.depth_at_mm(self.arc.outward * y_mm)]

    @property
    @override
    def changing_z_mm(self) -> tuple[tuple[float, float], ...]:
        return (self.z_mm,)

    def solids(self) -> tuple[Solid, ...]:
        """Return the arc, continued along its tangent beyond the web, swept across."""
        arc, far = self.arc, self.arc.chord_mm
        slope = math.atan2(arc.end_mm - arc.start_mm, arc.depth_mm)
        slope -= 2 * math.atan(2 * arc.crown_mm / arc.chord_mm)
        deepest, top = arc.depth_mm + far * math.cos(slope), arc.end_mm + 2 * far
        start, end = self._point(0.0, arc.start_mm), self._point(arc.depth_mm, arc.end_mm)
        corners = [end, self._point(deepest, arc.end_mm + far * math.sin(slope)), self._point(deepest, top)]
        corners += [self._point(-far, top), self._point(-far, arc.start_mm), start]
        straight = math.isinf(arc.radius_mm)
        curved: Curve = LineSegment(start, end) if straight else Arc(start, self._point(*arc.centre_mm), end)
        contour = (curved, *(LineSegment(a, b) for a, b in pairwise(corners)))
        return (Extrusion(contour, (2 * self.wide_mm, 0.0, 0.0)),)

    def _point(self, depth_mm: float, reach_mm: float) -> Point:
        return -self.wide_mm, self.arc.outward * reach_mm, self.face_mm + self.into * depth_mm


def height_range_mm(scene: ThrowView, y_mm: Array) -> tuple[Array, Array]:
    """Heights over the journal face between which bevels leave the web at positions along the throw, mm."""
    low, high = np.zeros_like(y_mm), np.full_like(y_mm, scene.web.thickness_mm)
    for bevel in scene.web.bevel:
        arc = bevel.arc(scene)
        depth = arc.depth_at_mm(arc.outward * y_mm)
        low, high = (depth, high) if arc.outward > 0 else (low, scene.web.thickness_mm - depth)
    return low, high


@dataclass(frozen=True)
class FittedBevel(FittedToSections):
    """An end bevel of a parametric web; its arc may be hollow where it is told so, a re-model's is not."""

    face: Face
    hollow: bool = False
    table: ClassVar[str] = "bevel"
    follows_ends: ClassVar[bool] = True

    @property
    @override
    def label(self) -> str:
        return f"bevel-{self.face}"

    @property
    @override
    def title(self) -> str:
        return f"{self.face} bevel"

    @property
    @override
    def names(self) -> tuple[str, ...]:
        return ("y", "depth", "crown")

    @override
    def bounds(self, scene: ThrowView, limits: ManufacturingLimits) -> list[tuple[float, float]]:
        far, thickness = 4 * scene.throw.radius_mm, scene.web.thickness_mm
        crown = (-thickness if self.hollow else 0.0, thickness)
        return [(-far, far), (_LEAST_DEPTH_MM, limits.deepest_mm(thickness)), crown]

    @override
    def possible(self, scene: ThrowView) -> bool:
        return self.face == "journal" or scene.web.counterweight is None

    @override
    def arc(self, named: Named, ends: Array) -> BevelArc:
        return _arc(self.face, named["y"], named["depth"], named["crown"], (ends[0], ends[1]))

    @override
    def faces_mm(self, named: Named, ends: Array, at: Axes, web_z_mm: tuple[float, float]) -> list[Array]:
        arc, (_, y, z) = self.arc(named, ends), at
        return [np.asarray(arc.distance_mm(depth_mm(self.face, z, web_z_mm), arc.outward * y))]

    def rules(self, named: Named, around: Surroundings) -> Iterator[Rule]:
        """Clear of the journal on its face, a wall under the other journal's edge, no turning back."""
        arc = self.arc(named, around.points_mm[[0, -1], 1])
        (name, journal, axis), (under, other, far) = _journals(around.scene.throw, self.face)
        least = around.limits.min_wall_mm
        reach = arc.outward * axis + journal.clear_radius_mm
        shoulder = reach + least_shoulder_mm(around.scene.throw) + CLEAR_MM
        yield shoulder_rule(name.replace("_", " ")), shoulder - arc.start_mm
        yield f"least length of the {self.title}, {least:.3g} mm", least + arc.start_mm - arc.end_mm
        wall = around.scene.web.thickness_mm - least
        edge = f"under the edge of the {under.replace('_', ' ')}"
        yield wall_rule(edge, least), -arc.distance_mm(wall, arc.outward * far + other.radius_mm)
        most = 0.95 * _twice_tangent(arc.end_mm - arc.start_mm, arc.depth_mm)
        yield f"the arc of the {self.title} does not turn back", 4 * arc.crown_mm - most
        draft_deg = around.limits.workshop.draft_deg
        if draft_deg:
            yield _draft_rule(arc, self.title, draft_deg)
        if self.hollow:
            yield f"the hollow arc of the {self.title} does not turn back", -4 * arc.crown_mm - most

    @override
    def tables(self, named: Named, frame_mm: Frame) -> list[dict[str, Any]]:
        return [{"face": self.face, **{f"{name}_mm": value for name, value in named.items()}}]

    @classmethod
    @override
    def read(cls, table: Feature, pair: bool, frame_mm: Frame) -> tuple[Self, Array] | None:
        if not isinstance(table, EndBevel):
            return None
        return cls(table.face, hollow=True), np.array([table.y_mm, table.depth_mm, table.crown_mm])

    def guess(self, cells: BodyCells, scene: ThrowView, limits: ManufacturingLimits) -> Array:
        """Start, depth and crown (0), mm, from how far the body reaches at each height."""
        solid = cells.solid.any(axis=0)
        outward = 1.0 if self.face == "journal" else -1.0
        reach = np.where(solid, outward * cells.y_mm[:, None], -np.inf).max(axis=0)
        reach = reach if self.face == "journal" else reach[::-1]
        below = np.flatnonzero(reach > reach.max() - 1.5 * cells.cell_mm[1])
        deepest = scene.web.thickness_mm - limits.min_wall_mm
        depth = float(np.clip((below[0] + _HALF) * cells.cell_mm[2], _LEAST_DEPTH_MM, deepest))
        return np.array([outward * reach[0], depth, 0.0])


def _draft_rule(arc: BevelArc, title: str, draft_deg: float) -> Rule:
    """Return the rule that an arc keeps its draft where it is steepest, as the rise that its chord lacks."""
    rise, run = arc.end_mm - arc.start_mm, arc.depth_mm
    chord = np.sqrt(rise**2 + run**2)
    steepest = np.arctan2(rise, run) - 2 * np.arctan(2 * np.abs(arc.crown_mm) / chord)
    missing = chord * (np.sin(np.deg2rad(draft_deg)) - np.sin(steepest))
    return f"least draft of the {title}, {draft_deg:.3g} deg", missing


def _arc(face: str, y_mm: Any, depth: Any, crown_mm: Any, ends: tuple[Any, Any]) -> BevelArc:
    if face == "journal":
        return BevelArc(y_mm, ends[1], depth, crown_mm, 1.0)
    return BevelArc(-y_mm, -ends[0], depth, crown_mm, -1.0)


def _journals(throw: JournalsView, face: str) -> list[tuple[str, Any, float]]:
    """Return the journal that stands on a face, then the other: name, journal, place of its axis."""
    both = [("main_journal", throw.main_journal, 0.0), ("crankpin", throw.crankpin, throw.radius_mm)]
    return both if face == "journal" else both[::-1]


def _twice_tangent(rise: Any, run: Any) -> Any:
    """2 L tan(min(slope, 90 deg - slope) / 2): four times a crown this large makes the arc turn back."""
    chord = np.hypot(rise, run)
    shorter, longer = np.minimum(rise, run), np.maximum(rise, run)
    return 2 * chord * shorter / (chord + longer)
