"""Views of the rod for its drawing: seen along the pins, cut along it, the section of its shank.

Distances from the rod to its dimension lines are millimetres of paper.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from math import cos, radians, sin
from typing import Any

import numpy as np

from cranktopo.base.fit import hole_limits_text, tolerance_um
from cranktopo.design.checks.rod import rod_of
from cranktopo.design.rod_body import fillet, shank_edge_mm
from cranktopo.design.schema import Scene
from cranktopo.report.drafting import (
    DROP_MM,
    THIN,
    centre_line,
    circle,
    datum,
    dimension,
    edges,
    finish,
    fits,
    hatched,
    leader,
    number_mm,
    tolerance_frame,
)
from cranktopo.tasks.drawing.sheet import SCALES, scale_text
from cranktopo.tasks.drawing.views import Room
from cranktopo.tasks.rod.drawing_split import (
    big_end_corners,
    boss_top_mm,
    draw_angle,
    draw_split,
    turned,
)
from cranktopo.tasks.rod.outlines import bush_cut, front_outline, lengthwise_cut, shank_cut

_GAP_MM, _LINE_MM = 7.0, 7.0
"""Paper to the first dimension line, and from one to the next."""
_SHANK_SHARE = 0.26
"""Largest size of the shank's section as it is drawn, over the length of the rod."""
_PARALLEL_GRADE, _ROUND_GRADE = 5, 4
"""Grades of ISO 286 whose tolerance at the bore's diameter is that of parallelism and of cylindricity."""
_ANGLE_MM = 2.0
"""Paper from the rod to the arc of the split's angle."""
_HATCH, _OTHER_HATCH = "////", "\\\\\\\\"


