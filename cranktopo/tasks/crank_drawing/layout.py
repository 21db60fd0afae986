"""Views on a sheet: blocks in rows beside the column of the title block, on the smallest sheet that does."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from cranktopo.tasks.drawing.sheet import SCALES
from cranktopo.tasks.drawing.views import Room

SHEETS_MM = {"A3": (420.0, 297.0), "A2": (594.0, 420.0), "A1": (841.0, 594.0), "A0": (1189.0, 841.0)}
BORDER_MM, COLUMN_MM, TITLE_MM = 10.0, 180.0, 8.0
_LEAST_MM, _LEAST_WEB_MM = 13.0, 20.0
"""Crankpin on paper in the views of the crank and of a web; larger sheets are taken for it."""


@dataclass(frozen=True)
class View:
    """A view that is drawn at a scale, in its room."""

    room: Room
    draw: Callable[[Any, float], None]
    scale: float

    @property
    def size_mm(self) -> tuple[float, float]:
        """Width and height on paper."""
        width, height = self.room.size_mm(self.scale)
        return width, height + TITLE_MM


@dataclass(frozen=True)
class ViewBlock:
    """Views that stay together, each with its lower left corner in the block, mm of paper."""

    views: tuple[tuple[View, tuple[float, float]], ...]

    @property
    def size_mm(self) -> tuple[float, float]:
        """Width and height on paper."""
        corners = [(x + view.size_mm[0], y + view.size_mm[1]) for view, (x, y) in self.views]
        return max(x for x, _ in corners), max(y for _, y in corners)


@dataclass(frozen=True)
class SheetLayout:
    """Sheet, scale of the crank and of its webs, and the views with their lower left corners."""

    sheet: str
    scale: float
    web_scale: float
    views: tuple[tuple[View, tuple[float, float]], ...]


def rows(
    blocks: Sequence[ViewBlock], width: float, height: float
) -> list[tuple[View, tuple[float, float]]] | None:
    """Return the views of blocks set in rows from the upper left corner; None where they do not fit."""
    lines: list[list[ViewBlock]] = [[]]
    for block in blocks:
        if lines[-1] and sum(one.size_mm[0] for one in (*lines[-1], block)) > width:
            lines.append([])
        lines[-1].append(block)
    tall = [max(block.size_mm[1] for block in line) for line in lines]
    wide = [sum(block.size_mm[0] for block in line) for line in lines]
    if max(wide) > width or sum(tall) > height:
        return None
    found, top, spare = [], height, (height - sum(tall)) / (len(lines) + 1)
    for line, line_tall, line_wide in zip(lines, tall, wide, strict=True):
        top -= spare
        gap = (width - line_wide) / (len(line) + 1)
        left = gap
        for block in line:
            up = top - block.size_mm[1]
            found += [(view, (left + x, up + y)) for view, (x, y) in block.views]
            left += block.size_mm[0] + gap
        top -= line_tall
    return found


def layout(
    blocks: Callable[[float, float], Sequence[ViewBlock]],
    crankpin_mm: float,
    column_fits: Callable[[float], bool],
) -> SheetLayout:
    """Return the layout on the smallest sheet on which crankpins are large enough, else the largest on A0.

    `blocks` gives them at a scale of the crank and one of its webs; `column_fits` tells whether the column's
    text fits into a height.
    """
    best = None
    for sheet, (width, height) in SHEETS_MM.items():
        area = width - 2 * BORDER_MM - COLUMN_MM, height - 2 * BORDER_MM
        best = _largest(sheet, blocks, area) or best
        if best and _readable(best, crankpin_mm) and best.sheet == sheet and column_fits(area[1]):
            return best
    assert best is not None  # the smallest scale fits on A0
    return best


def _largest(
    sheet: str, blocks: Callable[[float, float], Sequence[ViewBlock]], area: tuple[float, float]
) -> SheetLayout | None:
    """The largest scale of the crank that fits, with the largest of the webs beside it."""
    for scale in SCALES:
        fitting = None
        for web_scale in sorted(one for one in SCALES if scale <= one <= 5 * scale):
            views = rows(blocks(scale, web_scale), *area)
            if views is None:
                break
            fitting = SheetLayout(sheet, scale, web_scale, tuple(views))
        if fitting:
            return fitting
    return None


def _readable(sheet_layout: SheetLayout, crankpin_mm: float) -> bool:
    return (
        sheet_layout.scale * crankpin_mm >= _LEAST_MM
        and sheet_layout.web_scale * crankpin_mm >= _LEAST_WEB_MM
    )
