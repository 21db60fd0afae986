"""End bevels of the web: arcs in the plane of the crank axis and the throw, straight across the web."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, ClassVar, Literal, Self

import numpy as np
from pydantic import Field
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.errors import invalid
from cranktopo.base.table import Length, Place
from cranktopo.throw.bevel_arc import BevelArc
from cranktopo.throw.bevel_tool import BevelTool, DraftedBevelTool
from cranktopo.throw.feature import (
    Body,
    Face,
    Feature,
    ForgingView,
    JournalsView,
    ThrowView,
    least_shoulder_mm,
)
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
from cranktopo.throw.primitives import DimensionLine, FeatureDrawing, Polyline

_HALF = 0.5
_LEAST_DEPTH_MM = 1.0
LARGEST_DRAFT_DEG = 30.0
_SAMPLES = 401
"""Places along the outline at which a bevel with draft is looked at."""
_ROUNDED_MM = 0.0051
"""Most that rounding changes of a dimension."""
_EVERY = 2
"""Of how many points of the outline one keeps a wall over a bevel with draft."""
_TURNS = 13
"""Places on a quarter of a journal's edge that keep a wall over a bevel with draft."""


class EndBevel(Feature):
    """Bevel across one end of the web, on the face that carries no journal there.

    On the journal face it takes off the crankpin's end of the web, on the pin face the main journal's. It
    starts at `y_mm` on its face and reaches `depth_mm` below that face at the very end of the outline; along
    the throw it is an arc that rises `crown_mm` over its chord (0 = plane, negative = hollow). It is straight
    across the web, or with a draft lies the deeper the farther from x = 0, at right angles to its chord.
    """

    face: Literal["journal", "pin"] = Field(examples=["journal"])
    """Face that it is cut from: `journal` bevels the crankpin's end of the web, `pin` the main journal's."""
    y_mm: Place = Field(examples=[60.0])
    """Place where it meets that face, along the throw from the crank axis."""
    depth_mm: Length = Field(examples=[8.0])
    """Depth below that face at the very end of the outline; smaller than the web's thickness."""
    crown_mm: Place = 0.0
    """Rise of its arc over the chord; 0 = plane, negative = hollow."""
    draft_deg: float = Field(default=0.0, ge=0, le=LARGEST_DRAFT_DEG)
    """Draft angle of a die that opens across the web: its surface falls away by it on both sides of x = 0."""

    def arc(self, scene: ThrowView) -> BevelArc:
        """Its arc, up to the end of the web's outline."""
        ends = scene.web.y_range_mm(scene.throw.radius_mm)
        return _arc(self.face, self.y_mm, self.depth_mm, self.crown_mm, ends, self.draft_deg)

    @override
    def bodies(self, scene: ThrowView, key: str) -> tuple[Body, ...]:
        arc, (start, end), wide = self.arc(scene), scene.web_z_mm, scene.web.largest_half_width_mm
        face, into = (start, 1.0) if arc.outward > 0 else (end, -1.0)
        deep = min(float(_depths_mm(scene, arc).max()), end - start) if self.draft_deg else self.depth_mm
        z_mm = (start, start + deep) if arc.outward > 0 else (end - deep, end)
        if not self.draft_deg:
            return (BevelTool(key, z_mm, arc, face, into, 2 * wide),)
        inner = max(arc.start_mm - float(arc.inward) * wide, _first_mm(scene, arc))
        return (DraftedBevelTool(key, z_mm, arc, face, into, 2 * wide, inner, end - start),)

    @override
    def forged(self, scene: ThrowView, key: str, forging: ForgingView) -> tuple[Body, ...]:
        """With the draft of the die, so far outward that nowhere less than the allowance lies on its face."""
        own, wide = self.arc(scene), scene.web.largest_half_width_mm
        arc = replace(own, draft_deg=max(own.draft_deg, forging.draft_deg))
        out, chord = (arc.drop - own.drop) * wide, own.chord_mm
        rise, run = own.end_mm - own.start_mm, own.depth_mm
        arc = replace(arc, start_mm=own.start_mm + out * run / chord, end_mm=own.end_mm + out * run / chord)
        (start, end), up = scene.web_z_mm, forging.allowance_mm + out * rise / chord
        face, into = (start - up, 1.0) if arc.outward > 0 else (end + up, -1.0)
        thick = end - start + 2 * (up + forging.draft_slope * wide)
        inner = _first_mm(scene, arc) - wide
        return (DraftedBevelTool(key, (start - up, end + up), arc, face, into, 2 * wide, inner, thick),)

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
        room = _off_edge_mm(arc, axis) - shoulder
        if journal.clear_radius_mm > room + ROUNDING_MM:
            raise scene.invalid(
                f"{key}.y_mm",
                f"starts {room + shoulder:.4g} mm from the axis of throw.{name}, which needs "
                f"{journal.clear_radius_mm + shoulder:.4g} mm for its radius and fillet",
                "Move the bevel outward.",
            )
        if self.draft_deg:
            _check_draft(scene, key, arc)

    @override
    def drawing(self, scene: ThrowView) -> FeatureDrawing:
        arc, (start, end) = self.arc(scene), scene.web_z_mm
        edge = Polyline(_edge(scene, arc), hidden=self.face == "journal")
        face, out, off = (start, -9.0, 5.0) if arc.outward > 0 else (end, 9.0, -3.5)
        tip = arc.outward * arc.end_mm
        depths = sorted((face, face + arc.outward * self.depth_mm))
        angle = np.degrees(np.arctan2(arc.end_mm - arc.start_mm, arc.depth_mm))
        hollow = ", hollow" if arc.radius_mm < 0 else ""
        shape = f"R {abs(arc.radius_mm):.1f}{hollow}" if np.isfinite(arc.radius_mm) else "plane"
        draft = (f"   draft {self.draft_deg:.2f}° to both sides of x = 0",) if self.draft_deg else ()
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
                *draft,
            ),
        )


