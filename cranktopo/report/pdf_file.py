"""A report as PDF of A4: text, tables and pictures one below the other, numbered pages."""

from __future__ import annotations

import io
import textwrap
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cranktopo.base.files import replacing
from cranktopo.report.page import Page, Section
from cranktopo.report.plot import Picture, png
from cranktopo.report.result_table import ResultTable, text_table

_WIDTH, _HEIGHT, _MARGIN = 595.0, 842.0, 48.0
"""A4 in points."""
_ROOM = _WIDTH - 2 * _MARGIN
_LETTER = 0.61
"""Width of a letter of the monospaced font over its size."""
_LEADING = 1.35


@dataclass(frozen=True)
class _Block:
    """Something that is not parted between pages; `keep` is room that must be left below it."""

    height: float
    draw: Callable[[Any, float], None]
    keep: float = 0.0


def write_pdf(page: Page, path: Path, document: str) -> None:
    """Write a report as PDF; the number of the document and of each page are at its foot."""
    from matplotlib.backends.backend_pdf import PdfPages

    sheets = _sheets(list(_blocks(page)))
    with replacing(path) as temporary:
        made = io.BytesIO()
        with PdfPages(made, metadata={"Title": page.title, "CreationDate": None}) as pdf:
            for number, blocks in enumerate(sheets, start=1):
                pdf.savefig(_sheet(blocks, f"{document}, page {number} of {len(sheets)}"))
        temporary.write_bytes(made.getvalue())


def _blocks(page: Page) -> Iterator[_Block]:
    yield from _words(page.title, 16, weight="bold")
    yield from _words(page.subtitle, 10)
    yield from _words(page.headline, 11, weight="bold")
    for fact in page.facts:
        yield from _words(f"{fact.label}: {fact.value} ({fact.note})", 9)
    for section in page.sections:
        if section.on_paper:
            yield from _section(section)


def _section(section: Section) -> Iterator[_Block]:
    yield _Block(10.0, lambda *_: None)
    yield from _words(section.title, 13, weight="bold", keep=90.0)
    yield from _words(section.text, 9)
    for caption, table in section.tables:
        yield from _words(caption, 9.5, weight="bold", keep=50.0)
        yield from _table(table)
    for shown in section.pictures:
        yield _picture(shown)


def _words(text: str, size: float, keep: float = 0.0, **style: Any) -> Iterator[_Block]:
    for line in textwrap.wrap(text, int(_ROOM / (0.53 * size))):
        yield _line(line, size, keep, **style)


def _table(table: ResultTable) -> Iterator[_Block]:
    heads = [" ".join(table.head(column)).strip() for column in table.columns]
    rows = [table.cells(number) for number in range(len(table.rows))]
    align = "".join("l" if table.is_text(column) else "r" for column in table.columns)
    lines = text_table(align, heads, rows).splitlines()
    size = min(8.0, _ROOM / (_LETTER * max(map(len, lines), default=1)))
    for number, line in enumerate(lines):
        yield _line(line, size, family="monospace", weight="normal" if number else "bold")
    yield _Block(6.0, lambda *_: None)


def _line(text: str, size: float, keep: float = 0.0, **style: Any) -> _Block:
    def draw(figure: Any, y: float) -> None:
        at = (_MARGIN / _WIDTH, y / _HEIGHT)
        figure.text(*at, text, fontsize=size, va="top", parse_math=False, **style)

    return _Block(_LEADING * size, draw, keep)


def _picture(shown: Picture) -> _Block:
    wide, high = shown.figure.get_size_inches()
    width = _ROOM if shown.wide else 0.7 * _ROOM
    height = width * high / wide

    def draw(figure: Any, y: float) -> None:
        from matplotlib.image import imread

        places = (_MARGIN / _WIDTH, (y - height) / _HEIGHT, width / _WIDTH, height / _HEIGHT)
        axes = figure.add_axes(places)
        axes.imshow(imread(io.BytesIO(png(shown.figure, 200, "white"))), aspect="auto")
        axes.axis("off")

    return _Block(height + 8.0, draw)


def _sheets(blocks: Sequence[_Block]) -> list[list[_Block]]:
    room = _HEIGHT - 2 * _MARGIN
    sheets: list[list[_Block]] = [[]]
    used = 0.0
    for block in blocks:
        if used and used + block.height + block.keep > room:
            sheets.append([])
            used = 0.0
        sheets[-1].append(block)
        used += block.height
    return sheets


def _sheet(blocks: Sequence[_Block], foot: str) -> Any:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(_WIDTH / 72, _HEIGHT / 72))
    FigureCanvasAgg(figure)
    y = _HEIGHT - _MARGIN
    for block in blocks:
        block.draw(figure, y)
        y -= block.height
    figure.text(0.5, 0.5 * _MARGIN / _HEIGHT, foot, fontsize=8, ha="center", parse_math=False)
    return figure
