"""One table, many forms: terminal, Markdown, CSV, JSON rows; and plain text tables that wrap."""

from __future__ import annotations

import csv
import io
import math
import re
import textwrap
from bisect import bisect_right
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Generic, TypeVar

from cranktopo.base.line_width import WIDTH
from cranktopo.base.units import enough_decimals, stem_and_unit

_WORDS = 16
"""A column of words is not made narrower; where that does not suffice the table is folded by columns."""
_LONGEST_WORD = 38
"""A longer word is broken: two such columns still fit."""


@dataclass(frozen=True)
class _Printed:
    """A column for the terminal: its head and the unit below it, its cells, the side that they stand on."""

    head: str
    unit: str
    cells: Sequence[str]
    right: bool

    @cached_property
    def longest_cell(self) -> int:
        """Letters of the longest cell, or of the unit."""
        return max(map(len, (self.unit, *self.cells)))

    @cached_property
    def longest_word(self) -> int:
        """Letters of the longest word that is kept whole, of the head as of the cells."""
        words = (word for text in (self.head, *self.cells) for word in text.split())
        return min(max(map(len, words), default=0), _LONGEST_WORD)

    def width(self, most: int) -> int:
        """Return the letters that it takes where cells of more than `most` go on in the next line."""
        if most >= WIDTH:
            return max(len(self.head), self.longest_cell)
        return max(min(self.longest_cell, most), self.longest_word)

    def lines(self, text: str, width: int) -> list[str]:
        """Return a text in lines of that width; one that goes on is read from the left."""
        wrapped = textwrap.wrap(text, width, break_on_hyphens=False) or [""]
        left = not self.right or (len(wrapped) > 1 and text in self.cells)
        return [line.ljust(width) if left else line.rjust(width) for line in wrapped]

    def heads(self, width: int) -> list[str]:
        """Return the lines of the head, the unit last."""
        return [*self.lines(self.head, width), self.lines(self.unit, width)[0]]