def height_range_mm(scene: ThrowView, y_mm: Array, aside_mm: Any) -> tuple[Array, Array]:
    """Heights over the journal face between which bevels leave the web at places along and across, mm."""
    low, high = np.zeros_like(y_mm), np.full_like(y_mm, scene.web.thickness_mm)
    for bevel in scene.web.bevel:
        arc = bevel.arc(scene)
        depth = arc.depth_at_mm(arc.outward * y_mm, aside_mm)
        low, high = (depth, high) if arc.outward > 0 else (low, scene.web.thickness_mm - depth)
    return low, high


def _check_draft(scene: ThrowView, key: str, arc: BevelArc) -> None:
    """Refuse a draft that takes a bevel through the web, or to the counterweight."""
    deepest = float(_depths_mm(scene, arc).max())
    if deepest >= scene.web.thickness_mm - ROUNDING_MM:
        allowed = f"takes the bevel {deepest:.4g} mm below its face at the outline, through the web"
        raise scene.invalid(f"{key}.draft_deg", allowed, "Reduce it or depth_mm.")
    if any(over > -ROUNDING_MM for over in _over_weight_mm(scene, arc)):
        allowed = "takes the edge of the bevel over web.counterweight"
        raise scene.invalid(f"{key}.draft_deg", allowed, "Reduce it or move the bevel outward.")


def _over_weight_mm(scene: ThrowView, arc: BevelArc) -> Iterator[Any]:
    """Yield how far each part of a counterweight reaches over the edge of a bevel with draft.

    Beside a bevel at its own end of the web a counterweight has no place, whatever the draft: it says so.
    """
    weight = scene.web.counterweight if arc.outward > 0 else None
    for part in weight.parts(scene) if weight is not None else ():
        low, high = part.y_range_mm
        y = np.linspace(low, high, _SAMPLES)
        yield (arc.outward * y + arc.inward * part.half_width_mm(y)).max() - arc.start_mm


def _first_mm(scene: ThrowView, arc: BevelArc) -> float:
    """Reach of the end of the outline away from a bevel."""
    return min(arc.outward * y for y in scene.web.y_range_mm(scene.throw.radius_mm))


def _depths_mm(scene: ThrowView, arc: BevelArc) -> Array:
    """Depths of a bevel along the outline upward, dense toward its ends."""
    (low, high), turn = scene.web.y_range_mm(scene.throw.radius_mm), np.linspace(0, np.pi, _SAMPLES)
    y = (low + high) / 2 - (high - low) / 2 * np.cos(turn)
    return arc.depth_at_mm(arc.outward * y, scene.web.half_width_mm(scene.throw.radius_mm, y))


