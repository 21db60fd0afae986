"""Sheet of the whole crank: all views, numbers of each distinct web, notes, title block of ISO 7200."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cranktopo.base.files import replacing
from cranktopo.base.reproducible import time_of_writing
from cranktopo.base.units import MM_PER_INCH, stem_and_unit
from cranktopo.bodies.crank_ends import SIDES
from cranktopo.design.drawing import surface_notes
from cranktopo.design.halves import difference
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.schema import Scene
from cranktopo.design.strength import strength_notes
from cranktopo.engine.balance.crank import end_mass
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.report.drafting import INK, TEXT_SIZE, THIN, folded, frame, projection_symbol
from cranktopo.report.dxf import write_dxf
from cranktopo.report.plot import save_figure
from cranktopo.tasks.crank_drawing.balancing import balancing_notes
from cranktopo.tasks.crank_drawing.crank_shape import CrankShape, crank_shape, throw_solid
from cranktopo.tasks.crank_drawing.crank_views import (
    STAR_MM,
    draw_end,
    draw_lengthwise,
    draw_star,
    end_edges,
    end_room,
    lengthwise,
    lengthwise_room,
)
from cranktopo.tasks.crank_drawing.detail import Detail, details, draw_detail, mark_detail
from cranktopo.tasks.crank_drawing.layout import (
    BORDER_MM,
    COLUMN_MM,
    SHEETS_MM,
    TITLE_MM,
    SheetLayout,
    View,
    ViewBlock,
    layout,
)
from cranktopo.tasks.drawing.sheet import scale_text, table_lines, throw_sheets
from cranktopo.tasks.drawing.views import Sheet, cross_section, front_view, lengthwise_section

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_TITLE_MM, _NOTE_MM = 56.0, 3.6
_TABLE_POINTS, _LEAST_POINTS = 8.0, 6.0
_LINE_MM = _TABLE_POINTS * MM_PER_INCH / 72 * 1.25 * 1.17
_END_LETTERS = 56
"""Letters of a line on an end."""
_LETTERS = "KLMNPRSTUVWXYZ"


def draw_crank(design: DesignLike, path: Path | str, started: datetime | None = None) -> tuple[str, float]:
    """Write the drawing of a crank (.pdf, .svg, .png or .dxf); return its sheet, such as A2, and scale."""
    import matplotlib as mpl

    scene, path = as_scene(design), Path(path)
    written = time_of_writing(started)
    figure, found = crank_figure(scene, crank_shape(scene), written)
    with replacing(path) as temporary:
        if path.suffix.lower() == ".dxf":
            write_dxf(figure, found.scale, temporary, written)
        else:
            date = {".svg": {"Date": written.isoformat()}, ".pdf": {"CreationDate": written}}
            with mpl.rc_context({"svg.hashsalt": scene.name}):
                save_figure(figure, temporary, dpi=100, metadata=date.get(path.suffix.lower()))
    return found.sheet, found.scale


def crank_figure(scene: Scene, shape: CrankShape, written: datetime) -> tuple[Figure, SheetLayout]:
    """Return the drawing of a crank as a figure, and its layout; `scene` has the material and the title."""
    from matplotlib.figure import Figure

    sheets = _distinct(shape)
    marked = _all_details([sheet for _, sheet in sheets])
    lines = [line for name, sheet in sheets for line in (name, *table_lines(sheet), "")]
    lines += _end_lines(shape)
    notes = folded(_notes(scene, shape), COLUMN_MM - 8)
    pin = min(throw.scene.throw.crankpin.outer_diameter_mm for throw in shape.throws)
    found = layout(
        _blocks(shape, sheets, marked), pin, lambda height: _points(lines, notes, height) >= _LEAST_POINTS
    )
    width, height = SHEETS_MM[found.sheet]
    figure = Figure(figsize=(width / MM_PER_INCH, height / MM_PER_INCH))
    page = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    page.set_xlim(0, width)
    page.set_ylim(0, height)
    page.axis("off")
    frame(page, BORDER_MM, BORDER_MM, width - 2 * BORDER_MM, height - 2 * BORDER_MM, 1.2)
    for view, (x, y) in found.views:
        wide, tall = view.room.size_mm(view.scale)
        axes = figure.add_axes(
            ((BORDER_MM + x) / width, (BORDER_MM + y) / height, wide / width, tall / height)
        )
        view.room.set_limits(axes, view.scale)
        view.draw(axes, view.scale)
    _column(figure, page, (width, height), lines, notes, shape)
    _title_block(page, width, scene, shape, found, written)
    return figure, found


def _distinct(shape: CrankShape) -> list[tuple[str, Sheet]]:
    """Return each half throw that differs from those before, and where it is."""
    found: list[tuple[str, Sheet]] = []
    scenes = list(dict.fromkeys(throw.scene for throw in shape.throws))
    for scene in scenes:
        where = _places(
            [k for k, throw in enumerate(shape.throws, 1) if throw.scene == scene], len(scenes) == 1
        )
        if difference(scene):
            pair = throw_sheets(scene, throw=throw_solid(scene))
            first, second = (replace(sheet, placed=True) for sheet in pair)
            found += [(f"first web of {where}", first), (f"second web of {where}", second)]
        else:
            found.append((f"both webs of {where}", Sheet(scene, throw_solid(scene), placed=True)))
    return [(f"WEB {k}: {where}", sheet) for k, (where, sheet) in enumerate(found, 1)]


def _places(numbers: Sequence[int], alone: bool) -> str:
    """Return which throws these are: `all throws`, `throw 2`, `throws 1, 3 to 6`."""
    if alone and len(numbers) > 1:
        return "all throws"
    runs: list[list[int]] = []
    for number in numbers:
        if runs and runs[-1][-1] == number - 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    words = [f"{run[0]} to {run[-1]}" if len(run) > 2 else ", ".join(map(str, run)) for run in runs]
    return f"throw{'s' * (len(numbers) > 1)} {', '.join(words)}"


def _all_details(sheets: Sequence[Sheet]) -> list[list[Detail]]:
    found: list[list[Detail]] = []
    for sheet in sheets:
        found.append(details(sheet, _LETTERS[sum(map(len, found)) :]))
    return found


def _blocks(
    shape: CrankShape, sheets: Sequence[tuple[str, Sheet]], marked: Sequence[Sequence[Detail]]
) -> Any:
    long, end = lengthwise(shape), end_edges(shape)

    def blocks(scale: float, web_scale: float) -> list[ViewBlock]:
        crank = View(
            lengthwise_room(shape, scale), lambda axes, s: draw_lengthwise(axes, shape, long, s), scale
        )
        seen = View(end_room(shape), lambda axes, s: draw_end(axes, shape, end, s), scale)
        found = [ViewBlock(((crank, (0.0, 0.0)),)), ViewBlock(((seen, (0.0, 0.0)),))]
        for (name, sheet), own in zip(sheets, marked, strict=True):
            found.append(_web_block(name, sheet, own, web_scale))
            found += [
                ViewBlock(((View(one.room, partial(_detail, one), one.scale), (0.0, 0.0)),)) for one in own
            ]
        return found

    return blocks


def _detail(detail: Detail, axes: Any, scale: float) -> None:
    draw_detail(axes, detail, scale)


def _web_block(name: str, sheet: Sheet, own: Sequence[Detail], scale: float) -> ViewBlock:
    """Front view, section through both axes beside it, section across below."""
    front, _, across = (room.size_mm(scale) for room in sheet.rooms)
    up = across[1] + TITLE_MM

    def section(axes: Any, s: float) -> None:
        lengthwise_section(axes, sheet, s)
        for detail in own:
            mark_detail(axes, detail, s)

    def named(axes: Any, s: float) -> None:
        front_view(axes, sheet, s)
        axes.set_title(
            f"{name.capitalize()}, {scale_text(s)}, from the crankpin", fontsize=9, loc="left", color=THIN
        )

    views = (named, section, lambda axes, s: cross_section(axes, sheet, s))
    places = ((0.0, up), (front[0], up), ((front[0] - across[0]) / 2 if front[0] > across[0] else 0.0, 0.0))
    drawn = (View(room, draw, scale) for room, draw in zip(sheet.rooms, views, strict=True))
    return ViewBlock(tuple(zip(drawn, places, strict=True)))


def _points(lines: Sequence[str], notes: Sequence[str], height: float) -> float:
    """Size of the column's letters with which its table fits."""
    room = height - _TITLE_MM - _NOTE_MM * len(notes) - STAR_MM[1] - 20.0
    return min(_TABLE_POINTS, _TABLE_POINTS * room / (_LINE_MM * max(len(lines), 1)))


