"""Views of the whole crank: lengthwise half in section, from the free end, the star of its throws.

The lengthwise view looks along +x, so that the crank axis runs to the right and throw 1 up; a quarter of the
crank is cut away. Distances from the body are millimetres of paper.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import cos, radians, sin
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.fit import limits_text, tolerance_um
from cranktopo.design.crank_throws import is_split
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.plane_section import BESIDE_MM
from cranktopo.numerics.surfaces.visible_edges import visible_edges
from cranktopo.report.drafting import (
    DROP_MM,
    INK,
    TEXT_SIZE,
    THIN,
    centre_line,
    circle,
    datum,
    dimension,
    edges,
    extent,
    finish,
    fits,
    hatched,
    number_mm,
    tolerance_frame,
)
from cranktopo.tasks.crank_drawing.crank_shape import CrankShape, MainJournal, PlacedThrow, joined_section_x
from cranktopo.tasks.crank_drawing.outlet_lines import outlet_rims, outside_of
from cranktopo.tasks.drawing.views import Room, bolted_cut
from cranktopo.throw.journal import Journal

_PIXEL_SHARE = 1 / 1600
_GAP_MM, _LINE_MM, _CALLOUT_MM = 9.0, 7.0, (64.0, 21.0)
_BALLOON_MM = 5.0
"""Paper from the crank to the numbers of its throws."""
_APART_MM = 0.4
"""Paper beside a number under its line."""
_Span = tuple[float, float]
_FROM_SIDE = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
_FROM_FREE_END = np.array([[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]])


@dataclass(frozen=True)
class Lengthwise:
    """Lines of the lengthwise view: visible edges, the cut upper half of crank and bolted parts, (z, y)."""

    chains: list[Array]
    cut: list[Array]
    bolted_cut: list[Array]


def lengthwise(shape: CrankShape) -> Lengthwise:
    """Return edges and section of the crank with its upper quarter on the viewer's side cut away."""
    from manifold3d import CrossSection, Manifold

    (left, _, _, top), (start, end) = shape.reach_mm, shape.z_mm
    # beyond the plane, so that no skin stays of what ends in it
    corners = np.array([[left - 1.0, 0.0, start - 1.0], [BESIDE_MM, top + 1.0, end + 1.0]])
    quarter = Manifold.cube(corners[1] - corners[0]).translate(corners[0])
    rims = [rim @ _FROM_SIDE.T for rim in outside_of(outlet_rims(shape.throws, shape.z_mm), *corners)]
    chains = visible_edges(shape.seen(_FROM_SIDE, quarter), (end - start) * _PIXEL_SHARE, rims)
    upper = CrossSection.square((end - start + 2.0, top + 1.0)).translate((start - 1.0, 0.0))
    cut, bolted = (
        (joined_section_x(pieces) ^ upper).to_polygons() for pieces in (shape.pieces, shape.bolted)
    )
    return Lengthwise([chain for chain in chains if np.abs(chain[:, 1]).max() > 1e-3], cut, bolted)


def lengthwise_room(shape: CrankShape, scale: float) -> Room:
    """Return the room of the lengthwise view with its dimensions and callouts."""
    (_, _, low, high), (start, end) = shape.reach_mm, shape.z_mm
    callouts_mm = _CALLOUT_MM[0] * (len(_distinct_mains(shape)) + len(_distinct_pins(shape)))
    beside = max(2 * _GAP_MM, callouts_mm - (end - start) * scale)
    under = 2 * _GAP_MM + 3 * _LINE_MM + _under_parts(shape, 1 / scale)
    return Room(shape.z_mm, (low, high), (3 * _GAP_MM, beside, under, _CALLOUT_MM[1] + 2.5 * _GAP_MM))


def draw_cut(axes: Any, view: Lengthwise) -> None:
    """Draw the cut and the edges of a lengthwise view."""
    hatched(axes, view.cut)
    bolted_cut(axes, view.bolted_cut)
    edges(axes, view.chains)


