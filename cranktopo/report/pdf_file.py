"""A report as PDF of A4: text, tables and pictures one below the other, numbered pages."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from cranktopo.base.files import replacing
from cranktopo.report.page import Fact, Page, Section
from cranktopo.report.pdf_blocks import HEIGHT, MARGIN, ROOM, WIDTH, Block, gap, table, words
from cranktopo.report.plot import Picture, png
from cranktopo.report.result_table import ResultTable

_BAD, _BETWEEN, _DPI = "#a52a1c", 12.0, 300.0
_SHORT = 240.0
"""Height of a table, or of a text with one, that a page takes whole, as less than a third of it."""
_LEAST, _MOST = 90.0, 650.0
"""Room below a title: what it has in any case, and what it asks for at most, as pages have little more."""
_GAP = 8.0
"""Largest height of a block that is room between others."""


def write_pdf(page: Page, path: Path, document: str) -> None:
    """Write a report as PDF; the number of the document and of each page are at its foot."""
    from matplotlib.backends.backend_pdf import PdfPages

    parted = sheets(list(blocks(page)))
    with replacing(path) as temporary:
        buffer = io.BytesIO()
        with PdfPages(buffer, metadata={"Title": page.title, "CreationDate": None}) as pdf:
            for number, own in enumerate(parted, start=1):
                pdf.savefig(_sheet(own, f"{document}, page {number} of {len(parted)}"))
        temporary.write_bytes(buffer.getvalue())


def blocks(page: Page) -> Iterator[Block]:
    """Yield the blocks of a report in order."""
    yield from words(page.title, 16, weight="bold")
    yield from words(page.subtitle, 10)
    yield gap(8)
    yield from words(page.headline, 11, weight="bold")
    yield gap(6)
    for fact in page.verdict:
        yield from _fact(fact)
    for section in page.sections:
        if section.on_paper:
            yield from _section(section)


def _fact(fact: Fact) -> Iterator[Block]:
    note = f" ({fact.note})" if fact.note else ""
    colour = _BAD if fact.status == "bad" else "black"
    yield from words(f"{fact.label}: {fact.value}{note}", 9, color=colour)
    yield gap(2)


def _section(section: Section) -> Iterator[Block]:
    """Yield a section; its title stays with a short text and the start of what is below it."""
    paragraphs = (paragraph.replace("`", "") for paragraph in section.paragraphs)
    text = [block for paragraph in paragraphs for block in (gap(3), *words(paragraph, 9))]
    below = [block for caption, found in section.tables for block in _table(caption, found)]
    below += _pictures(section.pictures)
    yield gap(14)
    yield from words(section.title, 13, weight="bold", keep=max(_LEAST, _start(text, below)))
    yield from text
    yield from below


def _start(text: Sequence[Block], below: Sequence[Block]) -> float:
    """Return the height of a text and of the start of what is below it; 0 where a title does without that."""
    height = sum(block.height for block in text)
    gaps = next((number for number, block in enumerate(below) if block.height > _GAP), 0)
    first = below[: gaps + 1]
    start = height + sum(block.height for block in first) + (first[-1].keep if first else 0.0)
    fits = start < _SHORT or (height < _LEAST and start < _MOST)
    return start if fits else 0.0


def _table(caption: str, result_table: ResultTable) -> Iterator[Block]:
    """Yield a table below its caption: a short one is not parted."""
    rows = list(table(result_table))
    height = sum(row.height for row in rows)
    start = height if height < _SHORT else rows[0].height + rows[0].keep
    yield gap(8)
    yield from words(caption, 9.5, weight="bold", keep=max(50.0, 2.0 + start))
    yield gap(2)
    yield from rows


def _pictures(pictures: Sequence[Picture]) -> Iterator[Block]:
    """Yield sheets on a page of their own, wide pictures alone and others in pairs."""
    waiting: list[Picture] = []
    yield from (_turned(one) for one in pictures if one.sheet)
    for one in (one for one in pictures if not one.sheet):
        if one.wide or len(waiting) == 2:
            yield from _side_by_side(waiting)
            waiting = []
        if one.wide:
            yield from _side_by_side([one])
        else:
            waiting.append(one)
    yield from _side_by_side(waiting)


def _turned(sheet: Picture) -> Block:
    """Return a drawing turned by a right angle, as large as a page allows."""
    long, short = (72 * inches for inches in sheet.figure.get_size_inches())
    scale = min((HEIGHT - 2 * MARGIN) / long, ROOM / short)
    width, height = scale * short, scale * long

    def draw(figure: Any, y: float) -> None:
        axes = figure.add_axes((MARGIN / WIDTH, (y - height) / HEIGHT, width / WIDTH, height / HEIGHT))
        _paste(axes, sheet, _DPI * scale, turns=1)

    return Block(height, draw)


def _side_by_side(pictures: Sequence[Picture]) -> Iterator[Block]:
    if not pictures:
        return
    wide = pictures[0].wide
    width = ROOM if wide else (ROOM - _BETWEEN) / 2
    heights = [width / one.figure.get_size_inches()[0] * one.figure.get_size_inches()[1] for one in pictures]

    def draw(figure: Any, y: float) -> None:
        for number, (one, height) in enumerate(zip(pictures, heights, strict=True)):
            left = MARGIN + number * (width + _BETWEEN)
            places = (left / WIDTH, (y - 8 - height) / HEIGHT, width / WIDTH, height / HEIGHT)
            _paste(figure.add_axes(places), one, _DPI * width / 72 / one.figure.get_size_inches()[0])

    yield Block(max(heights) + 8.0, draw)


def _paste(axes: Any, pasted: Picture, dpi: float, turns: int = 0) -> None:
    """Paste a picture as pixels, turned to the left by right angles."""
    from matplotlib.image import imread
    from numpy import rot90

    axes.imshow(rot90(imread(io.BytesIO(png(pasted.figure, dpi, "white"))), turns), aspect="auto")
    axes.axis("off")


def sheets(ordered: Sequence[Block]) -> list[list[Block]]:
    """Return the blocks of each page, none of them parted."""
    room = HEIGHT - 2 * MARGIN
    found: list[list[Block]] = [[]]
    used = 0.0
    for block in ordered:
        if used and used + block.height + block.keep > room:
            found.append([block.head] if block.head else [])
            used = block.head.height if block.head else 0.0
        found[-1].append(block)
        used += block.height
    return found


def _sheet(own: Sequence[Block], foot: str) -> Any:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH / 72, HEIGHT / 72))
    FigureCanvasAgg(figure)
    y = HEIGHT - MARGIN
    for block in own:
        block.draw(figure, y)
        y -= block.height
    figure.text(0.5, 0.5 * MARGIN / HEIGHT, foot, fontsize=8, ha="center", parse_math=False)
    return figure