def _column(
    figure: Figure,
    page: Any,
    size: tuple[float, float],
    lines: Sequence[str],
    notes: Sequence[str],
    shape: CrankShape,
) -> None:
    """Draw the star of the throws, the numbers of the webs, and the notes above the title block."""
    width, height = size
    left, top = width - BORDER_MM - COLUMN_MM, height - BORDER_MM
    star = figure.add_axes(
        ((left + 4) / width, (top - 8 - STAR_MM[1]) / height, STAR_MM[0] / width, STAR_MM[1] / height)
    )
    star.set_xlim(0, STAR_MM[0])
    star.set_ylim(0, STAR_MM[1])
    draw_star(star, shape)
    page.plot([left, left], [BORDER_MM, top], color=INK, lw=0.5)
    size_pt = _points(lines, notes, height - 2 * BORDER_MM)
    text = "\n".join(lines)
    page.text(
        left + 4,
        top - 14 - STAR_MM[1],
        text,
        va="top",
        family="monospace",
        fontsize=size_pt,
        linespacing=1.25,
    )
    above = BORDER_MM + _TITLE_MM + 3 + _NOTE_MM * len(notes)
    page.text(left + 4, above, "\n".join(notes), va="top", fontsize=TEXT_SIZE, linespacing=1.3)