def draw_lengthwise(axes: Any, shape: CrankShape, view: Lengthwise, scale: float) -> None:
    """Draw the lengthwise view with axes, dimensions, datums, and callouts of distinct journals."""
    mm = 1 / scale
    draw_cut(axes, view)
    (start, end), (_, _, low, high) = shape.z_mm, shape.reach_mm
    centre_line(axes, (start - 4 * mm, 0.0), (end + 4 * mm, 0.0))
    for number, throw in enumerate(shape.throws, 1):
        _pin_axis(axes, throw, number, low - _BALLOON_MM * mm, mm)
    for journal, letter in ((shape.journals[0], "A"), (shape.journals[-1], "B")):
        datum(axes, sum(journal.z_mm) / 2, -journal.journal.radius_mm, letter, mm)
    _lengths(axes, shape, low, mm)
    first = shape.throws[0]
    if not is_split(first.scene):  # its pins lie to both sides of the plane: the star has the radius
        radius, up = radius_text(first.scene), first.scene.throw.radius_mm * cos(radians(first.angle_deg))
        aside = 0.0 if fits(up, radius, mm) else -DROP_MM * mm
        dimension(axes, (start, 0.0), (start, up), (-1.5 * _GAP_MM * mm, 0.0), radius, (aside, 0.0), mm)
    _callouts(axes, shape, high + _GAP_MM * mm, mm)
    finish(axes, "Crank, upper half in section")


def radius_text(scene: Scene) -> str:
    """Return the throw radius with its tolerance."""
    return f"{scene.throw.radius_mm:g} ±{scene.drawing.throw_radius_tolerance_mm:g}"


def _pins(throw: PlacedThrow) -> list[tuple[_Span, float]]:
    """Return each straight part of a crankpin: both its ends, and the height of its axis."""
    (a, b), radius = _pin_z(throw), throw.scene.throw.radius_mm
    spans = [(a, b)] if not is_split(throw.scene) else list(pairwise((a, _middle(throw), b)))
    return [
        (span, radius * cos(radians(angle)))
        for span, angle in zip(spans, throw.half_angles_deg, strict=False)
    ]


def _middle(throw: PlacedThrow) -> float:
    """Return where both half pins meet."""
    return throw.z_mm + halves(throw.scene)[0].pitch_mm / 2


def _pin_z(throw: PlacedThrow) -> tuple[float, float]:
    """Both faces of the webs that a crankpin lies between."""
    near, far = halves(throw.scene)
    return throw.z_mm + near.web_z_mm[1], throw.z_mm + throw.scene.pitch_mm - far.web_z_mm[1]


def _pin_axis(axes: Any, throw: PlacedThrow, number: int, level: float, mm: float) -> None:
    """Draw the axis of a crankpin, and the number of its throw below the crank: leaders are above it."""
    pins, middle = _pins(throw), sum(_pin_z(throw)) / 2
    for (a, b), y in pins:
        before, after = (4 if z in _pin_z(throw) else 1 for z in (a, b))
        centre_line(axes, (a - before * mm, y), (b + after * mm, y))
    circle(axes, 2.6 * mm, level, "-", 0.6, x=middle)
    axes.text(middle, level, str(number), fontsize=TEXT_SIZE, ha="center", va="center")


def _lengths(axes: Any, shape: CrankShape, low: float, mm: float) -> None:
    """Dimension the parts of each distinct throw once, all throws, the whole length."""
    levels = [low - (_GAP_MM + 6.0 + k * _LINE_MM + (k > 0) * _under_parts(shape, mm)) * mm for k in range(3)]
    _chain(axes, _parts(shape), low, levels[0], mm)
    planes = [throw.z_mm for throw in shape.throws]
    planes.append(planes[-1] + shape.throws[-1].scene.pitch_mm)
    _chain(axes, list(pairwise(planes)), low, levels[1], mm)
    if len(planes) > 2 or shape.z_mm != (planes[0], planes[-1]):
        _chain(axes, [shape.z_mm], low, levels[2], mm)


def _parts(shape: CrankShape) -> list[_Span]:
    """Return where the parts of each distinct throw and of the ends begin and end, from the free end."""
    first = {throw.scene: throw for throw in reversed(shape.throws)}
    spans = [span for throw in first.values() for span in pairwise(_faces(throw))]
    ends = [(min(part.z_mm), max(part.z_mm)) for part in shape.end_parts]
    return sorted([*spans, *ends])


def _under_parts(shape: CrankShape, mm: float) -> float:
    """Return the paper that numbers of short parts take below the first one under their line."""
    return DROP_MM * max([row - 1 for row in _rows(_parts(shape), mm)] + [0])


def _faces(throw: PlacedThrow) -> list[float]:
    a, b = _pin_z(throw)
    second = throw.scene.second_web or throw.scene.web
    return [
        throw.z_mm,
        throw.z_mm + throw.scene.web_z_mm[0],
        a,
        *([_middle(throw)] if is_split(throw.scene) else []),
        b,
        b + second.thickness_mm,
        throw.z_mm + throw.scene.pitch_mm,
    ]


