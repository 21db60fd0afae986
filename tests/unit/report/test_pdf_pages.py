"""A report as PDF: tables of ruled columns that fit the paper, rows whole, heads again on each page."""

from __future__ import annotations

from pathlib import Path

import pytest
from matplotlib.figure import Figure

from cranktopo.report.page import Fact, Page, Section, pairs
from cranktopo.report.pdf_blocks import HEIGHT, MARGIN, ROOM, Block, _wrapped, table
from cranktopo.report.pdf_file import _section, blocks, sheets, write_pdf
from cranktopo.report.plot import Picture, picture
from cranktopo.report.result_table import ResultTable

_LONG = "the largest radial force of the cycle on the web, and why it is that and no other of them"


def rows(count: int) -> ResultTable:
    cells = tuple(
        {"effect": f"effect {n}", "size_percent": 18.3, "because": _LONG, "leaving_it_out_changes": _LONG}
        for n in range(count)
    )
    return ResultTable({"effect": 0, "size_percent": 1, "because": 0, "leaving_it_out_changes": 0}, cells)


def drawn(block: Block) -> list[tuple[float, float, str]]:
    """Left and right end in points, and the text, of what a block draws."""
    figure = Figure(figsize=(595 / 72, 842 / 72), dpi=72)
    block.draw(figure, HEIGHT - MARGIN)
    boxes = [(text.get_window_extent(), text.get_text()) for text in figure.texts]
    return [(box.x0, box.x1, text) for box, text in boxes if text]


def test_line_breaks_of_the_terminal_are_spaces() -> None:
    """A font has no glyph for them, and what follows them would lie over the next block."""
    assert _wrapped("as one\nbody", 1e4, 9.0) == ["as one body"]


def test_columns_fit_side_by_side_and_lie_apart() -> None:
    head, *body = table(rows(2))
    for block in (head, *body):
        for left, right, _ in drawn(block):
            assert MARGIN - 1 <= left < right <= MARGIN + ROOM + 1
    (row, *_) = body
    texts = drawn(row)
    assert " ".join(text for left, _, text in texts if text in _LONG).count("the largest radial") == 2
    ends = sorted((left, right) for left, right, _ in texts)
    columns = sorted({round(left) for left, _ in ends})
    assert len(columns) >= 3


def test_a_number_is_not_parted_and_all_heads_are_bold() -> None:
    columns = {f"bending_of_shape_{n}_MPa": 1 for n in range(9)}
    head, row = table(
        ResultTable({"target": 0, **columns}, ({"target": "a-long-name", **dict.fromkeys(columns, 123.4)},))
    )
    assert [text for _, _, text in drawn(row)].count("123.4") == 9
    figure = Figure()
    head.draw(figure, HEIGHT)
    weights = {text.get_text(): text.get_weight() for text in figure.texts}
    assert weights["bending"] == "bold"
    assert weights["MPa"] == "normal"


def test_a_row_stays_whole_and_the_head_stands_on_every_page() -> None:
    page = Page("T", "t", "h", (), (Section("a", "A", "", (("Table", rows(90)),)),))
    found = sheets(list(blocks(page)))
    assert len(found) > 2
    assert all(sum(block.height for block in sheet) <= HEIGHT - 2 * MARGIN for sheet in found)
    for sheet in found[1:]:
        assert "effect" in [text for _, _, text in drawn(sheet[0])]


def test_a_short_table_is_not_parted_and_no_last_row_stands_alone() -> None:
    """Wherever on a page they begin: nine rows with their caption and title, and 72 rows."""
    material = [(f"quantity {n}", f"{n} MPa") for n in range(9)]
    short = list(_section(Section("a", "Input data", "Of the design.", (("M", pairs(material)),))))
    long = list(_section(Section("b", "More", "", (("Long", pairs(material * 8)),))))
    for above in range(0, 750, 10):
        found = sheets([Block(float(above), lambda *_: None), *short, *long])
        page_of = {id(block): number for number, sheet in enumerate(found) for block in sheet}
        assert len({page_of[id(block)] for block in short[1:]}) == 1, "the title is the second block"
        assert len({page_of[id(block)] for block in long[-3:]}) == 1
        assert len({page_of[id(block)] for block in long}) >= 2


