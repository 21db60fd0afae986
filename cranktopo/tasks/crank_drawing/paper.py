"""Paper of a sheet of the whole crank: its views, the column beside them, title block of ISO 7200."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from typing import TYPE_CHECKING, Any

from cranktopo.base.units import MM_PER_INCH
from cranktopo.design.schema import Scene
from cranktopo.report.drafting import INK, TEXT_SIZE, THIN, folded, frame, projection_symbol
from cranktopo.tasks.crank_drawing.crank_shape import CrankShape
from cranktopo.tasks.crank_drawing.crank_views import STAR_MM, draw_star
from cranktopo.tasks.crank_drawing.layout import (
    BORDER_MM,
    COLUMN_MM,
    SHEETS_MM,
    SheetLayout,
    ViewBlock,
    layout,
)
from cranktopo.tasks.drawing.sheet import scale_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_TITLE_MM, _NOTE_MM = 56.0, 3.6
_TABLE_POINTS, _LEAST_POINTS = 8.0, 6.0
_LINE_MM = _TABLE_POINTS * MM_PER_INCH / 72 * 1.25 * 1.17


@dataclass(frozen=True)
class Paper:
    """Content of a sheet beside its views.

    Attributes:
        shape: the crank whose star of throws it shows.
        lines: table of the column.
        title: that of the sheet where [drawing] gives none.
        number: of the sheet among all, such as `1/2`.
        webs: whether it shows webs at a scale of their own.
    """

    scene: Scene
    shape: CrankShape
    lines: Sequence[str]
    notes: Sequence[str]
    title: str
    number: str
    mass: str
    webs: bool
    written: datetime


def sheet_figure(
    paper: Paper, blocks: Callable[[float, float], Sequence[ViewBlock]]
) -> tuple[Figure, SheetLayout]:
    """Return a sheet as a figure, and its layout; `blocks` gives the views at scales of crank and webs."""
    from matplotlib.figure import Figure

    paper = replace(paper, notes=folded(paper.notes, COLUMN_MM - 8))
    pin = min(throw.scene.throw.crankpin.outer_diameter_mm for throw in paper.shape.throws)
    found = layout(blocks, pin, lambda height: _points(paper, height) >= _LEAST_POINTS)
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
    _column(figure, page, (width, height), paper)
    _title_block(page, width, paper, found)
    return figure, found


def _points(paper: Paper, height: float) -> float:
    """Size of the column's letters with which its table fits."""
    room = height - _TITLE_MM - _NOTE_MM * len(paper.notes) - STAR_MM[1] - 20.0
    return min(_TABLE_POINTS, _TABLE_POINTS * room / (_LINE_MM * max(len(paper.lines), 1)))


def _column(figure: Figure, page: Any, size: tuple[float, float], paper: Paper) -> None:
    """Draw the star of the throws, the table, and the notes above the title block."""
    width, height = size
    left, top = width - BORDER_MM - COLUMN_MM, height - BORDER_MM
    star = figure.add_axes(
        ((left + 4) / width, (top - 8 - STAR_MM[1]) / height, STAR_MM[0] / width, STAR_MM[1] / height)
    )
    star.set_xlim(0, STAR_MM[0])
    star.set_ylim(0, STAR_MM[1])
    draw_star(star, paper.shape)
    page.plot([left, left], [BORDER_MM, top], color=INK, lw=0.5)
    size_pt = _points(paper, height - 2 * BORDER_MM)
    text = "\n".join(paper.lines)
    page.text(
        left + 4,
        top - 14 - STAR_MM[1],
        text,
        va="top",
        family="monospace",
        fontsize=size_pt,
        linespacing=1.25,
    )
    above = BORDER_MM + _TITLE_MM + 3 + _NOTE_MM * len(paper.notes)
    page.text(left + 4, above, "\n".join(paper.notes), va="top", fontsize=TEXT_SIZE, linespacing=1.3)


def _title_block(page: Any, width: float, paper: Paper, sheet_layout: SheetLayout) -> None:
    """Draw the fields of ISO 7200, 180 mm wide."""
    left, drawing, step = width - BORDER_MM - COLUMN_MM, paper.scene.drawing, _TITLE_MM / 6
    rows = (
        (
            ("Title", drawing.title or paper.title, 130.0),
            ("Document", "Workshop drawing", 50.0),
        ),
        (
            ("Number", drawing.number, 80.0),
            ("Rev.", drawing.revision, 50.0),
            ("Sheet", f"{sheet_layout.sheet}, {paper.number}", 50.0),
        ),
        (("Owner", drawing.owner, 130.0), ("Date", f"{paper.written:%Y-%m-%d}", 50.0)),
        (("Drawn", drawing.drawn_by, 80.0), ("Approved", drawing.approved_by, 100.0)),
        (("Material", paper.scene.material.name, 80.0), ("Mass", paper.mass, 100.0)),
        (
            ("Scale", scale_text(sheet_layout.scale), 40.0),
            ("Webs", scale_text(sheet_layout.web_scale) if paper.webs else "", 40.0),
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