def _chain(axes: Any, spans: Sequence[_Span], edge: float, level: float, mm: float) -> None:
    for (a, b), row in zip(spans, _rows(spans, mm), strict=True):
        down = (0.0, -DROP_MM * row * mm)
        dimension(axes, (a, edge), (b, edge), (0.0, level - edge), _length_text((a, b)), down, mm)


def _length_text(span: _Span) -> str:
    return f"{round(span[1] - span[0], 3):g}"


def _rows(spans: Sequence[_Span], mm: float) -> list[int]:
    """Return the row of each number: 0 on its line, below it the first one that its neighbours leave free."""
    ends: list[float] = []  # of the last number in each row under the line
    rows = []
    for a, b in spans:
        text, row = _length_text((a, b)), 0
        if not fits(b - a, text, mm):
            half = (number_mm(text) / 2 + _APART_MM) * mm
            start, end = (a + b) / 2 - half, (a + b) / 2 + half
            row = next((k for k, last in enumerate(ends, 1) if last <= start), len(ends) + 1)
            ends[row - 1 : row] = [end]
        rows.append(row)
    return rows


def _callouts(axes: Any, shape: CrankShape, bottom: float, mm: float) -> None:
    """Write fit, tolerances and surface of each distinct journal above the crank, a line to the first."""
    found = [*_distinct_mains(shape), *_distinct_pins(shape)]
    width = _CALLOUT_MM[0] * mm
    found.sort(key=lambda one: one[2][0])
    end = max(shape.z_mm[1], shape.z_mm[0] + len(found) * width)
    x = shape.z_mm[0]
    for number, (journal, count, tip, pin) in enumerate(found):
        x = min(max(x, tip[0] - 2 * mm), end - (len(found) - number) * width)  # a steep line crosses no web
        drawing = shape.throws[0].scene.drawing
        fit = drawing.crankpin_fit if pin else drawing.main_journal_fit
        words = [
            f"{count}× {limits_text(journal.outer_diameter_mm, fit)}",
            *_surface(shape.throws[0].scene, journal),
        ]
        foot = bottom + 7.5 * mm
        axes.plot([tip[0], x + 2 * mm], [tip[1], foot - mm], color=THIN, lw=0.5)
        axes.plot([x + 2 * mm, x + width - 6 * mm], [foot - mm] * 2, color=THIN, lw=0.5)
        axes.plot(*tip, "o", ms=2.0, color=INK)
        axes.text(
            x + 2 * mm, foot + 6.5 * mm, "\n".join(words), fontsize=TEXT_SIZE, va="bottom", linespacing=1.25
        )
        for k, cells in enumerate(_tolerances(shape.throws[0].scene, journal, pin)):
            tolerance_frame(axes, x + (2 + 29 * k) * mm, foot + 0.5 * mm, cells, mm)
        x += width


def _surface(scene: Scene, journal: Journal) -> Iterator[str]:
    drawing = scene.drawing
    if drawing.hardness_HRC:
        depth = f", {drawing.hardening_depth_mm:g} deep" if drawing.hardening_depth_mm else ""
        yield f"hardened {drawing.hardness_HRC:g} HRC{depth}"
    fillets = f", fillets {journal.fillet} Ra {drawing.fillet_roughness_um:g}" if journal.fillet_mm else ""
    yield f"Ra {drawing.journal_roughness_um:g}{fillets}"


