"""The fits of side pockets and of grooves: walls, rules, tables and initial values."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.throw.bevel_arc import BevelArc
from cranktopo.throw.feature import Feature, ThrowView
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
from cranktopo.throw.fitted_floor import FittedFloor
from cranktopo.throw.floor_rounding import FloorRounding
from cranktopo.throw.manufacturing_limits import ManufacturingLimits
from cranktopo.throw.side_pocket import SidePocket
from cranktopo.throw.side_slots import BEYOND_MM
from cranktopo.throw.tapered_hole import rounded_gap_mm

_LARGEST_DRAFT_DEG = 45.0
_FIRST_DRAFT_DEG = 10.0
_LEAST_LENGTH_MM = 6.0
_LEAST_DEPTH_MM = 1.0
_ROUNDING_MM = 1e-6
_ENDLESS_MM = 1e4
_RADII = "corner_radius_mm", "floor_radius_mm"


@dataclass(frozen=True)
class FittedSlot(FittedFloor, FittedToSections):
    """A side pocket of the re-model; `through` makes it a groove through both ends, which has no corners.

    The radii of the corners and of the edge of the floor are the workshop's, not free.
    """

    through: bool = False
    corner_radius_mm: float = 0.0
    floor_radius_mm: float = 0.0

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
        foot = FloorRounding(self.floor_radius_mm, np.tan(np.deg2rad(limits.min_draft_deg))).foot_mm
        smallest = max(LEAST_MM, SIZE_OVER_CORNER * max(self.corner_radius_mm, foot))
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
    def sharp_mm(self, named: Named, at: Axes, web_z_mm: tuple[float, float]) -> list[Array]:
        angle, deep = np.deg2rad(named.draft), at[0] - named.floor
        opening = deep * np.tan(angle)
        walls = [wall - opening for wall in self._walls_mm(named, at, web_z_mm)]
        return [-deep, *(wall * np.cos(angle) for wall in walls)]

    def _walls_mm(self, named: Named, at: Axes, web_z_mm: tuple[float, float]) -> list[Array]:
        """Distances in the plane of its floor from where its walls meet it, negative in the pocket."""
        above = np.abs(at[2] - (web_z_mm[0] + web_z_mm[1]) / 2 - named.offset) - named.height / 2
        if self.through:
            return [above]
        beyond = np.abs(at[1] - named.y) - named.length / 2
        return (
            [rounded_gap_mm(above, beyond, self.corner_radius_mm)]
            if self.corner_radius_mm
            else [above, beyond]
        )

    @override
    def floor_mm(self, named: Named, at: Axes, web_z_mm: tuple[float, float]) -> Array:
        return named.floor - at[0]

    @override
    def growth_mm(self, named: Named, at: Axes, web_z_mm: tuple[float, float]) -> Array:
        (growth,) = self._walls_mm(named, at, web_z_mm)
        return growth

    @override
    def slope(self, named: Named) -> float:
        return float(np.tan(np.deg2rad(named.draft)))

    def shallowest_mm(self, draft_deg: float) -> float:
        """Return the least depth, which holds the round edge of the floor."""
        return max(_LEAST_DEPTH_MM, self.rounding(Named(draft=draft_deg)).top_mm + CLEAR_MM)

    @override
    def manufactured(self, limits: ManufacturingLimits) -> Self | None:
        shop = limits.workshop
        if shop.opens == "faces":
            return None
        if self.through:
            return replace(self, floor_radius_mm=max(self.floor_radius_mm, shop.groove_radius_mm))
        corner = max(self.corner_radius_mm, shop.radius_mm, shop.side_floor_radius_mm)
        floor = max(self.floor_radius_mm, shop.side_floor_radius_mm)
        return replace(self, corner_radius_mm=corner, floor_radius_mm=floor)

    @override
    def possible(self, scene: ThrowView) -> bool:
        return not self.through or scene.web.counterweight is None

    def rules(self, named: Named, around: Surroundings) -> Iterator[Rule]:
        """Flanges on both sides, walls toward bores and, unless it runs through them, bevels."""
        scene, slope = around.scene, np.tan(np.deg2rad(named.draft))
        deep, offset, wall = around.widest_mm - named.floor, named.offset, around.wall_mm
        tall = named.height / 2 + slope * deep
        least, own = around.limits.min_wall_mm, f"between the {self.title} and"
        rounding, shallowest = self.rounding(named), self.shallowest_mm(named.draft)
        yield f"least depth of the {self.title}, {shallowest:.3g} mm", shallowest - deep
        recess = max(journal.recess_mm or 0.0 for journal, _ in scene.throw.journals)
        flange = tall + np.abs(offset) + recess + wall - scene.web.thickness_mm / 2
        yield wall_rule(f"beside the {self.title}", least), flange
        if not self.through and scene.web.counterweight is not None:
            low = named.y - named.length / 2 - slope * (deep + BEYOND_MM)
            # No fillet rises above the crank axis by more than twice its radius.
            rise = 2 * (scene.web.counterweight.fillet_mm or 0.0)
            yield f"the {self.title} stays clear of the counterweight", rise + CLEAR_MM - low
        for name, (journal, y) in zip(JOURNALS, scene.throw.journals, strict=True):
            if journal.bore_radius_mm:
                beyond = 0.0 if self.through else max(abs(y - named.y) - named.length / 2, 0.0)
                gap = np.hypot(named.floor, beyond)
                yield wall_rule(f"{own} the bore of the {name}", least), journal.bore_radius_mm + wall - gap
        for arc in () if self.through else around.arcs:
            reach = arc.outward * named.y + named.length / 2 + slope * deep
            depth = scene.web.thickness_mm / 2 + offset * arc.outward
            away = arc.distance_mm(depth - tall, reach, around.widest_mm)
            yield wall_rule(f"{own} the {arc.title}", least), wall - away
        for arc in around.arcs if self.through else ():
            flat = named.height / 2 - rounding.foot_mm
            bottom = scene.web.thickness_mm / 2 + offset * arc.outward + flat
            sunk = _sunk_mm(arc, bottom, named.floor, around.points_mm)
            yield f"the {arc.title} leaves a part of the groove's floor", sunk

    @override
    def box_mm(self, named: Named, around: Surroundings) -> Array:
        opening = np.tan(np.deg2rad(named.draft)) * (around.widest_mm - named.floor)
        length = (_ENDLESS_MM if self.through else named.length) / 2 + opening
        height = named.height / 2 + opening
        y, z = named.y, around.scene.web.thickness_mm / 2 + named.offset
        return np.array([[named.floor, y - length, z - height], [_ENDLESS_MM, y + length, z + height]])

    @override
    def tables(self, named: Named, frame_mm: Frame) -> list[dict[str, Any]]:
        low, high, widest = frame_mm
        whole = (low + high) / 2, high - low + 2 * BEYOND_MM
        y, length = whole if self.through else (named.y, named.length)
        table = {
            "shape": "side",
            "y_mm": y,
            "length_mm": length,
            "height_mm": named.height,
            "offset_mm": named.offset,
            "depth_mm": widest - named.floor,
            "draft_deg": named.draft,
        }
        return [table | {name: radius for name in _RADII if (radius := getattr(self, name))}]

    @classmethod
    @override
    def read(cls, table: Feature, pair: bool, frame_mm: Frame) -> tuple[Self, Array] | None:
        if not isinstance(table, SidePocket):
            return None
        low, high, widest = frame_mm
        through = table.runs_out(low, high)
        place = [] if through else [table.y_mm, table.length_mm]
        own = [table.height_mm, widest - table.depth_mm, table.offset_mm, table.draft_deg]
        corner = 0.0 if through else table.corner_radius_mm
        return cls(through, corner, table.floor_radius_mm), np.array([*place, *own])

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
