"""Views of a half throw: front, section through both axes, section across; no dimension over the body.

Distances from the body to its dimension lines are millimetres of paper, so that they look alike at any scale.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.spans import polygon_section
from cranktopo.bodies.prisms import bolted_counterweight, web_region
from cranktopo.design.crank_throws import is_split
from cranktopo.design.opened_fillets import opened_fillets
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.plane_section import section_x, section_y
from cranktopo.report.drafting import (
    DROP_MM,
    INK,
    TEXT_SIZE,
    THIN,
    axis_mark,
    circle,
    dimension,
    finish,
    fits,
    ghost,
    hatched,
    leader,
)
from cranktopo.tasks.drawing.bolt_views import bolt_feature, draw_bolts, draw_threads
from cranktopo.tasks.drawing.half_pin import ANGLE_MM, draw_other_half_pin, front_reach_mm
from cranktopo.tasks.drawing.point_texts import (
    PLACE_MM,
    line_levels,
    running_dimensions,
    stations,
    text_column,
    texts_about,
)
from cranktopo.throw.primitives import Circle, DimensionLine, FeatureDrawing, Polyline
from cranktopo.throw.profile import ProfileWeb

if TYPE_CHECKING:
    from manifold3d import Manifold

_Span = tuple[float, float]
_POINTS = 400
_GAP_MM, _LINE_MM = 8.0, 8.0
"""Paper from the body to the first dimension line, and from one line to the next."""
_LABEL_MM = 5.0
"""Least paper from the middle of the label of a fillet to the web."""
_OUTLET_MM = 3.0
"""Paper from a journal to the dimension of an outlet along it."""
_SLIT_MM = 1e-3
"""Width of a slit, and height of a corner, that no drawing shows."""
_OTHER_PART = "\\\\\\\\"
"""Hatch of a part beside the one that is drawn."""
_TEXT_MM = 46.0
"""Paper beside the front view for the stations of the outline."""


@dataclass(frozen=True)
class Room:
    """Extent of a view: of what is drawn, mm, and of the paper around it, mm: left, right, below, above."""

    x_mm: tuple[float, float]
    y_mm: tuple[float, float]
    paper_mm: tuple[float, float, float, float]

    def size_mm(self, scale: float) -> tuple[float, float]:
        """Return width and height on paper."""
        left, right, below, above = self.paper_mm
        (x0, x1), (y0, y1) = self.x_mm, self.y_mm
        return scale * (x1 - x0) + left + right, scale * (y1 - y0) + below + above

    def set_limits(self, axes: Any, scale: float) -> None:
        """Make axes of this size show the view at a scale."""
        left, right, below, above = (paper / scale for paper in self.paper_mm)
        axes.set_xlim(self.x_mm[0] - left, self.x_mm[1] + right)
        axes.set_ylim(self.y_mm[0] - below, self.y_mm[1] + above)


@dataclass(frozen=True)
class Sheet:
    """Content of a sheet: the exact half throw of a scene, triangulated, and maybe another one as a ghost.

    `half` tells which one of two that differ; None where they are alike. `placed`: there is room for the
    distances of features from both axes.
    """

    scene: Scene
    solid: Manifold
    body: Manifold | None = None
    half: Literal["first", "second"] | None = None
    placed: bool = False

    @property
    def turned(self) -> bool:
        """True of the second of two halves, which is seen from the crankpin too: x runs to the left."""
        return self.half == "second"

    @cached_property
    def features(self) -> list[FeatureDrawing]:
        """Strokes, lines and dimensions of each feature of the web, and of a counterweight's bolts."""
        found = [feature.drawing(self.scene) for _, feature in self.scene.web.features()]
        bolts = bolt_feature(self.scene)
        return found if bolts is None else [*found, bolts]

    @cached_property
    def drilled(self) -> list[FeatureDrawing]:
        """The same of each drilling."""
        return [drilling.drawing(self.scene) for _, drilling in self.scene.throw.features()]

    @cached_property
    def sectioned_feature(self) -> FeatureDrawing | None:
        """The first feature that has a best section across the throw."""
        return next((feature for feature in self.features if feature.section_y_mm is not None), None)

    def half_at_mm(self, y_mm: float) -> float:
        """Half-width of the web at a place along the throw, with what features add to it."""
        place, added = np.array([y_mm]), [np.array(one.added) for one in self.features if one.added]
        spans = [span for one in added for span in polygon_section([one])(place, place)]
        own = self.scene.web.half_width_mm(self.scene.throw.radius_mm, place)
        return float(max([own[0], *(right[0] for _, right in spans)]))

    @cached_property
    def bolted(self) -> Manifold:
        """The counterweight that is a part of its own, bolted to the web; empty without one."""
        return bolted_counterweight(self.scene)

    @property
    def places(self) -> list[tuple[float, float]]:
        """Points (x, y) that are dimensioned from both axes."""
        if not self.placed:
            return []
        return [place for feature in (*self.features, *self.drilled) for place in feature.places]

    @property
    def web_y_mm(self) -> tuple[float, float]:
        """Ends of the web along the throw: a counterweight hides the outline's own lower end."""
        low, high = self.scene.web.y_range_mm(self.scene.throw.radius_mm)
        return min([low, *(y for feature in self.features for _, y in feature.added)]), high

    @property
    def y_range_mm(self) -> tuple[float, float]:
        """Extent of web and journals along the throw."""
        throw, (low, high) = self.scene.throw, self.web_y_mm
        reach = throw.radius_mm + throw.crankpin.radius_mm
        return min(low, -throw.main_journal.radius_mm), max(high, reach)

    @property
    def half_width_mm(self) -> float:
        """Largest half-width of the web with what features add to it."""
        added = (x for feature in self.features for x, _ in feature.added)
        return max([self.scene.web.largest_half_width_mm, *added])

    @property
    def front_half_mm(self) -> float:
        """Largest distance from the axis, across, of what the front view shows."""
        return max(self.half_width_mm, front_reach_mm(self.scene))

    @property
    def rooms(self) -> tuple[Room, Room, Room]:
        """Rooms of the front view, of the section through both axes and of the section across the throw."""
        wide, half, end = self.front_half_mm, self.scene.web.largest_half_width_mm, self.scene.pitch_mm / 2
        if self.sectioned_feature is not None and self.sectioned_feature.added:
            half = self.half_width_mm
        text = _TEXT_MM if isinstance(self.scene.web, ProfileWeb) else _GAP_MM
        above = 8.0 * any(round(x, 2) for x, _ in self.places) + ANGLE_MM * is_split(self.scene)
        text += PLACE_MM * bool(self.places)
        left, side, beside = (_GAP_MM + lines * _LINE_MM for lines in (2.5, 3.5, 1.5))
        under = 2.2 * _GAP_MM
        return (
            Room((-wide, wide), self.y_range_mm, (left, text, under, _GAP_MM + above)),
            Room((0.0, end), self.y_range_mm, (side, side, under, under)),
            Room((-half, half), self.scene.web_z_mm, (beside, beside, under, 2.5 * _GAP_MM)),
        )


