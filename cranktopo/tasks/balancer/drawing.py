"""Workshop drawing of a balancer shaft: its end, half a section along it, a groove magnified, all numbers.

Lengths are in mm. Distances from the shaft to its dimension lines are millimetres of paper.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from itertools import pairwise
from math import cos, radians, sin
from pathlib import Path
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.files import replacing
from cranktopo.base.fit import limits_text
from cranktopo.design.balancer import BalancerPart, ShaftNotch
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.schema import Scene
from cranktopo.design.strength import material_notes
from cranktopo.report.drafting import (
    DROP_MM,
    INK,
    TEXT_SIZE,
    THIN,
    centre_line,
    circle,
    dimension,
    edges,
    finish,
    fits,
    hatched,
    leader,
)
from cranktopo.tasks.balancer.stage import (
    check_balancer,
    is_thrust,
    part_material,
    ruling_section,
)
from cranktopo.tasks.drawing.sheet import SheetPage, write_pages
from cranktopo.tasks.drawing.views import Room

_GAP_MM, _LINE_MM, _MARK_MM = 8.0, 7.0, 5.0
"""Paper to the first dimension line, from one to the next, and of a mark of a place."""
_CALLOUT_MM = 5.5
"""Paper of a line above the shaft that tells a diameter."""
_CALLOUT_ROWS = 3
_DETAIL, _DETAIL_MM = 20.0, 1.6
"""Scale of the detail over that of the sheet, and its radius over what it shows."""
_ARC = np.radians(np.linspace(180.0, 360.0, 13))


def draw_balancer(design: DesignLike, path: Path | str) -> None:
    """Write the drawing of a design's balancer shaft, A3 (.pdf, .svg or .png).

    Raises:
        CranktopoError: as `check_balancer`, or the file cannot be written.
    """
    scene, path = as_scene(design), Path(path)
    page = balancer_page(scene)
    with replacing(path) as temporary:
        write_pages([page], scene.name, [temporary])


def balancer_page(scene: Scene) -> SheetPage:
    """Return the page of a design's balancer shaft; raises CranktopoError as `check_balancer`."""
    found = check_balancer(scene)
    assert scene.balancer is not None
    views = _ShaftViews(scene, scene.balancer)
    material = part_material(scene, scene.balancer)
    return SheetPage(
        rooms=views.rooms,
        views=(views.end, views.lengthwise, views.detail),
        lines=[*views.lines],
        title=f"{scene.name}: balancer shaft",
        material=material.name,
        mass=f"{found.mass_kg:.3f} kg without the masses on it",
        notes=[
            f"General tolerances {scene.drawing.general_tolerances} unless stated.",
            f"Seats ground, Ra {scene.drawing.journal_roughness_um:g} µm; bores Ra "
            f"{scene.drawing.bore_roughness_um:g} µm; grooves Ra {scene.drawing.fillet_roughness_um:g} µm.",
            *material_notes(material, ruling_section(scene.balancer)),
        ],
    )