class RodViews:
    """The views of a rod; y along it from the axis of the big end, upward in both long views."""

    def __init__(self, scene: Scene) -> None:
        self._scene, (self.rod, self.length) = scene, rod_of(scene)

    @cached_property
    def _middle(self) -> float:
        """Place of the section A-A: half-way between both eyes."""
        rod = self.rod
        return (rod.big_end_diameter_mm + 2 * self.length - rod.small_end_diameter_mm) / 4

    @property
    def _half_width(self) -> float:
        rod = self.rod
        corners = 2 * float(np.abs(big_end_corners(rod)[:, 0]).max())
        return max(corners, rod.big_end_diameter_mm, rod.small_end_diameter_mm) / 2

    @property
    def _y_range(self) -> tuple[float, float]:
        rod = self.rod
        low = max(rod.big_end_diameter_mm / 2, -float(big_end_corners(rod)[:, 1].min()))
        return -low, self.length + rod.small_end_diameter_mm / 2

    @cached_property
    def _half_height(self) -> float:
        """Half the height of the shank in A-A."""
        return float(shank_edge_mm(self.rod, self.length, np.array([self._middle]))[0])

    @cached_property
    def _magnified(self) -> float:
        """Scale of the shank's section over that of the sheet."""
        size = max(2 * self._half_height, self.rod.shank_width_mm)
        return next((s for s in SCALES if s * size <= _SHANK_SHARE * self.length), SCALES[-1])

    @property
    def rooms(self) -> tuple[Room, Room, Room]:
        """Rooms of front view, section along and section of the shank."""
        rod, wide, y = self.rod, self._half_width, self._y_range
        under, above = _GAP_MM + 2 * _LINE_MM + 3.0, _GAP_MM + _LINE_MM + 5.0
        deep = max(rod.small_end_width_mm, rod.big_end_width_mm) / 2
        across, up = self._magnified * self._half_height, self._magnified * rod.shank_width_mm / 2
        reach = max(self._middle - y[0], y[1] - self._middle)
        return (
            Room((-wide, wide), y, (_GAP_MM + 2 * _LINE_MM, 40.0, under, above)),
            Room((-deep, deep), y, (6.0, 30.0, under, above)),
            Room((-across, across), (-min(up + reach / 2, reach), up), (18.0, 16.0, 14.0, 30.0)),
        )

    def front(self, axes: Any, scale: float) -> None:
        """Draw what is seen along the pins: eyes, shank, split, bolts; heights left, diameters right."""
        mm, rod = 1 / scale, self.rod
        hatched(axes, front_outline(rod, self.length), "")
        for at, bore in ((self.length, rod.small_end_bore_mm), (0.0, rod.big_end_bore_mm)):
            circle(axes, bore / 2, at, "-", 1.4, "white")
        if rod.bush_thickness_mm:
            circle(axes, rod.pin_diameter_mm / 2, self.length, "-", 1.0)
        self._shoulders(axes)
        draw_split(axes, self.rod, mm)
        if rod.split_angle_deg:
            draw_angle(axes, rod, self._half_width + _ANGLE_MM * mm, mm)
        low, high = self._y_range
        centre_line(axes, (0.0, low - 3 * mm), (0.0, high + 3 * mm))
        for at, reach in ((self.length, rod.small_end_diameter_mm / 2), (0.0, self._half_width)):
            centre_line(axes, (-reach - 3 * mm, at), (reach + 3 * mm, at))
        self._front_numbers(axes, mm)
        finish(axes, "Front")

    def _shoulders(self, axes: Any) -> None:
        """Draw what the outline holds: rims of the eyes over the shank, edges of pockets, oil hole."""
        rod, length = self.rod, self.length
        for at, outer, wide, toward in (
            (length, rod.small_end_diameter_mm / 2, rod.small_end_width_mm, -1.0),
            (0.0, rod.big_end_diameter_mm / 2, rod.big_end_width_mm, 1.0),
        ):
            if wide > rod.shank_width_mm:
                arc = fillet(rod, length, small=toward < 0)
                corner = rod.shank_small_mm / 2 if toward < 0 else rod.shank_big_mm / 2
                reach = min((arc.eye_x_mm if arc else corner) / outer, 1.0)
                open_rad = np.linspace(-1, 1, 61) * np.arcsin(reach)
                rim = np.column_stack([outer * np.sin(open_rad), at + toward * outer * np.cos(open_rad)])
                above = np.array([y > boss_top_mm(rod, x) for x, y in rim])
                edges(axes, [rim[above]] if toward > 0 else [rim])
        high = self._shank_ends(0.0)[1]
        taper = (rod.shank_small_mm - rod.shank_big_mm) / 2 / length
        for side in (-1, 1):
            if rod.shank == "I":
                low = self._shank_ends(side * rod.shank_big_mm / 2)[0]
                inside = [(side * (rod.shank_big_mm / 2 + taper * y - rod.flange_mm), y) for y in (low, high)]
                edges(axes, [np.array(inside)])
            if rod.shank == "H":
                low = self._shank_ends(side * rod.web_mm / 2)[0]
                self._hidden(axes, side * rod.web_mm / 2, low, high)
            if rod.oil_hole_mm:
                top, bottom = length - rod.small_end_bore_mm / 2, rod.big_end_bore_mm / 2
                self._hidden(axes, side * rod.oil_hole_mm / 2, bottom, top)

    def _shank_ends(self, x: float) -> tuple[float, float]:
        """Return places where the shank leaves both rims in its middle, and the bosses beside it."""
        rod = self.rod
        low = max(rod.big_end_diameter_mm / 2, boss_top_mm(rod, x))
        return low, self.length - rod.small_end_diameter_mm / 2

    @staticmethod
    def _hidden(axes: Any, x: float, low: float, high: float) -> None:
        axes.plot([x, x], [low, high], color=THIN, lw=0.7, ls="--")

    @property
    def _boss(self) -> float:
        """Half the width of the rod at its split."""
        return max(self.rod.boss_width_mm, self.rod.big_end_diameter_mm) / 2

    def _front_numbers(self, axes: Any, mm: float) -> None:
        rod, length, wide = self.rod, self.length, self._half_width
        second = -wide - (_GAP_MM + _LINE_MM) * mm
        if not rod.split_angle_deg:
            self._boss_numbers(axes, mm)
        tolerance = self._scene.drawing.rod_length_tolerance_mm
        split, top = (-self._boss, 0.0), (-rod.small_end_diameter_mm / 2, length)
        dimension(axes, split, top, (second + self._boss, 0.0), f"{length:g} ±{tolerance:g}")
        self._plane(axes, mm)
        last = np.inf
        for (x, y), text in sorted(self._callouts(mm), key=lambda one: -one[0][1]):
            last = min(y + (2.0 if y > 0 else -2.0) * mm, last - 4.5 * mm)
            leader(axes, (x, y), (wide + 3 * mm, last), text, "left")

    def _boss_numbers(self, axes: Any, mm: float) -> None:
        """Dimension the bosses of a square split; the table has those of an oblique one."""
        rod, low = self.rod, self._y_range[0]
        first, boss = -self._half_width - _GAP_MM * mm, -rod.boss_width_mm / 2
        for size, way in ((rod.boss_above_mm, 1.0), (rod.boss_below_mm, -1.0)):
            text, lift = f"{size:g}", (0.0, 0.0)
            if not fits(size, text, mm):  # beside the line, away from the other number
                lift = -DROP_MM * mm, way * max(number_mm(text) * mm - size, 0.0) / 2
            dimension(axes, (boss, 0.0), (boss, way * size), (first - boss, 0.0), text, lift, mm)
        under = -rod.boss_below_mm
        for number, size in enumerate((rod.bolt_distance_mm, rod.boss_width_mm)):
            shift = low - (_GAP_MM + number * _LINE_MM) * mm - under
            dimension(axes, (-size / 2, under), (size / 2, under), (0.0, shift), f"{size:g}")

    def _callouts(self, mm: float) -> Iterator[tuple[tuple[float, float], str]]:
        """Yield points of the outline with what is written beside them."""
        rod, length = self.rod, self.length
        eyes = [
            (45.0, length, rod.small_end_diameter_mm, f"⌀{rod.small_end_diameter_mm:g}"),
            (5.0, length, rod.small_end_bore_mm, self._bore_text(rod.small_end_bore_mm)),
            (30.0, 0.0, rod.big_end_bore_mm, self._bore_text(rod.big_end_bore_mm)),
            (-75.0, 0.0, rod.big_end_diameter_mm, f"⌀{rod.big_end_diameter_mm:g}"),
        ]
        if rod.bush_thickness_mm:
            inner = rod.pin_diameter_mm
            eyes.append((-35.0, length, inner, f"bush {self._bore_text(inner)}"))
        for deg, at, size, text in eyes:
            yield (size / 2 * cos(radians(deg)), at + size / 2 * sin(radians(deg))), text
        arc = fillet(rod, length, small=True)
        if arc is not None:
            y = (arc.edge_y_mm + arc.eye_y_mm) / 2
            yield (float(shank_edge_mm(rod, length, np.array([y]))[0]), y), f"4 x R{rod.shank_fillet_mm:g}"
        if rod.bolt is not None:
            head = (rod.bolt_distance_mm + rod.bolt.head_mm) / 2, -rod.boss_below_mm - 2 * mm
            x, y = turned(rod, [head])[0]
            yield (float(x), float(y)), f"2 x {rod.bolt.thread}"

    def _bore_text(self, size: float) -> str:
        return hole_limits_text(size, self._scene.drawing.rod_bore_fit)

    def _plane(self, axes: Any, mm: float) -> None:
        """Mark the plane of the section A-A."""
        reach = self._half_height
        for side in (-1, 1):
            start, end = side * (reach + 2 * mm), side * (reach + 7 * mm)
            axes.plot([start, end], [self._middle] * 2, color="k", lw=1.4, ls="-.")
            axes.text(end + side * 2.5 * mm, self._middle, "A", fontsize=9, ha="center", va="center")

    def lengthwise(self, axes: Any, scale: float) -> None:
        """Draw the section x = 0: widths, datum of the big end's bore, tolerances of both bores."""
        mm, rod, (low, high) = 1 / scale, self.rod, self._y_range
        hatched(axes, lengthwise_cut(rod, self.length), _HATCH)
        bush = bush_cut(rod, self.length)
        if bush:
            hatched(axes, bush, _OTHER_HATCH)
        self._seen_beyond(axes)
        for at in (0.0, self.length):
            wide = max(rod.small_end_width_mm, rod.big_end_width_mm) / 2
            centre_line(axes, (-wide - 3 * mm, at), (wide + 3 * mm, at))
        small, big = rod.small_end_width_mm / 2, rod.big_end_width_mm / 2
        edge = -rod.big_end_diameter_mm / 2
        shift = low - _GAP_MM * mm - edge
        dimension(axes, (-big, edge), (big, edge), (0.0, shift), f"{2 * big:g}", mm=mm)
        dimension(axes, (-small, high), (small, high), (0.0, _GAP_MM * mm), f"{2 * small:g}", mm=mm)
        beside = max(small, big) + 4 * mm
        bottom = self.length - rod.pin_diameter_mm / 2
        leader(axes, (small, bottom), (beside, bottom - 8 * mm), "", "left")
        um = tolerance_um(rod.small_end_bore_mm, _PARALLEL_GRADE)
        tolerance_frame(axes, beside, bottom - 10.5 * mm, ("∥", f"{um / 1000:g}", "B"), mm)
        top = rod.big_end_bore_mm / 2
        leader(axes, (big, top), (beside, top + 5 * mm), "", "left")
        um = tolerance_um(rod.big_end_bore_mm, _ROUND_GRADE)
        tolerance_frame(axes, beside, top + 2.5 * mm, ("/○/", f"{um / 1000:g}"), mm)
        datum(axes, beside + 12 * mm, top + 2.5 * mm, "B", mm)
        finish(axes, "Section x = 0")

    def _seen_beyond(self, axes: Any) -> None:
        """Draw rims of both bores, flanges and the split beyond the section."""
        rod, length, chains = self.rod, self.length, []
        for at, bore, width in (
            (length, rod.pin_diameter_mm, rod.small_end_width_mm),
            (0.0, rod.big_end_bore_mm, rod.big_end_width_mm),
        ):
            low, high, z = at - bore / 2, at + bore / 2, width / 2
            chains += [np.array([(side * z, low), (side * z, high)]) for side in (-1, 1)]
        split = -rod.big_end_bore_mm / 2 * sin(radians(rod.split_angle_deg))
        chains.append(np.array([(-rod.big_end_width_mm / 2, split), (rod.big_end_width_mm / 2, split)]))
        low, high = self._shank_ends(0.0)
        z = rod.shank_width_mm / 2
        if rod.shank == "I":
            chains += [np.array([(side * z, low), (side * z, high)]) for side in (-1, 1)]
        edges(axes, chains)

    def shank(self, axes: Any, scale: float) -> None:
        """Draw the section A-A of the shank."""
        factor, mm, rod = self._magnified, 1 / scale, self.rod
        hatched(axes, [factor * polygon for polygon in shank_cut(rod, self.length, self._middle)], _HATCH)
        x, z = factor * self._half_height, factor * rod.shank_width_mm / 2
        centre_line(axes, (-x - 3 * mm, 0.0), (x + 3 * mm, 0.0))
        centre_line(axes, (0.0, -z - 3 * mm), (0.0, z + 3 * mm))
        gap = _GAP_MM * mm
        dimension(axes, (-x, -z), (x, -z), (0.0, -gap), f"{2 * self._half_height:.2f}", mm=mm)
        dimension(axes, (-x, -z), (-x, z), (-gap, 0.0), f"{rod.shank_width_mm:g}", mm=mm)
        flange, web = factor * rod.flange_mm, factor * rod.web_mm / 2
        up = (0.0, 2.6 * mm)
        if rod.shank == "I":
            dimension(axes, (x - flange, z), (x, z), (0.0, gap), f"{rod.flange_mm:g}", up, mm)
            dimension(axes, (x, -web), (x, web), (gap, 0.0), f"{rod.web_mm:g}", (3.0 * mm, 0.0), mm)
        if rod.shank == "H":
            dimension(axes, (-web, z), (web, z), (0.0, gap), f"{rod.web_mm:g}", up, mm)
            dimension(axes, (x, z - flange), (x, z), (gap, 0.0), f"{rod.flange_mm:g}", (3.0 * mm, 0.0), mm)
        if rod.oil_hole_mm:
            tip = factor * rod.oil_hole_mm / 2
            leader(
                axes, (0.7 * tip, -0.7 * tip), (x * 0.6, -z - gap - _LINE_MM * mm), f"⌀{rod.oil_hole_mm:g}"
            )
        title = f"A-A, y = {self._middle:.2f}, {scale_text(scale * factor)}"
        axes.text(0.0, z + gap + 9 * mm, title, fontsize=10, ha="center", color=THIN)
        finish(axes, "")
