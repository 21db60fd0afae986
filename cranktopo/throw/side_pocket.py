"""Slot cut from both lateral faces, its walls sloped outward; longer than the outline it is a groove."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, Literal, Self

import numpy as np
from pydantic import Field
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.base.table import Length, LengthOrZero, Place
from cranktopo.throw.bevel import height_range_mm
from cranktopo.throw.bevel_arc import BevelArc
from cranktopo.throw.feature import Body, Feature, ForgingView, ThrowView
from cranktopo.throw.fitted import (
    CLEAR_MM,
    JOURNALS,
    LEAST_MM,
    SIZE_OVER_CORNER,
    Axes,
    BodyCells,
    FittedToSections,
    Frame,
    Named,
    Rule,
    Surroundings,
    wall_rule,
)
from cranktopo.throw.hole import BEYOND_MM, SideSlots, check_corners, check_cut, check_depth
from cranktopo.throw.manufacturing_limits import ManufacturingLimits
from cranktopo.throw.primitives import DimensionLine, FeatureDrawing, Polyline, number_lines
from cranktopo.throw.tapered_hole import rounded_gap_mm

_LARGEST_DRAFT_DEG = 45.0
_FIRST_DRAFT_DEG = 10.0
_LEAST_LENGTH_MM = 6.0
_LEAST_DEPTH_MM = 1.0
_ROUNDING_MM = 1e-6
_ENDLESS_MM = 1e4


class SidePocket(Feature):
    """Slot cut from both lateral faces, symmetric in x.

    Length and height are those of its floor, the innermost face; its walls open outward by the draft angle.
    Its middle lies `offset_mm` from the web's mid-plane toward the pin.
    """

    shape: Literal["side"]
    y_mm: Place = Field(examples=[24.0])
    """Centre along the throw, from the crank axis toward the crankpin."""
    length_mm: Length = Field(examples=[20.0])
    """Length of its floor along the throw; longer than the outline: a groove that runs out at both ends."""
    height_mm: Length = Field(examples=[8.0])
    """Height of its floor along the crank axis."""
    depth_mm: Length = Field(examples=[5.0])
    """Depth of its floor below the largest half-width of the web."""
    offset_mm: Place = 0.0
    """Distance of its middle from the web's mid-plane, toward the pin."""
    draft_deg: float = Field(default=0.0, ge=0, le=60)
    """Draft angle: the walls open outward by it."""
    corner_radius_mm: LengthOrZero = 0.0
    """Radius of the four corners of its floor; 0 = sharp."""

    @property
    def slope(self) -> float:
        """Opening of each wall per mm toward the side."""
        return math.tan(math.radians(self.draft_deg))

    @override
    def bodies(self, scene: ThrowView, key: str) -> tuple[Body, ...]:
        return (self._slots(scene, key),)

    @override
    def forged(self, scene: ThrowView, key: str, forging: ForgingView) -> tuple[Body, ...]:
        """As it is where its walls have the draft of the die; where it runs out, through the raw end too."""
        if self.draft_deg < forging.draft_deg:
            return ()
        slots, (low, high) = self._slots(scene, key), scene.web.y_range_mm(scene.throw.radius_mm)
        straight, more = self.length_mm / 2 - self.corner_radius_mm, forging.draft_slope * slots.outer_mm
        below, above = (
            more if out else 0.0 for out in (self.y_mm - straight < low, self.y_mm + straight > high)
        )
        place, longer = self.y_mm + (above - below) / 2, (above + below) / 2
        return (replace(slots, y_mm=place, half_length_mm=slots.half_length_mm + longer),)

    @override
    def check_alone(self, scene: ThrowView, key: str) -> None:
        tall = self.height_mm + 2 * (self.slope * self.depth_mm + abs(self.offset_mm))
        check_depth(scene, f"{key}.height_mm", tall)
        check_corners(scene, f"{key}.corner_radius_mm", self.corner_radius_mm, self.length_mm, self.height_mm)

    @override
    def check_in_web(self, scene: ThrowView, key: str) -> None:
        slots = self._slots(scene, key)
        check_cut(scene, slots)
        if self.slope > 0:
            _check_bevels(scene, slots)
            _check_apart(scene, slots)

    @override
    def drawing(self, scene: ThrowView) -> FeatureDrawing:
        web = scene.web
        ends, widest = web.y_range_mm(scene.throw.radius_mm), web.largest_half_width_mm
        floor, half, more = widest - self.depth_mm, self.length_mm / 2, self.slope * self.depth_mm
        y = np.clip(self.y_mm + np.array([-half - more, -half, half, half + more]), *ends)
        x = (widest, floor, floor, widest)
        front = tuple(
            Polyline(tuple((side * a, float(b)) for a, b in zip(x, y, strict=True)), hidden=True)
            for side in (1, -1)
        )
        groove = self.length_mm > ends[1] - ends[0]
        title = "GROOVE on both sides, through both ends" if groove else "POCKET side"
        unused = {"shape"} if self.corner_radius_mm else {"shape", "corner_radius_mm"}
        lines = number_lines(title, self.model_dump(exclude=unused))
        places = () if groove else ((floor, self.y_mm),)
        return FeatureDrawing(front, (), self._across(scene, floor), self.y_mm, lines, places=places)

    def _across(self, scene: ThrowView, floor: float) -> tuple[DimensionLine, ...]:
        start, end = scene.web_z_mm
        here = np.array([self.y_mm])
        out = float(scene.web.half_width_mm(scene.throw.radius_mm, here)[0]) - floor + 7
        middle, tall = (start + end) / 2 + self.offset_mm, self.height_mm / 2
        height = DimensionLine(
            (floor, middle - tall), (floor, middle + tall), (out, 0), f"{self.height_mm:.2f}"
        )
        return height, DimensionLine((-floor, end), (floor, end), (0, 6), f"{2 * floor:.2f}")

    def _slots(self, scene: ThrowView, key: str) -> SideSlots:
        widest, (start, end) = scene.web.largest_half_width_mm, scene.web_z_mm
        floor = widest - self.depth_mm
        outer = widest + BEYOND_MM if self.slope > 0 else 2 * widest
        middle, tall = (start + end) / 2 + self.offset_mm, self.height_mm / 2 + self.slope * (outer - floor)
        size = (self.y_mm, self.length_mm / 2, middle, self.height_mm / 2)
        z_mm = (middle - tall, middle + tall)
        return SideSlots(key, z_mm, floor, outer, *size, self.slope, self.corner_radius_mm)


