"""Blocks of a page of paper: lines of text and ruled tables, broken by the width of their letters; points."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

from cranktopo.report.result_table import ResultTable
from cranktopo.report.typeset import typeset

WIDTH, HEIGHT, MARGIN = 595.0, 842.0, 48.0
"""A4."""
ROOM = WIDTH - 2 * MARGIN
LEADING = 1.35
_SIZES = (8.0, 7.5, 7.0, 6.5, 6.0, 5.5)
"""Of the letters of a table: the largest that all columns find room in."""
_GAP, _PAD = 10.0, 2.5
"""Between columns, and between a row and its rules."""
_RULE, _UNIT = "#bbbbbb", "#555555"
_TOGETHER = 3
"""Rows at the end of a table that stay on one page."""
_WORDS = 60.0
"""A column of words is made no narrower than this, or than its longest word."""


@dataclass(frozen=True)
class Block:
    """Something that is not parted between pages.

    Attributes:
        draw: draws it on a figure from a height above the foot of the page downwards.
        keep: room that must be left below it.
        head: what stands above it where it is the first of a page.
    """

    height: float
    draw: Callable[[Any, float], None]
    keep: float = 0.0
    head: Block | None = None


def gap(height: float) -> Block:
    """Return room with nothing in it."""
    return Block(height, lambda *_: None)


def words(text: str, size: float, keep: float = 0.0, **style: Any) -> Iterator[Block]:
    """Yield a text line by line over the whole width; one with room below it is not parted."""
    lines = _wrapped(typeset(text), ROOM, size, style.get("weight", "normal"))
    for after, line in zip(reversed(range(len(lines))), lines, strict=True):
        below = keep and keep + after * LEADING * size
        yield Block(LEADING * size, _Text(line, 0.0, size, tuple(style.items())), below)


@dataclass(frozen=True)
class _Text:
    """A line of text at a place from the left margin; it is drawn below a height."""

    text: str
    left: float
    size: float
    style: tuple[tuple[str, Any], ...] = ()

    def __call__(self, figure: Any, y: float) -> None:
        at = ((MARGIN + self.left) / WIDTH, y / HEIGHT)
        figure.text(*at, self.text, fontsize=self.size, va="top", parse_math=False, **dict(self.style))


@dataclass(frozen=True)
class _Column:
    """A column of a table: its head and unit, its cells, and whether these stand on the right."""

    head: str
    unit: str
    cells: tuple[str, ...]
    right: bool

    def natural(self, size: float) -> float:
        """Return the width in which nothing is broken."""
        heads = max(_width(self.head, size, "bold"), _width(self.unit, size))
        return max(heads, *(_width(cell, size) for cell in self.cells), 0.0)

    def least(self, size: float) -> float:
        """Return the width in which no word is broken; numbers are not."""
        longest = max((_width(word, size, "bold") for word in self.head.split()), default=0.0)
        if self.right:
            return max(longest, _width(self.unit, size), *(_width(cell, size) for cell in self.cells), 0.0)
        inside = max((_width(word, size) for cell in self.cells for word in cell.split(" ")), default=0.0)
        return max(longest, min(self.natural(size), max(_WORDS, inside)))


def table(result_table: ResultTable) -> Iterator[Block]:
    """Yield a table row by row under rules; its head stands again on each page, and no last row alone."""
    columns = [_column(result_table, name) for name in result_table.columns]
    headless = list(result_table.columns) == ["what", "value"]
    size, widths = _sizes(columns)
    head = None if headless else _head(columns, widths, size)
    rows = [
        _row(columns, [column.cells[row] for column in columns], widths, size, head)
        for row in range(len(result_table.rows))
    ]
    if head is not None:
        yield replace(head, keep=sum(row.height for row in rows[:_TOGETHER]))
    for number, row in enumerate(rows):
        after = rows[number + 1 :]
        unparted = len(after) < _TOGETHER
        yield replace(row, keep=sum(other.height for other in after)) if unparted else row


def _column(result_table: ResultTable, name: str) -> _Column:
    label, unit = result_table.head(name)
    cells = tuple(typeset(result_table.page_cell(row, name)) for row in range(len(result_table.rows)))
    first = name == next(iter(result_table.columns))
    return _Column(label, typeset(unit), cells, not first and not result_table.is_text(name))


def _sizes(columns: Sequence[_Column]) -> tuple[float, list[float]]:
    """Return the size of the letters, and the widths of the columns that fit side by side."""
    room = ROOM - _GAP * (len(columns) - 1)
    for size in _SIZES:
        least = [column.least(size) for column in columns]
        if sum(least) <= room:
            break
    natural = [column.natural(size) for column in columns]
    if sum(natural) <= room:
        return size, natural
    stretch = [most - width for most, width in zip(natural, least, strict=True)]
    share = max(0.0, room - sum(least)) / (sum(stretch) or 1.0)
    return size, [width + share * more for width, more in zip(least, stretch, strict=True)]


def _head(columns: Sequence[_Column], widths: Sequence[float], size: float) -> Block:
    lines = [
        [(line, "bold", "black") for line in _wrapped(column.head, width, size, "bold")]
        + [(column.unit, "normal", _UNIT)] * bool(column.unit)
        for column, width in zip(columns, widths, strict=True)
    ]
    most = max(map(len, lines))
    lines = [[("", "normal", "black")] * (most - len(column)) + column for column in lines]
    return _cells(columns, lines, widths, size)


def _row(
    columns: Sequence[_Column], cells: Sequence[str], widths: Sequence[float], size: float, head: Block | None
) -> Block:
    lines = [
        [(line, "normal", "black") for line in _wrapped(cell, width, size)]
        for cell, width in zip(cells, widths, strict=True)
    ]
    block = _cells(columns, lines, widths, size)
    return Block(block.height, block.draw, head=head)


def _cells(
    columns: Sequence[_Column],
    lines: Sequence[Sequence[tuple[str, str, str]]],
    widths: Sequence[float],
    size: float,
) -> Block:
    """Return cells side by side above a rule; each line is a text, its weight and its colour."""
    texts: list[tuple[float, _Text]] = []
    left = 0.0
    for column, cell, width in zip(columns, lines, widths, strict=True):
        for number, (line, weight, colour) in enumerate(cell):
            at = left + (width if column.right else 0.0)
            style = (("ha", "right" if column.right else "left"), ("weight", weight), ("color", colour))
            texts.append((_PAD + number * LEADING * size, _Text(line, at, size, style)))
        left += width + _GAP
    height = LEADING * size * max(map(len, lines)) + 2 * _PAD

    def draw(figure: Any, y: float) -> None:
        for down, text in texts:
            text(figure, y - down)
        _rule(figure, y - height, left - _GAP)

    return Block(height, draw)


def _rule(figure: Any, y: float, length: float) -> None:
    from matplotlib.lines import Line2D

    ends = [MARGIN / WIDTH, (MARGIN + length) / WIDTH]
    figure.add_artist(Line2D(ends, [y / HEIGHT, y / HEIGHT], color=_RULE, linewidth=0.5))


def _wrapped(text: str, width: float, size: float, weight: str = "normal") -> list[str]:
    """Return a text in lines of that width; a word that is wider is parted where it must be.

    Its own line breaks are those of the terminal, and count as spaces.
    """
    lines = [""]
    for word in text.replace("\n", " ").split(" "):
        tried = f"{lines[-1]} {word}".strip(" ")
        if _width(tried, size, weight) <= width + 0.01:
            lines[-1] = tried
            continue
        lines += [word] if lines[-1] else []
        lines[-1] = word
        while _width(lines[-1], size, weight) > width + 0.01 and len(lines[-1]) > 1:
            fits = next(
                n for n in range(len(lines[-1]) - 1, 0, -1) if _fits(lines[-1], n, width, size, weight)
            )
            lines[-1:] = [lines[-1][:fits], lines[-1][fits:]]
    return lines


def _fits(word: str, letters: int, width: float, size: float, weight: str) -> bool:
    return letters == 1 or _width(word[:letters], size, weight) <= width


@lru_cache(maxsize=20_000)
def _width(text: str, size: float, weight: str = "normal") -> float:
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    properties = FontProperties(size=size, weight=weight)
    return float(text_to_path.get_text_width_height_descent(text, properties, False)[0])