def _off_edge_mm(arc: BevelArc, axis_mm: Any) -> Any:
    """Distance of an axis at a place along the throw from a bevel's edge on its face."""
    return (arc.start_mm - arc.outward * axis_mm) / np.hypot(1.0, arc.inward)


@lru_cache(maxsize=64)
def _rounded_off_mm(arc: BevelArc, axis_mm: Any) -> Any:
    """Least such distance after rounding: where an arc begins flat, its edge moves by many times as much."""
    off = _ROUNDED_MM
    start, end, depth = arc.start_mm - off, arc.end_mm + off, arc.depth_mm - off
    flatter = replace(arc, start_mm=start, end_mm=end, depth_mm=depth, crown_mm=arc.crown_mm + off)
    return _off_edge_mm(flatter, axis_mm)


@lru_cache(maxsize=64)
def _least_off_mm(arc: BevelArc, depth_mm: Any, axis_mm: Any, radius_mm: Any) -> Any:
    """Least distance of a bevel from the edge of a journal at a depth, its axis at a reach."""
    if not arc.draft_deg:
        return arc.distance_mm(depth_mm, axis_mm + radius_mm)
    turn = np.linspace(0, np.pi / 2, _TURNS)
    return arc.distance_mm(depth_mm, axis_mm + radius_mm * np.cos(turn), radius_mm * np.sin(turn)).min()


def _edge(scene: ThrowView, arc: BevelArc) -> tuple[tuple[float, float], ...]:
    """Return the edge of a bevel on its face, (x, y): from outline to outline, with a draft bent in x = 0."""
    x = np.linspace(0, scene.web.largest_half_width_mm, _SAMPLES)
    y = arc.outward * (arc.start_mm - float(arc.inward) * x)
    if not arc.draft_deg:
        half = float(scene.web.half_width_mm(scene.throw.radius_mm, y[:1])[0])
        return (-half, float(y[0])), (half, float(y[0]))
    last = np.flatnonzero(x <= scene.web.half_width_mm(scene.throw.radius_mm, y))[-1]
    tip = float(x[last]), float(y[last])
    return (-tip[0], tip[1]), (0.0, float(y[0])), tip


@dataclass(frozen=True)
class FittedBevel(FittedToSections):
    """An end bevel of a parametric web; its arc may be hollow where it is told so, a re-model's is not.

    The draft is the workshop's, not free.
    """

    face: Face
    hollow: bool = False
    draft_deg: float = 0.0
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
    def rough_on_cells(self) -> bool:
        """With a draft its edge lies flat and thin over the flanks, where a groove leaves a lip."""
        return self.draft_deg > 0

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
    def manufactured(self, limits: ManufacturingLimits) -> Self:
        return replace(self, draft_deg=max(self.draft_deg, limits.workshop.bevel_draft_deg))

    @override
    def possible(self, scene: ThrowView) -> bool:
        return self.face == "journal" or scene.web.counterweight is None

    @override
    def arc(self, named: Named, ends: Array) -> BevelArc:
        return _arc(self.face, named.y, named.depth, named.crown, (ends[0], ends[1]), self.draft_deg)

    @override
    def faces_mm(self, named: Named, ends: Array, at: Axes, web_z_mm: tuple[float, float]) -> list[Array]:
        arc, (x, y, z) = self.arc(named, ends), at
        return [np.asarray(arc.distance_mm(depth_mm(self.face, z, web_z_mm), arc.outward * y, x))]

    def rules(self, named: Named, around: Surroundings) -> Iterator[Rule]:
        """Clear of the journal on its face, a wall under the other journal's edge, no turning back."""
        arc = self.arc(named, around.points_mm[[0, -1], 1])
        (name, journal, axis), (under, other, far) = _journals(around.scene.throw, self.face)
        least = around.limits.min_wall_mm
        reach = arc.outward * axis + journal.clear_radius_mm
        shoulder = reach + least_shoulder_mm(around.scene.throw) + CLEAR_MM
        nearer = arc.start_mm - arc.outward * axis - _rounded_off_mm(arc, axis) if self.draft_deg else 0.0
        yield shoulder_rule(name.replace("_", " ")), shoulder + nearer - arc.start_mm
        yield f"least length of the {self.title}, {least:.3g} mm", least + arc.start_mm - arc.end_mm
        recess = other.recess_mm or 0.0
        wall = around.scene.web.thickness_mm - least - recess
        edge = f"under the edge of the {under.replace('_', ' ')}"
        rim = other.clear_radius_mm if recess else other.radius_mm
        yield wall_rule(edge, least), -_least_off_mm(arc, wall, arc.outward * far, rim)
        most = 0.95 * _twice_tangent(arc.end_mm - arc.start_mm, arc.depth_mm)
        yield f"the arc of the {self.title} does not turn back", 4 * arc.crown_mm - most
        draft_deg = around.limits.workshop.draft_deg
        if draft_deg:
            yield _draft_rule(arc, self.title, draft_deg)
        if self.draft_deg:
            yield from _draft_rules(arc, self.title, around)
        if self.hollow:
            yield f"the hollow arc of the {self.title} does not turn back", -4 * arc.crown_mm - most

    @override
    def tables(self, named: Named, frame_mm: Frame) -> list[dict[str, Any]]:
        draft = {"draft_deg": self.draft_deg} if self.draft_deg else {}
        return [{"face": self.face, **{f"{name}_mm": getattr(named, name) for name in self.names}, **draft}]

    @classmethod
    @override
    def read(cls, table: Feature, pair: bool, frame_mm: Frame) -> tuple[Self, Array] | None:
        if not isinstance(table, EndBevel):
            return None
        values = np.array([table.y_mm, table.depth_mm, table.crown_mm])
        return cls(table.face, hollow=True, draft_deg=table.draft_deg), values

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