def _check_bevels(scene: ThrowView, slots: SideSlots) -> None:
    """Sloped walls stay inside the bevels, unless the slot runs through both ends of the web."""
    start, ends = scene.web_z_mm[0], scene.web.y_range_mm(scene.throw.radius_mm)
    y = np.linspace(*slots.y_range_mm, 401)
    half = scene.web.half_width_mm(scene.throw.radius_mm, y)
    height = slots.half_height_mm + slots.slope * (half - slots.floor_mm)
    middle = slots.z_centre_mm - start
    cut = half > slots.open_from_mm(y, slots.z_centre_mm)
    through = abs(slots.y_mm - sum(ends) / 2) + (ends[1] - ends[0]) / 2 <= slots.half_length_mm
    low, high = height_range_mm(scene, y, slots.floor_mm if through else half)
    sunk = cut & ((middle + slots.half_height_mm < low) | (middle - slots.half_height_mm > high))
    if through and sunk.any():
        raise CranktopoError(
            f"{slots.key}: a bevel takes off its whole floor.", hint="Heighten the floor or move it inward."
        )
    if not through and (cut & ((middle - height < low) | (middle + height > high))).any():
        raise CranktopoError(
            f"{slots.key}: its sloped walls run into a bevel.", hint="Shorten the pocket or the bevel."
        )


def _sunk_mm(arc: BevelArc, bottom_mm: Any, floor_mm: Any, points_mm: Array) -> Array:
    """Return how far a bevel reaches below a groove's floor where the groove cuts, mm; <= 0 for nowhere.

    It is the largest of all places; of a bevel with draft, which may reach it along the whole web, each, so
    that all are smooth.

    Args:
        bottom_mm: depth of the floor's far edge below the bevel's face.
        floor_mm: half-width at the floor.
        points_mm: (n, 2) points of the outline's right half; between two of them the worse counts.
    """
    depth = arc.depth_at_mm(arc.outward * points_mm[:, 1], floor_mm) + CLEAR_MM - bottom_mm
    width = points_mm[:, 0] + CLEAR_MM - floor_mm
    below, cut = (np.maximum(values[:-1], values[1:]) for values in (depth, width))
    sunk = np.minimum(below, cut)
    return sunk if arc.draft_deg else sunk.max(keepdims=True)