def text_table(align: str, header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return columns two spaces apart in lines of at most `WIDTH` letters.

    Args:
        align: one letter per column, `l` or `r`.
        header: a unit behind a line break stands below its word; without words there is no line for it.
    """
    columns = zip(header, align, zip(*rows, strict=True) if rows else [()] * len(header), strict=True)
    printed = [_Printed(*head.partition("\n")[::2], cells, side == "r") for head, side, cells in columns]
    return _folded(printed, ruled=False)


def labelled(rows: Sequence[tuple[str, str]]) -> str:
    """Return texts beside their labels; a long text goes on below itself."""
    return text_table("ll", ("", ""), rows)


def _folded(columns: Sequence[_Printed], ruled: bool) -> str:
    """Return the columns in as few blocks as fit, one below the other."""
    return "\n\n".join(_block(block, ruled) for block in _like_blocks(columns))


def _like_blocks(columns: Sequence[_Printed]) -> list[list[_Printed]]:
    """Return as few blocks as fit, much alike in width, each with the names of the rows."""
    fewest = len(_blocks(columns, WIDTH))
    rooms = range(WIDTH // 2 if fewest > 1 else WIDTH, WIDTH + 1)
    return next(found for room in rooms if len(found := _blocks(columns, room)) == fewest)


def _blocks(columns: Sequence[_Printed], room: int) -> list[list[_Printed]]:
    """Return blocks that begin with what names a row and take on the next columns while these find room."""
    names = _names(columns)
    blocks = [[*names]]
    for column in columns[len(names) :]:
        tried = [*blocks[-1], column]
        if len(tried) > len(names) + 1 and _fitting(tried, room) is None:
            tried = [*names, column]
            blocks.append(tried)
        blocks[-1] = tried
    return blocks


def _names(columns: Sequence[_Printed]) -> Sequence[_Printed]:
    """Return the first columns, as many as tell rows apart; one where two do not, or take half the width."""
    for names in (columns[:1], columns[:2]):
        rows = list(zip(*(column.cells for column in names), strict=True))
        widths = [column.width(_WORDS) for column in names]
        if len(set(rows)) == len(rows) and sum(widths) + 2 * (len(widths) - 1) <= WIDTH // 2 + _WORDS:
            return names
    return columns[:1]


def _fitting(columns: Sequence[_Printed], room: int) -> list[int] | None:
    """Return the widest widths at which the columns fit side by side, heads broken last; None if none do."""
    left, tried = room - 2 * (len(columns) - 1), range(_WORDS, WIDTH + 1)
    fits = bisect_right(tried, left, key=lambda most: sum(column.width(most) for column in columns))
    return [column.width(tried[fits - 1]) for column in columns] if fits else None


def _block(columns: Sequence[_Printed], ruled: bool) -> str:
    widths = _fitting(columns, WIDTH) or [column.width(_WORDS) for column in columns]
    heads = [column.heads(width) for column, width in zip(columns, widths, strict=True)]
    most = max(map(len, heads))
    heads = [[" " * width] * (most - len(head)) + head for head, width in zip(heads, widths, strict=True)]
    lines = [line for line in zip(*heads, strict=True) if "".join(line).strip()]
    lines += [tuple("-" * width for width in widths)] * ruled
    for row in zip(*(column.cells for column in columns), strict=True):
        texts = zip(columns, row, widths, strict=True)
        cells = [column.lines(text, width) for column, text, width in texts]
        blank = [" " * width for width in widths]
        for number in range(max(map(len, cells))):
            lines.append(
                tuple(c[number] if number < len(c) else b for c, b in zip(cells, blank, strict=True))
            )
    return "\n".join("  ".join(line).rstrip() for line in lines)


_SPECIAL = re.compile(r"([\\`*_|\[\]<>~&$#])")
"""Signs that Markdown and its tables read as their own anywhere in a line."""
_LIST = re.compile(r"^(\d*)([+.)-])(?=[\s-]|$)")
"""Starts of a line that make it a list or a rule."""
_SIGNIFICANT, _GROUPED = 4, 1e4
"""Digits beyond which an error of a percent leaves no sense; numbers from which thousands stand apart."""
_LINE = 24
"""Letters of a cell that may break."""
_BY_SIZE = frozenset(("N", "kN", "N m", "kg", "kg mm", "kg mm2", "N m/rad", "kN m/rad", "N/mm", "kN/mm"))
"""Units of what grows by powers with the size of a crank, from a model engine's to a ship's."""
_EXACT = ("", "mm", "deg")
"""Units of what is known to more digits than these, or of nothing in particular."""
T = TypeVar("T")
Cell = str | float | None
Row = Mapping[str, Cell]


@dataclass(frozen=True)
class ResultTable:
    """A table of text and numbers; columns have names, never positions.

    Attributes:
        columns: decimals by machine name, in order; the name ends in the unit, e.g. `mass_kg`. Text ignores
            the decimals.
        rows: cells by column; None prints as a dash.
        best: row number and column of the cells to mark as best.
    """

    columns: Mapping[str, int]
    rows: tuple[Row, ...]
    best: frozenset[tuple[int, str]] = frozenset()

    def head(self, column: str) -> tuple[str, str]:
        """Label and unit of a column: `torsion_kNm_per_rad` gives ("torsion", "kN m/rad")."""
        stem, unit = stem_and_unit(column)
        return stem.replace("_", " "), unit

    def is_text(self, column: str) -> bool:
        """Tell whether a column holds words."""
        return any(isinstance(row[column], str) for row in self.rows)

    def is_prose(self, column: str) -> bool:
        """Tell whether a column holds so many words that they break into lines."""
        cells = (self.cell(row, column) for row in range(len(self.rows)))
        return self.is_text(column) and max(map(len, cells), default=0) > _LINE

    @property
    def has_prose(self) -> bool:
        """True if a column after the first does."""
        return any(map(self.is_prose, list(self.columns)[1:]))

    def cell(self, row: int, column: str) -> str:
        """Return a cell as text, rounded, with a trailing `*` where it is marked as best."""
        return self._printed(row, column, lambda value: f"{value:z.{self._decimals[column]}f}")

    def page_cell(self, row: int, column: str) -> str:
        """Return a cell as a page shows it: four digits of a column's largest value, thousands in groups."""
        digits = self._page_decimals[column]
        return self._printed(
            row, column, lambda value: f"{value:,.0f}" if abs(value) >= _GROUPED else f"{value:z.{digits}f}"
        )

    def _printed(self, row: int, column: str, number: Callable[[float], str]) -> str:
        value = self.rows[row][column]
        if value is None:
            return "-"
        text = value if isinstance(value, str) else number(value)
        return f"{text}*" if (row, column) in self.best else text

    @cached_property
    def _decimals(self) -> dict[str, int]:
        """Decimals by column; of what grows with the crank three digits where these leave one or none."""
        return {
            column: enough_decimals(self._largest(column), digits)
            if stem_and_unit(column)[1] in _BY_SIZE
            else digits
            for column, digits in self.columns.items()
        }

    @cached_property
    def _page_decimals(self) -> dict[str, int]:
        """Decimals by column; lengths and angles keep theirs, and so does what mixes units."""
        return {
            column: digits if stem_and_unit(column)[1] in _EXACT else min(digits, self._sensible(column))
            for column, digits in self._decimals.items()
        }

    def _sensible(self, column: str) -> int:
        largest = self._largest(column)
        if 0 < largest < 1:
            return enough_decimals(largest, _SIGNIFICANT - 1)
        return max(0, _SIGNIFICANT - len(str(int(largest))))

    def _largest(self, column: str) -> float:
        values = (row[column] for row in self.rows)
        sizes = (abs(value) for value in values if isinstance(value, int | float) and math.isfinite(value))
        return max(sizes, default=0.0)

    def cells(self, row: int) -> list[str]:
        """Return all cells of a row as text."""
        return [self.cell(row, column) for column in self.columns]


@dataclass(frozen=True)
class Column(Generic[T]):
    """A column of a table of like things: its machine name, its decimals, and where a thing holds it."""

    name: str
    digits: int
    read: Callable[[T], Cell]


def tabulate(
    columns: Sequence[Column[T]], things: Iterable[T], best: frozenset[tuple[int, str]] = frozenset()
) -> ResultTable:
    """Return one row per thing."""
    rows = tuple({column.name: column.read(thing) for column in columns} for thing in things)
    return ResultTable({column.name: column.digits for column in columns}, rows, best)


def terminal(table: ResultTable) -> str:
    """Return the table for a terminal: right-aligned numbers, a column's head broken at its unit."""
    return _folded(list(_printed(table).values()), ruled=True)


def _printed(table: ResultTable) -> dict[str, _Printed]:
    rows = range(len(table.rows))
    return {
        column: _Printed(*table.head(column), [table.cell(row, column) for row in rows], number > 0)
        for number, column in enumerate(table.columns)
    }


def folded(table: ResultTable) -> list[ResultTable]:
    """Return the blocks that a terminal shows a table in as tables, each with the names of the rows."""
    printed = _printed(table)
    names = {id(column): name for name, column in printed.items()}
    blocks = [[names[id(one)] for one in block] for block in _like_blocks(list(printed.values()))]
    return [replace(table, columns={name: table.columns[name] for name in block}) for block in blocks]


def markdown(table: ResultTable) -> str:
    """Return the table as GitHub Markdown."""
    first = next(iter(table.columns))
    head = " | ".join(" ".join(table.head(column)).strip() for column in table.columns)
    rule = " | ".join("---" if c == first or table.is_text(c) else "---:" for c in table.columns)
    rows = [
        " | ".join(_markdown_cell(table, row, c) for c in table.columns) for row in range(len(table.rows))
    ]
    return "\n".join(f"| {line} |" for line in (head, rule, *rows))


def _markdown_cell(table: ResultTable, row: int, column: str) -> str:
    """Return a cell whose words are shown as they are; the star of the best value stays a star."""
    text = table.cell(row, column)
    if table.rows[row][column] is None:
        return text
    best = (row, column) in table.best
    return escaped(text.removesuffix("*") if best else text) + "*" * best


def escaped(text: str) -> str:
    """Return the text on one line, so that Markdown shows it as it is."""
    return _LIST.sub(r"\1\\\2", _SPECIAL.sub(r"\\\1", " ".join(text.split())))


def no_formula(value: Any) -> Any:
    """Return a cell of a CSV file; a text that a spreadsheet would run as a formula gets an apostrophe first.

    Source: OWASP, CSV injection.
    """
    risky = isinstance(value, str) and len(value) > 1 and value[0] in "=+-@\t\r"
    return f"'{value}" if risky else value


def comma_separated(table: ResultTable) -> str:
    """Return the table as CSV with machine names and full precision."""
    stream = io.StringIO()
    writer = csv.DictWriter(stream, table.columns, lineterminator="\n")
    writer.writeheader()
    writer.writerows({name: no_formula(value) for name, value in row.items()} for row in table.rows)
    return stream.getvalue().rstrip("\n")


def records(table: ResultTable) -> list[dict[str, Any]]:
    """Return the rows as objects keyed by machine name, full precision."""
    return [dict(row) for row in table.rows]
