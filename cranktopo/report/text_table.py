"""Plain text tables that a terminal, a pipe and a README show alike."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from itertools import zip_longest


def text_table(
    align: str, header: Sequence[str], rows: Sequence[Sequence[str]], wrap: Mapping[int, int] | None = None
) -> str:
    """Columns padded to their widest cell, two spaces apart.

    Args:
        align: one letter per column, `l` or `r`.
        rows: cells, as many per row as the header has.
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