def _check_apart(scene: ThrowView, slots: SideSlots) -> None:
    y = np.linspace(*slots.y_range_mm, 401)
    own = slots.spans(y, np.asarray(slots.z_centre_mm))
    others = (
        body
        for index, pocket in enumerate(scene.web.pocket)
        for body in pocket.bodies(scene, f"web.pocket[{index}]")
    )
    for other in others:
        if other.key == slots.key or other.z_mm[0] >= slots.z_mm[1] or other.z_mm[1] <= slots.z_mm[0]:
            continue
        for a0, a1 in own:
            for b0, b1 in other.spans(y, np.asarray(sum(other.z_mm) / 2)):
                if (np.minimum(a1, b1) > np.maximum(a0, b0)).any():
                    raise CranktopoError(f"{slots.key}: meets {other.key}.", hint="Move them apart.")


@dataclass(frozen=True)
class FittedSlot(FittedToSections):
    """A side pocket of the re-model; `through` makes it a groove through both ends, which has no corners.

    The radius of the corners is the workshop's, not free.
    """

    through: bool = False
    corner_radius_mm: float = 0.0

    @property
    @override
    def label(self) -> str:
        return "groove" if self.through else "side"

    @property
    @override
    def title(self) -> str:
        return "groove" if self.through else "side pocket"

    @property
    @override
    def names(self) -> tuple[str, ...]:
        return (*(() if self.through else ("y", "length")), "height", "floor", "offset", "draft")

    @override
    def bounds(self, scene: ThrowView, limits: ManufacturingLimits) -> list[tuple[float, float]]:
        thickness, far = scene.web.thickness_mm, 4 * scene.throw.radius_mm
        smallest = max(LEAST_MM, SIZE_OVER_CORNER * self.corner_radius_mm)
        ranges = {
            "y": (-far, far),
            "length": (smallest, far),
            "height": (smallest, max(thickness, smallest)),
            "floor": (LEAST_MM, far),
            "offset": (-thickness / 2, thickness / 2),
            "draft": (limits.min_draft_deg, _LARGEST_DRAFT_DEG),
        }
        return [ranges[name] for name in self.names]

    @override
    def faces_mm(self, named: Named, ends: Array, at: Axes, web_z_mm: tuple[float, float]) -> list[Array]:
        (x, y, z), angle = at, np.deg2rad(named["draft"])
        deep = x - named["floor"]
        opening = deep * np.tan(angle)
        height = np.abs(z - (web_z_mm[0] + web_z_mm[1]) / 2 - named["offset"])
        walls = [height - named["height"] / 2]
        if not self.through:
            walls.append(np.abs(y - named["y"]) - named["length"] / 2)
        if self.corner_radius_mm:
            walls = [rounded_gap_mm(walls[0], walls[1], self.corner_radius_mm)]
        walls = [wall - opening for wall in walls]
        return [-deep, *(wall * np.cos(angle) for wall in walls)]

    @override
    def manufactured(self, limits: ManufacturingLimits) -> Self | None:
        shop = limits.workshop
        if shop.opens == "faces" or self.through:
            return None if shop.opens == "faces" else self
        return replace(self, corner_radius_mm=max(self.corner_radius_mm, shop.radius_mm))

    @override
    def possible(self, scene: ThrowView) -> bool:
        return not self.through or scene.web.counterweight is None

    def rules(self, named: Named, around: Surroundings) -> Iterator[Rule]:
        """Flanges on both sides, walls toward bores and, unless it runs through them, bevels."""
        scene, slope = around.scene, np.tan(np.deg2rad(named["draft"]))
        deep, offset, wall = around.widest_mm - named["floor"], named["offset"], around.wall_mm
        tall = named["height"] / 2 + slope * deep
        least, own = around.limits.min_wall_mm, f"between the {self.title} and"
        yield f"least depth of the {self.title}, {_LEAST_DEPTH_MM:.3g} mm", _LEAST_DEPTH_MM - deep
        flange = tall + np.abs(offset) + wall - scene.web.thickness_mm / 2
        yield wall_rule(f"beside the {self.title}", least), flange
        if not self.through and scene.web.counterweight is not None:
            low = named["y"] - named["length"] / 2 - slope * (deep + BEYOND_MM)
            # No fillet rises above the crank axis by more than twice its radius.
            rise = 2 * (scene.web.counterweight.fillet_mm or 0.0)
            yield f"the {self.title} stays clear of the counterweight", rise + CLEAR_MM - low
        for name, (journal, y) in zip(JOURNALS, scene.throw.journals, strict=True):
            if journal.bore_radius_mm:
                beyond = 0.0 if self.through else max(abs(y - named["y"]) - named["length"] / 2, 0.0)
                gap = np.hypot(named["floor"], beyond)
                yield wall_rule(f"{own} the bore of the {name}", least), journal.bore_radius_mm + wall - gap
        for arc in () if self.through else around.arcs:
            reach = arc.outward * named["y"] + named["length"] / 2 + slope * deep
            depth = scene.web.thickness_mm / 2 + offset * arc.outward
            away = arc.distance_mm(depth - tall, reach, around.widest_mm)
            yield wall_rule(f"{own} the {arc.title}", least), wall - away
        for arc in around.arcs if self.through else ():
            bottom = scene.web.thickness_mm / 2 + offset * arc.outward + named["height"] / 2
            for sunk in _sunk_mm(arc, bottom, named["floor"], around.points_mm):
                yield f"the {arc.title} leaves a part of the groove's floor", sunk

    @override
    def box_mm(self, named: Named, around: Surroundings) -> Array:
        opening = np.tan(np.deg2rad(named["draft"])) * (around.widest_mm - named["floor"])
        length, height = named.get("length", _ENDLESS_MM) / 2 + opening, named["height"] / 2 + opening
        y, z = named.get("y", 0.0), around.scene.web.thickness_mm / 2 + named["offset"]
        return np.array([[named["floor"], y - length, z - height], [_ENDLESS_MM, y + length, z + height]])

    @override
    def tables(self, named: Named, frame_mm: Frame) -> list[dict[str, Any]]:
        low, high, widest = frame_mm
        values = dict(named)
        draft, depth = values.pop("draft"), widest - values.pop("floor")
        if self.through:
            values |= {"y": (low + high) / 2, "length": high - low + 2 * BEYOND_MM}
        lengths = {f"{name}_mm": value for name, value in values.items()}
        corner = {"corner_radius_mm": self.corner_radius_mm} if self.corner_radius_mm else {}
        return [{"shape": "side", **lengths, "depth_mm": depth, "draft_deg": draft, **corner}]

    @classmethod
    @override
    def read(cls, table: Feature, pair: bool, frame_mm: Frame) -> tuple[Self, Array] | None:
        if not isinstance(table, SidePocket):
            return None
        low, high, widest = frame_mm
        half = table.length_mm / 2
        through = table.y_mm - half <= low and table.y_mm + half >= high
        place = [] if through else [table.y_mm, table.length_mm]
        own = [table.height_mm, widest - table.depth_mm, table.offset_mm, table.draft_deg]
        return cls(through, table.corner_radius_mm), np.array([*place, *own])

    def guess(self, cells: BodyCells, scene: ThrowView, limits: ManufacturingLimits) -> Array | None:
        """Initial values where the middle of the body is narrower than both faces; None where it is not."""
        outer = cells.x_mm + cells.cell_mm[0] / 2
        extent = (cells.solid * outer[:, None, None]).max(axis=0)
        layers = extent.shape[1]
        third = max(1, layers // 3)
        middle = extent[:, third : layers - third].min(axis=1)
        depth = np.minimum(extent[:, :third].max(axis=1), extent[:, layers - third :].max(axis=1)) - middle
        if depth.max() <= _ROUNDING_MM:
            return None
        inside = np.flatnonzero(depth > depth.max() / 2 + _ROUNDING_MM)
        y, floor = cells.y_mm[inside], float(np.median(middle[inside]))
        place = [] if self.through else [y.mean(), max(y[-1] - y[0], _LEAST_LENGTH_MM)]
        return np.array([*place, scene.web.thickness_mm / 4, floor, 0.0, _FIRST_DRAFT_DEG])