def _draft_rules(arc: BevelArc, title: str, around: Surroundings) -> Iterator[Rule]:
    """Yield what a bevel with draft keeps: a wall and the other bevel at the outline, the counterweight.

    Place by place, each a smooth rule: the largest of all would be none.
    """
    (x, y), thickness = around.points_mm[::_EVERY].T, around.scene.web.thickness_mm
    deepest, least = around.limits.deepest_mm(thickness), around.limits.min_wall_mm
    depth = arc.depth_at_mm(arc.outward * y, x)
    yield f"most depth of the {title} at the outline, {deepest:.3g} mm", depth - deepest
    for other in around.arcs:
        if other.outward == arc.outward or (other.draft_deg and other.outward > arc.outward):
            continue  # itself, or the other one has the rule
        both = depth + other.depth_at_mm(other.outward * y, x) + around.wall_mm - thickness
        yield wall_rule("between the bevels", least), both
    for over in _over_weight_mm(around.scene, arc):
        yield f"the {title} stays clear of the counterweight", over + CLEAR_MM


def _draft_rule(arc: BevelArc, title: str, draft_deg: float) -> Rule:
    """Return the rule that an arc keeps its draft where it is steepest, as the rise that its chord lacks."""
    rise, run = arc.end_mm - arc.start_mm, arc.depth_mm
    chord = np.sqrt(rise**2 + run**2)
    steepest = np.arctan2(rise, run) - 2 * np.arctan(2 * np.abs(arc.crown_mm) / chord)
    across = np.cos(np.deg2rad(arc.draft_deg))
    missing = chord * (np.sin(np.deg2rad(draft_deg)) - np.sin(steepest) * across)
    return f"least draft of the {title}, {draft_deg:.3g} deg", missing


def _arc(
    face: str, y_mm: Any, depth: Any, crown_mm: Any, ends: tuple[Any, Any], draft_deg: float
) -> BevelArc:
    if face == "journal":
        return BevelArc(y_mm, ends[1], depth, crown_mm, 1.0, draft_deg)
    return BevelArc(-y_mm, -ends[0], depth, crown_mm, -1.0, draft_deg)


def _journals(throw: JournalsView, face: str) -> list[tuple[str, Any, float]]:
    """Return the journal that stands on a face, then the other: name, journal, place of its axis."""
    both = [("main_journal", throw.main_journal, 0.0), ("crankpin", throw.crankpin, throw.radius_mm)]
    return both if face == "journal" else both[::-1]


def _twice_tangent(rise: Any, run: Any) -> Any:
    """2 L tan(min(slope, 90 deg - slope) / 2): four times a crown this large makes the arc turn back."""
    chord = np.hypot(rise, run)
    shorter, longer = np.minimum(rise, run), np.maximum(rise, run)
    return 2 * chord * shorter / (chord + longer)