_PAIRS = pairs([(f"quantity {n}", f"{n} MPa") for n in range(14)])
_TALL = ResultTable(
    {"effect": 0, "why": 0}, tuple({"effect": f"{n}", "why": " ".join([_LONG] * 12)} for n in range(20))
)
_WIDE = picture("a", "alt", lambda axes: axes.plot([0, 1]))
_TITLE = "Title of a section"


@pytest.mark.parametrize(
    "section",
    [
        Section("a", _TITLE, "", (("Caption", _PAIRS), ("Caption", _PAIRS))),
        Section("a", _TITLE, "Words. " * 60, (("Caption", _PAIRS),)),
        Section("a", " ".join([_TITLE] * 6), "", (("Caption", _PAIRS),)),
        Section("a", _TITLE, "", (("Caption", _TALL), ("Caption", _TALL))),
        Section("a", _TITLE, "", (), (_WIDE,)),
        Section("a", _TITLE, "A line.", (), (_WIDE,)),
    ],
    ids=["tables", "text and table", "long title", "tall rows", "picture", "text and picture"],
)
def test_no_heading_stands_alone_at_the_foot_of_a_page(section: Section) -> None:
    """Wherever on a page it begins: below a title, a caption or a head of a table something else stands.

    "Dimensions by the rule" was the last line of a page, its table of 238 points on the next.
    """
    own = list(_section(section))
    heads = {id(block.draw) for block in own if block.head is None and in_bold(block)}
    gaps = {id(block.draw) for block in own if block.height <= 14 and not drawn(block)}
    assert heads
    for above in range(0, 750, 7):
        for sheet in sheets([Block(float(above), lambda *_: None), *own]):
            told = [id(block.draw) for block in sheet if id(block.draw) not in gaps]
            assert not told or told[-1] not in heads, above


def in_bold(block: Block) -> bool:
    """Tell whether a block is a line of a title or a caption, or the head of a table."""
    figure = Figure()
    block.draw(figure, HEIGHT)
    return any(text.get_weight() == "bold" for text in figure.texts)


def test_pairs_have_no_head_and_plots_stand_side_by_side(tmp_path: Path) -> None:
    plots = tuple(picture(name, "alt", lambda axes: axes.plot([0, 1])) for name in "abc")
    facts = (Fact("Q", "1.1", "at least 1.15", "bad"), Fact("Mesh", "kept", "", "good"))
    page = Page(
        "T", "t", "h", facts, (Section("a", "A", "by `it`", (("P", pairs([("mass", "1 kg")])),), plots),)
    )
    made = list(blocks(page))
    texts = [text for block in made[:-2] for _, _, text in drawn(block)]
    assert "what" not in texts
    assert "by it" in texts
    assert "Mesh: kept" in texts
    assert made[-1].height < 0.6 * ROOM
    path = tmp_path / "page.pdf"
    write_pdf(page, path, "D-1")
    assert path.read_bytes().startswith(b"%PDF")


def test_a_drawing_is_turned_and_as_large_as_a_page() -> None:
    """An A3 sheet: 0.7 of its size on A4, where across a page it had 0.42."""
    figure = Figure(figsize=(420 / 25.4, 297 / 25.4))
    figure.text(0.0, 0.5, "left")
    sheet = Picture("drawing", figure, "a drawing", sheet=True)
    page = Page("t", "s", "h", (), (Section("a", "A", "", (), (sheet,)), Section("b", "B", "words")))
    own = next(part for part in sheets(list(blocks(page))) if any(block.height > 600 for block in part))
    (drawing,) = (block for block in own if block.height > 600)
    assert drawing.height == pytest.approx(min(HEIGHT - 2 * MARGIN, ROOM * 2**0.5), rel=1e-2)
    paper = Figure(figsize=(595 / 72, 842 / 72))
    drawing.draw(paper, HEIGHT - MARGIN)
    image = paper.axes[0].images[0].get_array()
    assert image.shape[0] / image.shape[1] == pytest.approx(2**0.5, rel=1e-2)
    dark = image[..., :3].sum(axis=2) < 1.0
    assert dark[-image.shape[0] // 4 :].any(), "what is left on the sheet is at the foot of the page"
    assert not dark[: image.shape[0] // 2].any()