def outline_points(scene: Scene) -> tuple[Array, Array]:
    """Return places along the throw and half-widths of the web there, dense at its ends."""
    web, radius = scene.web, scene.throw.radius_mm
    low, high = web.y_range_mm(radius)
    y = (low + high) / 2 - (high - low) / 2 * np.cos(np.linspace(0, np.pi, _POINTS))
    return y, web.half_width_mm(radius, y)


def front_body(axes: Any, sheet: Sheet) -> None:
    """Draw what is seen along the crank axis from the crankpin side, without dimensions."""
    y, half = outline_points(sheet.scene)
    hatched(axes, _with_added(sheet, np.column_stack([np.r_[half, -half[::-1]], np.r_[y, y[::-1]]])), "")
    if not sheet.bolted.is_empty():
        hatched(axes, silhouette(sheet.bolted), "")
    if sheet.body is not None:
        ghost(axes, silhouette(sheet.body))
    _journals(axes, sheet.scene)
    for stroke in (stroke for feature in (*sheet.features, *sheet.drilled) for stroke in feature.front):
        _edges(axes, stroke)
    draw_bolts(axes, sheet.scene, along=False)


def front_view(axes: Any, sheet: Sheet, scale: float) -> None:
    """Draw the view along the crank axis from the crankpin side: outline with its stations, features."""
    front_body(axes, sheet)
    web, radius = sheet.scene.web, sheet.scene.throw.radius_mm
    gap, line, (y, half) = _GAP_MM / scale, _LINE_MM / scale, outline_points(sheet.scene)
    (low, high), x_way = sheet.web_y_mm, -1 if sheet.turned else 1
    widest, place = web.largest_half_width_mm, float(y[np.argmax(half)])
    under, beside = sheet.y_range_mm[0], sheet.front_half_mm
    if is_split(sheet.scene):
        draw_other_half_pin(axes, sheet.scene, 1 / scale)
    dimension(axes, (-widest, place), (widest, place), (0, under - gap - place), f"{2 * widest:.2f}")
    for number, (start, end) in enumerate(((low, 0.0), (low, high))):
        dimension(axes, (0, start), (0, end), (-beside - gap - number * line, 0), f"{end - start:.2f}")
    dimension(axes, (0, 0), (0, radius), (-beside - gap, 0), f"{radius:g}")
    named = [one for feature in sheet.features for one in feature.named]
    taken: list[float] = []
    if isinstance(web, ProfileWeb):  # its stations fill the paper right of the body
        text_column(axes, [*stations(axes, web, x_way), *named], beside, 1 / scale)
    else:
        levels = line_levels(sheet.places)
        taken = texts_about(axes, named, gap, 1 / scale, levels=levels, edge=widest)
    across = beside + _TEXT_MM / scale if isinstance(web, ProfileWeb) else beside
    corner = across, sheet.y_range_mm[1]
    running_dimensions(axes, sheet.places, corner, 1 / scale, taken, x_way)
    axis_mark(axes, (-beside - gap - 0.8 * line, under - 1.3 * gap), x_way, 1 / scale)
    finish(axes, "Front, from the crankpin side")


