"""One table, four faces: terminal, Markdown, CSV, JSON rows."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class ResultTable:
    """A table of text and numbers.

    Attributes:
        columns: machine name of each column, unit included, e.g. `mass_kg`.
        rows: one tuple per row; None prints as a dash.
        digits: decimals per column (ignored for text).
        marks: (row, column) cells to mark as best.
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[str | float | None, ...], ...]
    digits: tuple[int, ...]
    marks: frozenset[tuple[int, int]] = frozenset()

    @property
    def heads(self) -> tuple[tuple[str, str], ...]:
        """Label and unit of each column."""
        return tuple(_head(name) for name in self.columns)

    def is_text(self, column: int) -> bool:
        """Whether a column holds words."""
        return any(isinstance(row[column], str) for row in self.rows)

    def longest(self, column: int) -> int:
        """Letters of the longest cell of a column."""
        return max((len(self.cell(row, column)) for row in range(len(self.rows))), default=0)

    def cell(self, row: int, column: int) -> str:
        """A cell as text, rounded, with a trailing `*` where it is marked.

        Args:
            row, column: position of the cell.
        """
        value = self.rows[row][column]
        if value is None:
            return "-"
        text = value if isinstance(value, str) else f"{value:.{self.digits[column]}f}"
        return f"{text}*" if (row, column) in self.marks else text


def terminal(table: ResultTable) -> str:
    """The table for a terminal: right-aligned numbers, a column's head broken at its unit."""
    heads = table.heads
    body = [[table.cell(r, c) for c in range(len(table.columns))] for r in range(len(table.rows))]
    lines = [[head[part] for head in heads] for part in (0, 1)] + body
    widths = [max(len(line[c]) for line in lines) for c in range(len(heads))]
    return "\n".join(_align(line, widths) for line in [*lines[:2], ["-" * w for w in widths], *lines[2:]])


def markdown(table: ResultTable) -> str:
    """The table as GitHub Markdown."""
    numbers = range(len(table.columns))
    head = " | ".join(" ".join(head).strip() for head in table.heads)
    rule = " | ".join("---" if c == 0 or table.is_text(c) else "---:" for c in numbers)
    rows = [" | ".join(table.cell(r, c).replace("|", "\\|") for c in numbers) for r in range(len(table.rows))]
    return "\n".join(f"| {line} |" for line in (head, rule, *rows))


def comma_separated(table: ResultTable) -> str:
    """The table as CSV with machine names and full precision."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(table.columns)
    writer.writerows(table.rows)
    return stream.getvalue().rstrip("\n")


def records(table: ResultTable) -> list[dict[str, Any]]:
    """The rows as objects keyed by machine name, full precision."""
    return [dict(zip(table.columns, row, strict=True)) for row in table.rows]


_UNITS = {
    "kg": "kg",
    "kg_mm": "kg mm",
    "kg_mm2": "kg mm2",
    "kNm_per_rad": "kN m/rad",
    "kNm_per_rad_kg": "kN m/rad/kg",
    "kN_per_mm": "kN/mm",
    "kN_per_mm_kg": "kN/mm/kg",
    "N_mm": "N mm",
    "N": "N",
    "Nm": "N m",
    "percent": "%",
    "mm": "mm",
    "mm3": "mm3",
    "s": "s",
    "deg": "deg",
    "MPa": "MPa",
    "MiB": "MiB",
    "per_mm": "1/mm",
}


def _head(name: str) -> tuple[str, str]:
    """Label and unit of a machine name: `torsion_kNm_per_rad` gives ("torsion", "kN m/rad")."""
    for suffix in sorted(_UNITS, key=len, reverse=True):
        if name.endswith(f"_{suffix}"):
            return name[: -len(suffix) - 1].replace("_", " "), _UNITS[suffix]
    return name.replace("_", " "), ""


def _align(cells: Sequence[str], widths: Sequence[int]) -> str:
    numbers = [cell.rjust(width) for cell, width in zip(cells[1:], widths[1:], strict=True)]
    return "  ".join([cells[0].ljust(widths[0]), *numbers]).rstrip()
