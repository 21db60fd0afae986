"""Slot cut from both lateral faces, its walls sloped outward; longer than the outline it is a groove."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import Literal

import numpy as np
from pydantic import Field
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.base.table import Length, LengthOrZero, Place
from cranktopo.throw.bevel import height_range_mm
from cranktopo.throw.feature import Body, Feature, ForgingView, ThrowView
from cranktopo.throw.floor_rounding import FloorRounding, check_floor_corners, check_floor_radius
from cranktopo.throw.hole import check_corners, check_cut, check_depth
from cranktopo.throw.primitives import DimensionLine, FeatureDrawing, Polyline, number_lines
from cranktopo.throw.side_slots import BEYOND_MM, SideSlots

_DRAWN, _ON_MM = 400, 1e-6
"""Points at which an edge of the drawing is looked at; distance that counts as none."""


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
    floor_radius_mm: LengthOrZero = 0.0
    """Radius of the edge of its floor; 0 = sharp. But for a groove it needs corners as round."""

    @property
    def slope(self) -> float:
        """Opening of each wall per mm toward the side."""
        return math.tan(math.radians(self.draft_deg))

    @property
    def straight_mm(self) -> float:
        """Half of the length between its corners, where it is a groove."""
        return self.length_mm / 2 - self.corner_radius_mm

    def runs_out(self, low_mm: float, high_mm: float) -> bool:
        """Tell whether it is a groove through both ends of an outline between two places."""
        return self.y_mm - self.straight_mm <= low_mm and self.y_mm + self.straight_mm >= high_mm

    @override
    def bodies(self, scene: ThrowView, key: str) -> tuple[Body, ...]:
        return (self._slots(scene, key),)

    @override
    def forged(self, scene: ThrowView, key: str, forging: ForgingView) -> tuple[Body, ...]:
        """As it is where its walls have the draft of the die; where it runs out, through the raw end too."""
        if self.draft_deg < forging.draft_deg:
            return ()
        slots, (low, high) = self._slots(scene, key), scene.web.y_range_mm(scene.throw.radius_mm)
        straight, more = self.straight_mm, forging.draft_slope * slots.outer_mm
        below, above = (
            more if out else 0.0 for out in (self.y_mm - straight < low, self.y_mm + straight > high)
        )
        place, longer = self.y_mm + (above - below) / 2, (above + below) / 2
        return (replace(slots, y_mm=place, half_length_mm=slots.half_length_mm + longer),)

    @override
    def check_alone(self, scene: ThrowView, key: str) -> None:
        tall = self.height_mm + 2 * (self.slope * self.depth_mm + abs(self.offset_mm))
        check_depth(scene, f"{key}.height_mm", tall)
        sizes, rounding = (self.length_mm, self.height_mm), FloorRounding(self.floor_radius_mm, self.slope)
        check_corners(scene, f"{key}.corner_radius_mm", self.corner_radius_mm, *sizes)
        check_floor_radius(scene, key, rounding, self.depth_mm, *sizes)
        if self.corner_radius_mm or not self.runs_out(*scene.web.y_range_mm(scene.throw.radius_mm)):
            check_floor_corners(scene, key, rounding, self.corner_radius_mm)

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
        edges = _within(scene, np.column_stack([x, y]))
        front = tuple(
            Polyline(tuple((side * float(a), float(b)) for a, b in edge), hidden=True)
            for side in (1, -1)
            for edge in edges
        )
        groove = self.length_mm > ends[1] - ends[0]
        title = "GROOVE on both sides, through both ends" if groove else "POCKET side"
        unused = {name for name in ("corner_radius_mm", "floor_radius_mm") if not getattr(self, name)}
        lines = number_lines(title, self.model_dump(exclude={"shape", *unused}))
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
        radii = self.corner_radius_mm, self.floor_radius_mm
        return SideSlots(key, z_mm, floor, outer, *size, self.slope, *radii)


def _within(scene: ThrowView, corners: Array) -> list[Array]:
    """Return the edges between corners (n, 2) of a slot, each cut off where it leaves the outline."""
    share = np.linspace(0.0, 1.0, _DRAWN)[:, None]
    found = []
    for start, end in pairwise(corners):
        edge = start + share * (end - start)
        within = edge[edge[:, 0] <= scene.web.half_width_mm(scene.throw.radius_mm, edge[:, 1]) + _ON_MM]
        if len(within) > 1:
            found.append(within[[0, -1]])
    return found


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