def bolted_cut(axes: Any, polygons: list[Array]) -> None:
    """Draw the cut of a bolted counterweight, hatched the other way than the part beside it."""
    if polygons:
        hatched(axes, polygons, _OTHER_PART)


def lengthwise_body(axes: Any, sheet: Sheet, over_mm: float) -> None:
    """Draw the body cut through both axes, and these, which end so far beyond it; without dimensions."""
    hatched(axes, section_x(sheet.solid).to_polygons())
    bolted_cut(axes, section_x(sheet.bolted).to_polygons())
    draw_bolts(axes, sheet.scene, along=True)
    if sheet.body is not None:
        ghost(axes, section_x(sheet.body).to_polygons())
    for centre in (0.0, sheet.scene.throw.radius_mm):
        ends = [-over_mm, sheet.scene.pitch_mm / 2 + over_mm]
        axes.plot(ends, [centre, centre], color=THIN, lw=0.6, ls="-.")


def lengthwise_section(axes: Any, sheet: Sheet, scale: float) -> None:
    """Draw the section through both axes: crank axis to the right, throw upward."""
    scene = sheet.scene
    throw, end, (start, stop) = scene.throw, scene.pitch_mm / 2, scene.web_z_mm
    gap, line, (low, high) = _GAP_MM / scale, _LINE_MM / scale, sheet.y_range_mm
    lengthwise_body(axes, sheet, 3 / scale)
    main, pin = throw.main_journal, throw.crankpin
    own = [one for feature in sheet.features for one in feature.lengthwise]
    for a, b, edge, side, text in (
        *([(0.0, start, low, -1, f"{main.length_mm / 2:g}")] if start else []),
        (start, stop, low, -1, f"{scene.web.thickness_mm:g}"),
        (stop, end, high, 1, f"{pin.length_mm / 2:g}"),
    ):
        row = any(side * one.shift[1] > 0 for one in own)  # the first row is that of features
        dimension(axes, (a, edge), (b, edge), (0, side * (gap + row * line)), text)
    sides = (main, 0.0, 0.0, -1), (pin, throw.radius_mm, end, 1)
    for (journal, y, z, side), is_open in zip(sides, opened_fillets(scene), strict=True):
        if not journal.length_mm:
            continue  # a flying web has none
        diameters = filter(None, (journal.bore_diameter_mm, journal.outer_diameter_mm))
        for number, diameter in enumerate(diameters):
            ends = (z, y - diameter / 2), (z, y + diameter / 2)
            dimension(axes, *ends, (side * (gap + number * line), 0), f"⌀{diameter:g}")
        if journal.fillet_mm:
            across = (start if side < 0 else stop) + side * 0.3 * journal.fillet.axial_mm
            outlet = _dimensioned(sheet, y + side * journal.radius_mm)
            way = -side if outlet and not is_open else side
            up = y + way * (journal.radius_mm + 0.3 * journal.fillet_mm)
            away = 0.55 * gap if way == side else 0.9 * gap  # clear of the mark of a detail
            if outlet and is_open:
                away = 1.5 * gap  # beyond the dimension of the outlet
            aside = max(0.4 * journal.length_mm / 2, _LABEL_MM / scale)
            at = across + side * aside, up + way * away
            leader(axes, (across, up), at, str(journal.fillet))
    _dimensions(axes, own, ((-gap - 2 * line, end + gap + 2 * line), (low - gap, high + gap)), 1 / scale)
    for drilled in sheet.drilled:
        _outlets(axes, drilled.lengthwise, 1 / scale)
    finish(axes, "Section x = 0")


def _dimensioned(sheet: Sheet, y_mm: float) -> bool:
    """Tell whether a drilling's outlet is dimensioned along this edge of a journal."""
    return any(line.start[1] == y_mm for drilled in sheet.drilled for line in drilled.lengthwise)


def cross_body(axes: Any, sheet: Sheet, y_mm: float) -> None:
    """Draw the web cut across the throw, without dimensions."""
    hatched(axes, section_y(web_region(sheet.solid, sheet.scene), y_mm).to_polygons())
    bolted_cut(axes, section_y(sheet.bolted, y_mm).to_polygons())
    draw_threads(axes, sheet.scene, y_mm)
    if sheet.body is not None:
        ghost(axes, section_y(web_region(sheet.body, sheet.scene), y_mm).to_polygons())