def _notes(scene: Scene, shape: CrankShape) -> list[str]:
    drawing, mass = scene.drawing, _mass_kg(scene, shape)
    notes = [
        "NOTES",
        *surface_notes(drawing),
        "A-B: axis of the outer main journals, on which it is measured.",
    ]
    notes += strength_notes(scene)
    notes += balancing_notes(scene, mass)
    if not shape.ends:
        notes.append("The shaft ends in the middle of its outer journals: the design has no ends.")
    return [*notes, *drawing.notes]


def _end_lines(shape: CrankShape) -> list[str]:
    """Return the steps of both ends with their dimensions, from the free end; its places are in the view."""
    lines = []
    for part in sorted(shape.end_parts, key=lambda one: min(one.z_mm)):
        given = part.step.model_dump(exclude={"length_mm", "file"}, exclude_defaults=True)
        kind = given.pop("kind").replace("_", " ")
        told = ", ".join(f"{stem_and_unit(key)[0].replace('_', ' ')} {value}" for key, value in given.items())
        lines += textwrap.wrap(
            f"{kind}, length {part.step.length_mm:g}, {told}",
            _END_LETTERS,
            subsequent_indent="   ",
        )
    return ["ENDS of the crank, from the free end", *lines] if lines else []


def _mass_kg(scene: Scene, shape: CrankShape) -> float:
    ends = sum(end_mass(scene, side).mass_kg for side in SIDES)
    return ends + sum(throw_balance(throw.scene).mass_kg for throw in shape.throws)


def _title_block(
    page: Any, width: float, scene: Scene, shape: CrankShape, found: SheetLayout, written: datetime
) -> None:
    """Draw the fields of ISO 7200, 180 mm wide."""
    left, drawing, step = width - BORDER_MM - COLUMN_MM, scene.drawing, _TITLE_MM / 6
    rows = (
        (
            ("Title", drawing.title or f"{scene.name}: crankshaft", 130.0),
            ("Document", "Workshop drawing", 50.0),
        ),
        (
            ("Number", drawing.number, 80.0),
            ("Rev.", drawing.revision, 50.0),
            ("Sheet", f"{found.sheet}, 1/1", 50.0),
        ),
        (("Owner", drawing.owner, 130.0), ("Date", f"{written:%Y-%m-%d}", 50.0)),
        (("Drawn", drawing.drawn_by, 80.0), ("Approved", drawing.approved_by, 100.0)),
        (("Material", scene.material.name, 80.0), ("Mass", f"{_mass_kg(scene, shape):.3f} kg", 100.0)),
        (
            ("Scale", scale_text(found.scale), 40.0),
            ("Webs", scale_text(found.web_scale), 40.0),
            ("Units", "mm, degrees; first-angle projection", 100.0),
        ),
    )
    for number, row in enumerate(rows):
        x, y = left, BORDER_MM + (len(rows) - 1 - number) * step
        for name, text, wide in row:
            frame(page, x, y, wide, step, 0.5)
            page.text(x + 1.5, y + step / 2, name, fontsize=TEXT_SIZE - 1.5, va="center", color=THIN)
            page.text(x + 15, y + step / 2, text, fontsize=TEXT_SIZE + 0.5, va="center", color=INK)
            x += wide
    frame(page, left, BORDER_MM, COLUMN_MM, _TITLE_MM, 1.0)
    projection_symbol(page, left + COLUMN_MM - 17, BORDER_MM + step / 2)
