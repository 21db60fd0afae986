"""Views of the ends of the crank: each along it with its diameters, its keyways in section, its flanges.

They look as the other views do: along +x with the free end on the left, and from the free end.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

from cranktopo.base.fit import limits_text
from cranktopo.bodies.crank_ends import EndPiece
from cranktopo.report.drafting import (
    DROP_MM,
    INK,
    TEXT_SIZE,
    THIN,
    centre_line,
    circle,
    dimension,
    finish,
    fits,
    hatched,
    leader,
    number_mm,
)
from cranktopo.tasks.crank_drawing.crank_shape import CrankShape, Piece
from cranktopo.tasks.crank_drawing.crank_views import Lengthwise, draw_cut, lengthwise
from cranktopo.tasks.crank_drawing.layout import View, ViewBlock
from cranktopo.tasks.drawing.sheet import scale_text
from cranktopo.tasks.drawing.views import Room
from cranktopo.throw.crank_end import (
    BodyStep,
    ConeStep,
    EndStep,
    FlangeStep,
    KeywayStep,
    SeatStep,
    ThreadStep,
)

if TYPE_CHECKING:
    from manifold3d import CrossSection

_LETTERS = tuple(f"{letter}{number}" for number in ("", *range(1, 9)) for letter in "CDEFGH")
"""Letters of sections; A and B are datums, details begin with K."""
_GAP_MM, _ROW_MM, _LINE_MM, _MARK_MM = 8.0, 9.0, 3.6, 7.0
"""Paper to a dimension line, from the end to the row of its diameters, of a line of them, and of a letter."""
_APART_MM = 3.0


@dataclass(frozen=True)
class ViewedStep:
    """A step of an end and the letter of the section through its middle; empty without one."""

    part: EndPiece
    letter: str

    @property
    def middle_mm(self) -> float:
        """Place of its middle along the crank."""
        return sum(self.part.z_mm) / 2


@dataclass(frozen=True)
class EndView:
    """An end of the crank: its body, and its steps beyond the outer main journal from the free end."""

    name: str
    piece: Piece
    steps: tuple[ViewedStep, ...]

    @cached_property
    def shape(self) -> CrankShape:
        """The end as a crank without throws."""
        return CrankShape(self.name, (), (), (self.piece,))

    @cached_property
    def lines(self) -> Lengthwise:
        """Lines of the view along it."""
        return lengthwise(self.shape)

    @cached_property
    def callouts(self) -> list[tuple[tuple[float, float], str]]:
        """Point below each step of known diameter, (z, y), and what is told of it."""
        bores = [one.part.step.bore_radius_mm for one in self.steps]
        return [
            ((one.middle_mm, -sum(one.part.step.radii_mm) / 2), "\n".join(_words(one.part.step, told)))
            for one, told in zip(self.steps, _runs_end(bores, self.steps), strict=True)
            if not isinstance(one.part.step, BodyStep)
        ]

    def row(self, mm: float) -> list[float]:
        """Return the middle of each callout in their row, clear of each other; `mm` is one of paper."""
        widths = [(max(map(number_mm, text.split("\n"))) + _APART_MM) * mm for _, text in self.callouts]
        places, tips = list[float](), [z for (z, _), _ in self.callouts]
        at = min(tips[0] - widths[0] / 2, (tips[0] + tips[-1] - sum(widths)) / 2) if tips else 0.0
        for tip, width in zip(tips, widths, strict=True):
            at = max(at, tip - width / 2)
            places.append(at + width / 2)
            at += width
        return places

    def room(self, scale: float) -> Room:
        """Return the room of the view along it."""
        (_, _, low, high), (start, end), places = self.shape.reach_mm, self.shape.z_mm, self.row(1 / scale)
        lines = max([text.count("\n") + 1 for _, text in self.callouts] + [0])
        wide = max([number_mm(line) for _, text in self.callouts for line in text.split("\n")] + [0])
        reach = min([start, *places]), max([end, *places])
        beside = max(wide, number_mm(self.titled(scale)) - scale * (reach[1] - reach[0])) / 2 + 4
        return Room(reach, (low, high), (beside, beside, _ROW_MM + _LINE_MM * lines + 2, _MARK_MM + 2))

    def titled(self, scale: float) -> str:
        """Return the title of the view along it."""
        return f"{self.name}, {scale_text(scale)}, upper half in section"


def _runs_end(bores: Sequence[float], steps: Sequence[ViewedStep]) -> list[bool]:
    """Tell of each step whether its bore is told: once of a run of one diameter, at its outer end."""
    outward = 1 if not steps or steps[0].part.z_mm[1] > steps[0].part.z_mm[0] else -1
    outer = [*bores[1:], 0.0] if outward > 0 else [0.0, *bores[:-1]]
    return [bool(own) and own != beyond for own, beyond in zip(bores, outer, strict=True)]


def _words(step: EndStep, with_bore: bool) -> Iterator[str]:
    """Yield the lines of a callout."""
    inner, outer = (2 * radius for radius in step.radii_mm)
    if isinstance(step, ThreadStep):
        yield step.thread
    if isinstance(step, ConeStep) and inner != outer:
        yield f"⌀{inner:g} to ⌀{outer:g}"
        yield f"cone 1:{step.length_mm / abs(inner - outer):.4g}"
    elif isinstance(step, SeatStep) and step.fit:
        yield limits_text(inner, step.fit)
    else:
        yield f"⌀{inner:g}"
    if isinstance(step, SeatStep):
        yield from _seat(step)
    if with_bore:
        yield f"bore ⌀{2 * step.bore_radius_mm:g}"


def _seat(step: SeatStep) -> Iterator[str]:
    if step.roughness_um is not None:
        yield f"Ra {step.roughness_um:g}"
    if step.run_out_mm is not None:
        yield f"↗ {step.run_out_mm:g} A-B"


def end_views(shape: CrankShape) -> list[EndView]:
    """Return the ends of a crank that have steps, from the free end."""
    found, letters = [], iter(_LETTERS)
    for piece in shape.ends:
        box = piece.solid.bounding_box()
        own = [part for part in shape.end_parts if box[2] < sum(part.z_mm) / 2 < box[5]]
        beyond = sorted((part for part in own if part.z_mm[0] not in piece.seams_mm), key=_place)
        if beyond:
            name = "Free end" if beyond[0].z_mm[1] < beyond[0].z_mm[0] else "Output end"
            steps = (ViewedStep(part, next(letters) if part.step.slot else "") for part in beyond)
            found.append(EndView(name, piece, tuple(steps)))
    return found


def _place(part: EndPiece) -> float:
    return min(part.z_mm)


def end_blocks(ends: Sequence[EndView], scale: float) -> list[ViewBlock]:
    """Return the views of ends at a scale: along the crank, of each keyway and each flange."""
    found = []
    for end in ends:
        found.append(View(end.room(scale), partial(draw_end_along, end), scale))
        for one in end.steps:
            step = one.part.step
            if isinstance(step, KeywayStep | FlangeStep):
                draw = draw_keyway if isinstance(step, KeywayStep) else draw_flange
                found.append(View(_across_room(step), partial(draw, end, one), scale))
    return [ViewBlock(((view, (0.0, 0.0)),)) for view in found]


def draw_end_along(end: EndView, axes: Any, scale: float) -> None:
    """Draw an end along the crank, its diameters below it, its sections marked above it."""
    mm, (_, _, low, high), (start, stop) = 1 / scale, end.shape.reach_mm, end.shape.z_mm
    draw_cut(axes, end.lines)
    centre_line(axes, (start - 3 * mm, 0.0), (stop + 3 * mm, 0.0))
    foot = low - _ROW_MM * mm
    for ((z, y), text), at in zip(end.callouts, end.row(mm), strict=True):
        axes.plot(z, y, "o", ms=2.0, color=INK)
        axes.plot([z, z, at], [y, low - mm, foot], color=THIN, lw=0.5)
        axes.text(at, foot - 0.8 * mm, text, fontsize=TEXT_SIZE, ha="center", va="top", linespacing=1.25)
    for one in end.steps:
        if one.letter:
            axes.plot([one.middle_mm] * 2, [high + mm, high + 3.5 * mm], color=INK, lw=1.4)
            axes.text(
                one.middle_mm, high + 6 * mm, one.letter, fontsize=9, ha="center", va="center", color=INK
            )
    finish(axes, end.titled(scale))


def _across_room(step: KeywayStep | FlangeStep) -> Room:
    radius = step.radii_mm[0]
    return Room((-radius, radius), (-radius, radius), (24.0, 24.0, 2.6 * _GAP_MM, 2 * _GAP_MM))


def across(end: EndView, one: ViewedStep, first_deg: float) -> CrossSection:
    """Return the section through the middle of a step from the free end, turned so that `first_deg` is up."""
    return end.piece.solid.slice(one.middle_mm).mirror((1.0, 0.0)).rotate(-first_deg)


def draw_keyway(end: EndView, one: ViewedStep, axes: Any, scale: float) -> None:
    """Draw a keyway in section, turned up, with its width, its depth and its direction."""
    step, mm = one.part.step, 1 / scale
    assert isinstance(step, KeywayStep)
    radius, half, gap = step.radii_mm[0], step.width_mm / 2, _GAP_MM * mm
    hatched(axes, across(end, one, step.angle_deg).to_polygons())
    _cross(axes, radius, mm)
    edge, bottom = (radius**2 - half**2) ** 0.5, radius - step.depth_mm
    width, depth = f"{step.width_mm:g}", f"{step.depth_mm:g}"
    up = 0.0 if fits(2 * half, width, mm) else DROP_MM * mm
    dimension(axes, (-half, edge), (half, edge), (0.0, radius + gap - edge), width, (0.0, up), mm)
    aside = 0.0 if fits(step.depth_mm, depth, mm) else DROP_MM * mm
    dimension(axes, (half, bottom), (0.0, radius), (radius + gap, 0.0), depth, (aside, 0.0), mm)
    _direction(axes, radius, "keyway", step.angle_deg, mm)
    finish(axes, f"Section {one.letter}-{one.letter}")


def draw_flange(end: EndView, one: ViewedStep, axes: Any, scale: float) -> None:
    """Draw a flange along the crank, its first hole up, with the holes, their circle and their direction."""
    step, mm = one.part.step, 1 / scale
    assert isinstance(step, FlangeStep)
    radius, arm, hole = step.radii_mm[0], step.bolt_circle_mm / 2, step.bolt_diameter_mm / 2
    hatched(axes, across(end, one, step.first_bolt_deg).to_polygons(), "")
    _cross(axes, radius, mm)
    circle(axes, arm, 0.0, "-.", 0.5)
    dimension(axes, (-arm, 0.0), (arm, 0.0), (0.0, -radius - _GAP_MM * mm), f"⌀{2 * arm:g}", mm=mm)
    at = 0.75 * radius + 8.0 * mm, radius + 0.8 * _GAP_MM * mm
    leader(axes, (0.7 * hole, arm + 0.7 * hole), at, f"{step.bolts}× ⌀{2 * hole:g}", "left")
    _direction(axes, radius, "first hole", step.first_bolt_deg, mm)
    finish(axes, f"{end.name}, flange")


def _cross(axes: Any, radius: float, mm: float) -> None:
    reach = radius + 3 * mm
    centre_line(axes, (-reach, 0.0), (reach, 0.0))
    centre_line(axes, (0.0, -reach), (0.0, reach))


def _direction(axes: Any, radius: float, what: str, angle_deg: float, mm: float) -> None:
    """Tell below a view where what is drawn up in it lies on the crank."""
    angle = f"{angle_deg:g}° from throw 1\nin the sense of rotation" if angle_deg else "toward throw 1"
    at = -radius - 1.55 * _GAP_MM * mm
    axes.text(0.0, at, f"{what} {angle}", fontsize=TEXT_SIZE, ha="center", va="top", linespacing=1.25)