class _ShaftViews:
    """The views of a shaft; places along it to the right, from z = 0."""

    def __init__(self, scene: Scene, part: BalancerPart) -> None:
        self._scene, self._part = scene, part
        self._ends = [0.0, *(end for _, _, end in part.steps)]

    @property
    def _radius(self) -> float:
        return max(step.diameter_mm for step in self._part.step) / 2

    @cached_property
    def _groove(self) -> ShaftNotch | None:
        return next((notch for notch in self._part.notch if notch.kind == "groove"), None)

    @cached_property
    def _marks(self) -> dict[float, str]:
        """Letters and numbers of what is at every place."""
        part = self._part
        groups: tuple[tuple[str, Sequence[Any]], ...] = (
            ("B", part.bearing),
            ("M", part.weight),
            ("N", part.notch),
            ("P", part.probe),
        )
        found = [("G", part.gear.z_mm)] if part.gear else []
        found += [(f"{letter}{n}", one.z_mm) for letter, ones in groups for n, one in enumerate(ones, 1)]
        return {z: ", ".join(name for name, at in found if at == z) for _, z in found}

    @property
    def rooms(self) -> tuple[Room, Room, Room]:
        """Rooms of end, section and detail."""
        r, length = self._radius, self._ends[-1]
        around, under = 1.2 * _GAP_MM, 2 * _MARK_MM + _GAP_MM + 2 * _LINE_MM + 6.0
        above = _GAP_MM + _CALLOUT_ROWS * _CALLOUT_MM + 4.0
        detail = _DETAIL * self._detail_mm
        return (
            Room((-r, r), (-r, r), (around, around, under, above)),
            Room((0.0, length), (-r, r), (around, 2 * _GAP_MM, under, above)),
            Room((-detail, detail), (-detail, detail), (4 * _GAP_MM, 5 * _GAP_MM, 4.0, _GAP_MM)),
        )

    @property
    def _detail_mm(self) -> float:
        """Radius of what the detail shows, mm of the shaft."""
        if self._groove is None:
            return self._radius / _DETAIL
        outer = self._part.section_at(self._groove.z_mm)[0]
        return _DETAIL_MM * max((outer - self._groove.diameter_mm) / 2, self._groove.radius_mm)

    def end(self, axes: Any, scale: float) -> None:
        """Draw the shaft from its far end, at the left by first-angle projection; where masses pull."""
        mm, r = 1 / scale, self._radius
        highest = 0.0
        for step in reversed(self._part.step):
            hidden = step.diameter_mm / 2 < highest
            circle(axes, step.diameter_mm / 2, 0.0, "--" if hidden else "-", 1.0)
            highest = max(highest, step.diameter_mm / 2)
        if self._part.step[-1].bore_mm:
            circle(axes, self._part.step[-1].bore_mm / 2, 0.0, "-", 1.0)
        centre_line(axes, (-r - 4 * mm, 0.0), (r + 4 * mm, 0.0))
        centre_line(axes, (0.0, -r - 4 * mm), (0.0, r + 4 * mm))
        names_by_angle: dict[float, list[str]] = {}
        for number, weight in enumerate(self._part.weight, 1):
            names_by_angle.setdefault(weight.deg % 360, []).append(f"M{number}")
        for deg, names in names_by_angle.items():
            out = np.array([-sin(radians(deg)), cos(radians(deg))])
            axes.annotate(
                "",
                out * (r + 7 * mm),
                out * 0.6 * r,
                arrowprops={"arrowstyle": "-|>", "lw": 0.8, "color": INK},
            )
            at = out * (r + 10 * mm)
            axes.text(*at, ", ".join(names), fontsize=TEXT_SIZE, ha="center", va="center")
        finish(axes, f"From z = {self._ends[-1]:g}")

    def lengthwise(self, axes: Any, scale: float) -> None:
        """Draw the shaft with its upper half in section: diameters above, places and lengths below."""
        mm, r = 1 / scale, self._radius
        profile = self._profile
        hatched(axes, [np.vstack([profile, self._bore[::-1]])])
        edges(axes, [np.column_stack([profile[:, 0], -profile[:, 1]]), *self._faces])
        for notch in self._part.notch:
            if notch.kind == "hole":
                self._hole(axes, notch, mm)
        centre_line(axes, (-4 * mm, 0.0), (self._ends[-1] + 4 * mm, 0.0))
        self._diameters(axes, r, mm)
        self._places(axes, r, mm)
        self._lengths(axes, r, mm)
        if self._groove is not None and self._detail_mm * scale < _GAP_MM:
            at = self._groove.z_mm, self._part.section_at(self._groove.z_mm)[0] / 2
            circle(axes, 3 * mm, at[1], "-", 0.6, x=at[0])
            axes.text(at[0] + 3.2 * mm, at[1] + 2.2 * mm, "A", fontsize=9)
        finish(axes, "Section, upper half")

    @cached_property
    def _profile(self) -> Array:
        """Outline above the axis, (n, 2), with its grooves."""
        points: list[tuple[float, float]] = []
        for step, start, end in self._part.steps:
            points.append((start, step.diameter_mm / 2))
            for notch in sorted(self._part.notch, key=lambda one: one.z_mm):
                if notch.kind == "groove" and start < notch.z_mm <= end:
                    points += _groove_points(notch, step.diameter_mm / 2)
            points.append((end, step.diameter_mm / 2))
        return np.array([(0.0, 0.0), *points, (self._ends[-1], 0.0)])[1:-1]

    @property
    def _bore(self) -> Array:
        """Bore above the axis, (n, 2)."""
        return np.array([(z, step.bore_mm / 2) for step, *ends in self._part.steps for z in ends])

    @property
    def _faces(self) -> Iterator[Array]:
        """Edges that are seen across the lower half: ends and shoulders, and those of grooves."""
        for z, before, after in zip(
            self._ends, [None, *self._part.step], [*self._part.step, None], strict=True
        ):
            outer = max(step.diameter_mm for step in (before, after) if step is not None) / 2
            if before is None or after is None or before.diameter_mm != after.diameter_mm:
                yield np.array([(z, 0.0), (z, -outer)])
        for notch in self._part.notch:
            if notch.kind == "groove":
                outer = self._part.section_at(notch.z_mm)[0] / 2
                for z in (notch.z_mm - notch.radius_mm, notch.z_mm + notch.radius_mm):
                    yield np.array([(z, 0.0), (z, -outer)])

    def _hole(self, axes: Any, notch: ShaftNotch, mm: float) -> None:
        """Draw a hole across the shaft as it is seen from the side that it opens to."""
        circle(axes, notch.diameter_mm / 2, 0.0, "-", 0.8, "white", x=notch.z_mm)
        reach = notch.diameter_mm / 2 + 2 * mm
        centre_line(axes, (notch.z_mm, -reach), (notch.z_mm, reach))

    def _diameters(self, axes: Any, r: float, mm: float) -> None:
        """Write diameter, fit and bore of every step above it, a line to its surface."""
        seats = [bearing.z_mm for bearing in self._part.bearing if not is_thrust(bearing)]
        for number, (step, start, end) in enumerate(self._part.steps):
            seat = any(start < z <= end or z == start == 0.0 for z in seats)
            text = f"⌀{step.diameter_mm:g}"
            if seat:
                text = limits_text(step.diameter_mm, self._scene.drawing.main_journal_fit)
            text += f", bore ⌀{step.bore_mm:g}" * bool(step.bore_mm)
            height = r + (_GAP_MM + (number % _CALLOUT_ROWS) * _CALLOUT_MM) * mm
            leader(
                axes, (start + (end - start) * 0.3, step.diameter_mm / 2), ((start + end) / 2, height), text
            )

    def _places(self, axes: Any, r: float, mm: float) -> None:
        """Mark every place below the shaft, those that are too near to the last one in a second row."""
        last = [-np.inf, -np.inf]
        for z, name in sorted(self._marks.items()):
            row = 0 if z - last[0] >= 7 * mm else 1
            last[row] = z
            level = -r - (3.0 + _MARK_MM * row) * mm
            surface = self._part.section_at(z)[0] / 2
            axes.plot([z, z], [-surface, level], color=THIN, lw=0.4)
            axes.text(z, level - 0.4 * mm, name, fontsize=TEXT_SIZE - 0.5, ha="center", va="top")

    def _lengths(self, axes: Any, r: float, mm: float) -> None:
        edge = -r
        level = -(2 * _MARK_MM + 0.7 * _GAP_MM) * mm
        for start, end in pairwise(self._ends):
            text = f"{end - start:g}"
            drop = 0.0 if fits(end - start, text, mm) else -DROP_MM * mm
            dimension(axes, (start, edge), (end, edge), (0.0, level), text, (0.0, drop), mm)
        whole = (0.0, level - _LINE_MM * mm)
        if len(self._ends) > 2:
            dimension(axes, (0.0, edge), (self._ends[-1], edge), whole, f"{self._ends[-1]:g}")

    def detail(self, axes: Any, scale: float) -> None:
        """Draw the first groove magnified; of a shaft without one the section in its thickest step."""
        groove = self._groove
        if groove is None:
            step = max(self._part.step, key=lambda one: one.diameter_mm)
            circle(axes, step.diameter_mm / 2, 0.0, "-", 1.4)
            if step.bore_mm:
                circle(axes, step.bore_mm / 2, 0.0, "-", 1.4)
            finish(axes, "Thickest step")
            return
        from manifold3d import CrossSection, FillRule

        outer = self._part.section_at(groove.z_mm)[0] / 2
        window = CrossSection.circle(self._detail_mm, 96).translate((groove.z_mm, outer))
        body = CrossSection([np.vstack([self._profile, self._bore[::-1]])], FillRule.EvenOdd)
        middle = np.array([groove.z_mm, outer])
        hatched(axes, [_DETAIL * (np.asarray(p) - middle) for p in (body ^ window).to_polygons()])
        circle(axes, _DETAIL * self._detail_mm, 0.0, "-.", 0.5)
        depth, reach, mm = _DETAIL * (outer - groove.diameter_mm / 2), _DETAIL * self._detail_mm, 1 / scale
        side = _DETAIL * groove.radius_mm
        leader(
            axes,
            (side * 0.7, -depth + side * 0.3),
            (reach + 8 * mm, -0.4 * reach),
            f"R{groove.radius_mm:g}",
            "left",
        )
        leader(axes, (0.0, -depth), (reach + 8 * mm, -0.9 * reach), f"⌀{groove.diameter_mm:g}", "left")
        dimension(
            axes,
            (-reach, 0.0),
            (-reach, -depth),
            (-_GAP_MM * mm, 0.0),
            f"{depth / _DETAIL:g}",
            (0.0, 0.0),
            mm,
        )
        finish(axes, f"Detail A, {scale * _DETAIL:g}:1")

    @property
    def lines(self) -> Iterator[str]:
        """Lines of the table: steps, then every place with its mark."""
        part = self._part
        yield "STEPS from z = 0"
        for number, (step, start, end) in enumerate(part.steps, 1):
            bore = f", bore ⌀{step.bore_mm:g}" if step.bore_mm else ""
            yield f"  {number}  z {start:g} to {end:g}: ⌀{step.diameter_mm:g}{bore}"
        yield ""
        if part.gear:
            yield f"G   gear at z {part.gear.z_mm:g}, pitch radius {part.gear.pitch_radius_mm:g}"
        for number, bearing in enumerate(part.bearing, 1):
            kind = bearing.roller_bearing.name if bearing.roller_bearing else "bearing"
            yield f"B{number}  {kind} at z {bearing.z_mm:g}"
        for number, weight in enumerate(part.weight, 1):
            bolted = f", {weight.bolts} bolts {weight.bolt.thread}" if weight.bolt else ""
            pull = f"{weight.unbalance_kg_mm:g} kg mm, {weight.deg:g}°{bolted}"
            yield f"M{number}  mass at z {weight.z_mm:g}: {pull}"
        for number, notch in enumerate(part.notch, 1):
            radius = f", R{notch.radius_mm:g}" if notch.kind == "groove" else " across"
            yield f"N{number}  {notch.kind} at z {notch.z_mm:g}: ⌀{notch.diameter_mm:g}{radius}"
        for number, probe in enumerate(part.probe, 1):
            yield f"P{number}  {probe.name} at z {probe.z_mm:g}"


def _groove_points(notch: ShaftNotch, outer_mm: float) -> list[tuple[float, float]]:
    """Points of a groove of parallel sides and a round bottom, from left to right."""
    z, r, bottom = notch.z_mm, notch.radius_mm, notch.diameter_mm / 2
    middle = min(bottom + r, outer_mm)
    arc = [(float(z + r * np.cos(a)), float(middle + (middle - bottom) * np.sin(a))) for a in _ARC]
    return [(z - r, outer_mm), *arc, (z + r, outer_mm)]
