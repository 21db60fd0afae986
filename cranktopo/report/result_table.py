"""One table, four forms: terminal, Markdown, CSV, JSON rows; and plain text tables that wrap."""

from __future__ import annotations

import csv
import io
import re
import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from typing import Any, Generic, TypeVar

from cranktopo.base.units import stem_and_unit


def text_table(
    align: str, header: Sequence[str], rows: Sequence[Sequence[str]], wrap: Mapping[int, int] | None = None
) -> str:
    """Return columns padded to their widest cell, two spaces apart.

    Args:
        align: one letter per column, `l` or `r`.
        wrap: greatest width of a column, by its index; longer cells continue on the next line.
    """
    limits = wrap or {}
    lines = [line for row in (header, *rows) for line in _wrapped(row, limits)]
    widths = [max(len(cell) for cell in column) for column in zip(*lines, strict=True)]
    return "\n".join(_padded(line, widths, align) for line in lines)


def _wrapped(row: Sequence[str], limits: Mapping[int, int]) -> list[tuple[str, ...]]:
    cells = [
        textwrap.wrap(cell, limits[index]) or [""] if index in limits else [cell]
        for index, cell in enumerate(row)
    ]
    return list(zip_longest(*cells, fillvalue=""))


def _padded(cells: Sequence[str], widths: Sequence[int], align: str) -> str:
    padded = [
        cell.ljust(width) if side == "l" else cell.rjust(width)
        for cell, width, side in zip(cells, widths, align, strict=True)
    ]
    return "  ".join(padded).rstrip()


_SPECIAL = re.compile(r"([\\`*_|\[\]<>~&$#])")
"""What Markdown and its tables read as a sign of their own anywhere in a line."""
_LIST = re.compile(r"^(\d*)([+.)-])(?=[\s-]|$)")
"""What begins a list, or is a rule, at the start of a line."""
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

    def longest(self, column: str) -> int:
        """Letters of the longest cell of a column."""
        return max((len(self.cell(row, column)) for row in range(len(self.rows))), default=0)

    def cell(self, row: int, column: str) -> str:
        """Return a cell as text, rounded, with a trailing `*` where it is marked as best."""
        value = self.rows[row][column]
        if value is None:
            return "-"
        text = value if isinstance(value, str) else f"{value:.{self.columns[column]}f}"
        return f"{text}*" if (row, column) in self.best else text

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
    heads = [table.head(column) for column in table.columns]
    body = [table.cells(row) for row in range(len(table.rows))]
    lines = [[head[part] for head in heads] for part in (0, 1)] + body
    widths = [max(map(len, cells)) for cells in zip(*lines, strict=True)]
    align = "l" + "r" * (len(heads) - 1)
    lines.insert(2, ["-" * width for width in widths])
    return "\n".join(_padded(line, widths, align) for line in lines)


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