def cross_section(axes: Any, sheet: Sheet, scale: float) -> None:
    """Draw a section where a feature shows best, or half-way between the axes, toward the main journal.

    x to the right, crank axis downward: what first-angle projection puts below the front view.
    """
    scene, web = sheet.scene, sheet.scene.web
    (start, end), gap = scene.web_z_mm, _GAP_MM / scale
    feature = sheet.sectioned_feature
    y = scene.throw.radius_mm / 2 if feature is None or feature.section_y_mm is None else feature.section_y_mm
    half = sheet.half_at_mm(y)
    cross_body(axes, sheet, y)
    dimension(axes, (-half, start), (half, start), (0, -gap), f"{2 * half:.2f}")
    dimension(axes, (-half, start), (-half, end), (-gap, 0), f"{web.thickness_mm:g}")
    if feature is not None:
        for one in feature.across:
            _sized(axes, one, 1 / scale)
    axes.invert_yaxis()
    alone = ", web alone" * any(abs(y - at) < journal.radius_mm for journal, at in scene.throw.journals)
    finish(axes, f"Section y = {y:.2f}{alone}")


def _with_added(sheet: Sheet, outline: Array) -> list[Array]:
    """Return the outline, (n, 2), and what features add to it, as polygons; a bolted part is none of it."""
    weight = sheet.scene.web.counterweight
    apart = weight.drawing(sheet.scene).added if weight is not None and weight.bolted else ()
    added = [np.array(one.added) for one in sheet.features if one.added and one.added != apart]
    if not added:
        return [outline]
    from manifold3d import CrossSection, FillRule

    sections = [CrossSection([polygon], FillRule.NonZero) for polygon in (outline, *added)]
    return [np.asarray(polygon) for polygon in sum(sections[1:], sections[0]).to_polygons()]


def silhouette(solid: Manifold) -> list[Array]:
    """Return polygons (x, y) around a solid that is seen along the crank axis."""
    # faces along the crank that lie in one plane leave slits between them, of the rounding of numbers
    seen = solid.project().simplify(_SLIT_MM)
    return [np.asarray(polygon) for polygon in seen.to_polygons()]


def _journals(axes: Any, scene: Scene) -> None:
    for (journal, y), style in zip(scene.throw.journals, ("--", "-"), strict=True):
        if journal.length_mm:  # else a flying web has none
            circle(axes, journal.radius_mm, y, style, 1.0)
        if journal.bore_radius_mm:
            circle(axes, journal.bore_radius_mm, y, "-", 1.4, "white")
        reach = 1.15 * journal.radius_mm
        for ends in (([-reach, reach], [y, y]), ([0, 0], [y - reach, y + reach])):
            axes.plot(*ends, color=THIN, lw=0.5, ls="-.")


def _edges(axes: Any, stroke: Circle | Polyline) -> None:
    style = "--" if stroke.hidden else "-"
    if isinstance(stroke, Circle):
        x, y = stroke.centre
        circle(axes, stroke.radius, y, style, 1.0, x=x)
        axes.text(x, y, stroke.label, fontsize=TEXT_SIZE, ha="center", va="center")
    else:
        axes.plot(*zip(*stroke.points, strict=True), color=INK, lw=1.0, ls=style)


def _dimensions(axes: Any, found: Sequence[DimensionLine], lines: tuple[_Span, _Span], mm: float) -> None:
    """Draw dimensions of features, moved beyond the body.

    Args:
        lines: places of their lines, left and right of the body, below and above it.
    """
    for one in found:
        axis = 1 if one.shift[1] else 0
        end = one.shift[axis] > 0
        from_points = (max if end else min)(one.start[axis], one.end[axis])
        off = lines[axis][end] - from_points
        _sized(axes, replace(one, shift=(0.0, off) if axis else (off, 0.0)), mm)


def _outlets(axes: Any, found: tuple[DimensionLine, ...], mm: float) -> None:
    """Dimension the outlets of a drilling along its journals; numbers of short lines stand away from them."""
    for one in found:
        out = float(np.sign(one.shift[1])) * mm
        _sized(axes, replace(one, shift=(0.0, _OUTLET_MM * out)), mm)


def _sized(axes: Any, one: DimensionLine, mm: float) -> None:
    """Draw a dimension; a number that does not fit on its line stands beyond it."""
    length = float(np.hypot(*np.subtract(one.end, one.start)))
    off = 0.0 if fits(length, one.text, mm) else DROP_MM * mm
    x, y = off * np.sign(one.shift)
    dimension(axes, one.start, one.end, one.shift, one.text, (float(x), float(y)), mm)