def _tolerances(scene: Scene, journal: Journal, pin: bool) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the cells of the tolerance frames of a journal: its place to the datums, and its form."""
    drawing, diameter = scene.drawing, journal.outer_diameter_mm
    sign, tolerance_mm, grade = ("∥", drawing.parallelism_mm, 5) if pin else ("↗", drawing.run_out_mm, 7)
    place = tolerance_mm or tolerance_um(diameter, grade) / 1000
    form = drawing.cylindricity_mm or tolerance_um(diameter, 4) / 1000
    return (sign, f"{place:g}", "A-B"), ("/○/", f"{form:g}")


_Found = tuple[Journal, int, tuple[float, float], bool]


def _distinct_mains(shape: CrankShape) -> list[_Found]:
    groups: dict[Journal, list[MainJournal]] = {}
    for one in shape.journals:
        groups.setdefault(one.journal.model_copy(update={"length_mm": 1.0}), []).append(one)
    return [
        (ones[0].journal, len(ones), (sum(ones[0].z_mm) / 2, ones[0].journal.radius_mm), False)
        for ones in groups.values()
    ]


def _distinct_pins(shape: CrankShape) -> list[_Found]:
    groups: dict[Journal, list[PlacedThrow]] = {}
    for throw in shape.throws:
        groups.setdefault(throw.scene.throw.crankpin, []).append(throw)
    return [_found_pin(pin, [part for one in ones for part in _pins(one)]) for pin, ones in groups.items()]


def _found_pin(pin: Journal, parts: Sequence[tuple[_Span, float]]) -> _Found:
    (first, y), *_ = parts
    return pin, len(parts), (sum(first) / 2, y + pin.radius_mm), True


def end_room(shape: CrankShape) -> Room:
    """Return the room of the view from the free end."""
    left, right, low, high = shape.reach_mm
    return Room((-right, -left), (low, high), (2 * _GAP_MM, 2 * _GAP_MM, 2.5 * _GAP_MM, 2 * _GAP_MM))


def end_edges(shape: CrankShape) -> list[Array]:
    """Return the edges that are seen from the free end."""
    rims = [rim @ _FROM_FREE_END.T for rim in outlet_rims(shape.throws, shape.z_mm)]
    pixel_mm = (shape.reach_mm[3] - shape.reach_mm[2]) * _PIXEL_SHARE * 2
    return visible_edges(shape.seen(_FROM_FREE_END), pixel_mm, rims)


def draw_end(axes: Any, shape: CrankShape, chains: Sequence[Array], scale: float) -> None:
    """Draw the crank from its free end, with its largest sizes."""
    mm, (left, right, low, high) = 1 / scale, shape.reach_mm
    edges(axes, chains)
    centre_line(axes, (-right - 4 * mm, 0.0), (-left + 4 * mm, 0.0))
    centre_line(axes, (0.0, low - 4 * mm), (0.0, high + 4 * mm))
    points = np.concatenate(chains)
    extent(axes, points, 0, low - _GAP_MM * mm, f"{right - left:.1f}")
    extent(axes, points, 1, -left + _GAP_MM * mm, f"{high - low:.1f}")
    finish(axes, "From the free end")


def _rotation_words(scene: Scene) -> str:
    """Return what the arrow of the star means; seen from the output end it is clockwise."""
    rotation = scene.engine.rotation if scene.engine else None
    if rotation == "counter-clockwise":
        return (
            "clockwise from the output end;\nthis engine turns the other way, its crank is the mirror image"
        )
    return "sense of rotation" if rotation else "sense of rotation, assumed"


STAR_MM = (74.0, 74.0)
"""Size of the star on paper."""


def draw_star(axes: Any, shape: CrankShape) -> None:
    """Draw the directions of the throws from the free end, in mm of paper, with angles and tolerance."""
    centre = np.array([STAR_MM[0] / 2, STAR_MM[1] / 2 - 3.0])
    groups: dict[float, list[str]] = {}
    split = is_split(shape.throws[0].scene)
    for number, throw in enumerate(shape.throws, 1):
        for half, angle in zip("ab" if split else ("",), throw.half_angles_deg, strict=False):
            groups.setdefault(round(angle % 360, 6), []).append(f"{number}{half}")
    circle(axes, 20.0, centre[1], "-.", 0.5, x=centre[0])
    for angle, numbers in groups.items():
        way = np.array([-sin(radians(angle)), cos(radians(angle))])
        axes.plot(*zip(centre, centre + 20.0 * way, strict=True), color=INK, lw=1.0)
        circle(axes, 2.0, centre[1] + 20.0 * way[1], "-", 1.0, "white", x=centre[0] + 20.0 * way[0])
        text = f"{', '.join(numbers)}\n{angle:g}°"
        axes.text(*(centre + 28.0 * way), text, fontsize=TEXT_SIZE, ha="center", va="center")
    turn = np.radians(np.linspace(25.0, 65.0, 20))
    arc = centre + 9.0 * np.column_stack([-np.sin(turn), np.cos(turn)])
    axes.plot(*arc.T, color=THIN, lw=0.6)
    axes.annotate("", arc[-1], arc[-4], arrowprops={"arrowstyle": "-|>", "lw": 0.6, "color": THIN})
    first = shape.throws[0].scene
    place = f"each ±{first.drawing.throw_angle_tolerance_deg:g}° to {'half pin 1a' if split else 'throw 1'}"
    more = f", radius {radius_text(first)}\n" if split else "; "
    axes.text(
        centre[0],
        1.0,
        f"{place}{more}arrow: {_rotation_words(first)}",
        fontsize=TEXT_SIZE - 1,
        ha="center",
    )
    finish(axes, "Throws from the free end")
