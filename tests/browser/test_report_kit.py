"""The kit of all report pages in a browser, on a page by hand: phones, plots, what stays on one line."""

from __future__ import annotations

import re
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

import pytest
from matplotlib.figure import Figure
from PIL import Image

from cranktopo.report.drafting import INK, THIN
from cranktopo.report.page import Fact, Page, Section, pairs
from cranktopo.report.plot import Picture, picture
from cranktopo.report.report_file import html
from cranktopo.report.result_table import ResultTable, Row

PHONE = {"viewport": {"width": 390, "height": 844}, "is_mobile": True}
_WHY = "the largest radial force of the cycle on the web of this throw"
# Of each row of a table its name and the text right of it that can be seen, px.
ROOM = """(table) => {
    const own = table.closest(".scroll").getBoundingClientRect();
    return [...table.querySelectorAll("tbody tr")].map((row) => {
        const name = row.querySelector("th").getBoundingClientRect();
        return [name.width, own.right - name.right];
    });
}"""
LINES = """(cell) => {
    const range = document.createRange();
    range.selectNodeContents(cell);
    return new Set([...range.getClientRects()].map((r) => Math.round(r.top))).size;
}"""


def numbers(count: int) -> ResultTable:
    columns = {"bearing": 0, **{f"counterweighted_{name}_N": 0 for name in ("max", "mean", "least")}}
    rows: tuple[Row, ...] = tuple(
        {name: str(n) if name == "bearing" else 148_539.0 for name in columns} for n in range(1, count + 1)
    )
    return ResultTable(columns, rows)


def wide_table() -> ResultTable:
    """What a comparison has by two methods of fatigue."""
    names = ("torsion_kNm_per_rad", "bending_kN_per_mm", "torsion_error_percent", "bending_error_percent")
    names += ("torsion_per_mass_kNm_per_rad_kg", "bending_per_mass_kN_per_mm_kg", "inertia_kg_mm2")
    columns = {"target": 0, "mass_kg": 3, **dict.fromkeys(names, 2), "unbalance_kg_mm": 2, "safety lsa": 3}
    return ResultTable(columns, ({**dict.fromkeys(columns, 1357.1), "target": "my-diesel-shape"},) * 3)


def outlets() -> ResultTable:
    """Rows of the dossier of a rule for an outlet."""
    numbers = {"angle_deg": 0, "gamma_B": 3, "gamma_T": 3, "gamma_B_FE": 3, "gamma_T_FE": 3, "bending_MPa": 1}
    numbers |= {"torsion_MPa": 1, "equivalent_MPa": 1, "strength_MPa": 1, "Q": 3, "Q_FE": 3}
    words = {"outlet": "throw.drilling[0]", "governed_by": "elements"}
    words["not_valid"] = "leans 34 deg (valid for a radial bore)"
    values = {name: 2.763 if digits == 3 else 189.3 for name, digits in numbers.items()}
    row: Row = {**words, **values}
    return ResultTable({"outlet": 0, **numbers, "governed_by": 0, "not_valid": 0}, (row,))


def _curves(axes: Any) -> None:
    for number in range(10):
        axes.plot([0, 1], [number, 0])


def by_hand() -> Page:
    keys = ({"assumption": "engine.gas.polytropic_compression", "value": "1.32", "agreed_by": "." * 24},)
    reasons = ({"effect": "bending", "state": "on", "size_percent": 18.3, "because": _WHY},)
    tables = (
        ("Few", numbers(3)),
        ("Many", numbers(12)),
        ("Wide", wide_table()),
        ("Outlets", outlets()),
        ("Keys", ResultTable({"assumption": 0, "value": 0, "agreed_by": 0}, keys)),
        ("Reasons", ResultTable({"effect": 0, "state": 0, "size_percent": 1, "because": 0}, reasons)),
        ("Pairs", pairs([("mass", "1 kg")])),
    )
    drawing = Figure(figsize=(16, 9))
    drawing.text(0.5, 0.5, "60.0", fontsize=8)
    drawing.text(0.5, 0.1, "Material", fontsize=8, color=INK)
    drawing.text(0.1, 0.1, "Front", fontsize=8, color=THIN)
    plots = (
        Picture("drawing", drawing, "a wide drawing"),
        picture("plot", "a plot", _curves),
    )
    headline = (
        "The torque of the crankshaft swings most between throw 2 and throw 3: +-377.5 N m of order 0.5."
    )
    facts = (Fact("Mass", "1 kg", "", "good"), Fact("Safety", "0.9", "below 1", "bad"))
    return Page("By hand", "a page", headline, facts, (Section("a", "A section", "", tables, plots),))


@pytest.fixture
def opened(browser: Any, tmp_path: Path) -> Iterator[Any]:
    path, contexts = tmp_path / "page.html", []
    path.write_text(html(by_hand()), encoding="utf-8")

    def visit(**window: Any) -> Any:
        contexts.append(browser.new_context(**window))
        page = contexts[-1].new_page()
        page.goto(path.as_uri())
        return page

    yield visit
    for context in contexts:
        context.close()


def table(page: Any, caption: str) -> Any:
    return page.locator(f'[aria-label="{caption}"] table')


def test_many_rows_stay_rows_on_a_phone(opened: Any) -> None:
    """A block for each of few rows; many are scrolled sideways below their heads."""
    page = opened(**PHONE)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert table(page, "Few").locator("thead").bounding_box()["x"] < -100
    assert table(page, "Many").locator("thead").bounding_box()["x"] > 0
    assert table(page, "Many").locator("tbody tr").nth(11).bounding_box()["height"] < 60


def test_names_of_rows_leave_room_and_are_whole(opened: Any) -> None:
    page = opened(**PHONE)
    for caption in ("Many", "Keys"):
        for name, room in table(page, caption).evaluate(ROOM):
            assert room > max(120, 0.8 * name), caption
    assert all(table(page, "Many").locator("tbody th").nth(n).evaluate(LINES) == 1 for n in range(12))


def test_words_of_a_stacked_row_are_read_from_the_left(opened: Any) -> None:
    page = opened(**PHONE)
    words = table(page, "Reasons").locator("td.prose")
    assert words.evaluate("cell => getComputedStyle(cell).textAlign") == "left"
    assert words.bounding_box()["width"] > 280


def test_a_wide_drawing_is_scrolled_on_a_phone(opened: Any) -> None:
    page = opened(**PHONE)
    text = page.locator("figure.wide svg text").first.bounding_box()
    assert text["height"] > 5
    assert page.locator("figure.wide").evaluate("f => f.scrollWidth > f.clientWidth")


def test_a_number_stays_with_its_unit(opened: Any) -> None:
    """However wide the window is."""
    page = opened()
    for width in range(320, 700, 40):
        page.set_viewport_size({"width": width, "height": 800})
        found = page.locator(".headline").evaluate(
            """(line) => {
                const node = line.firstChild, range = document.createRange();
                const at = node.data.indexOf("±377.5");
                range.setStart(node, at);
                range.setEnd(node, at + "±377.5 N m".length);
                return range.getClientRects().length;
            }"""
        )
        assert found == 1, width


def test_pairs_need_no_head_and_bad_news_comes_first(opened: Any) -> None:
    page = opened()
    assert table(page, "Pairs").locator("thead").bounding_box()["x"] < -100
    assert page.locator(".facts dt").all_inner_texts() == ["Safety", "Mass"]


def test_a_table_of_many_columns_fits_on_paper(opened: Any) -> None:
    """As that of a comparison by two methods of fatigue; a wider one would shrink the whole page."""
    page = opened(viewport={"width": 688, "height": 1017})
    page.emulate_media(media="print")
    assert table(page, "Wide").bounding_box()["width"] <= 688


def test_a_table_of_many_columns_fits_a_window_and_a_shadow_tells_of_more(opened: Any) -> None:
    """In 1200 px the last of 14 columns is whole; in 800 px the edge that hides some is dark."""
    for width, whole in ((1200, True), (800, False)):
        scroll = opened(viewport={"width": width, "height": 900}).locator('[aria-label="Outlets"]')
        assert scroll.evaluate("e => e.scrollWidth <= e.clientWidth") == whole
        picture = Image.open(BytesIO(scroll.screenshot())).convert("L")
        edges = [picture.getpixel((x, picture.height - 4)) for x in (1, picture.width - 2)]
        assert [edge > 245 for edge in edges] == [True, whole]


def test_a_long_name_does_not_widen_a_phone(browser: Any, tmp_path: Path) -> None:
    page = browser.new_context(**PHONE).new_page()
    long = f"Crank from /{'a' * 60}/crank.step"
    (tmp_path / "long.html").write_text(html(Page(long, long, long, (), ())), encoding="utf-8")
    page.goto((tmp_path / "long.html").as_uri())
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    page.context.close()


def test_paper_keeps_a_text_with_its_table(opened: Any) -> None:
    page = opened()
    page.emulate_media(media="print")
    assert page.evaluate("getComputedStyle(document.querySelector('section > p')).breakAfter") == "avoid"
    background = (
        table(page, "Many").locator("tbody th").first.evaluate("t => getComputedStyle(t).backgroundColor")
    )
    assert background == "rgba(0, 0, 0, 0)", "it would cover the rules of the rows"


# Of each stroke and text of the plots its colour, and that of the panel that they stand on.
COLOURS = """() => {
    const shown = [...document.querySelectorAll("figure svg g path, figure svg text")];
    const told = shown.map((one) => getComputedStyle(one)).map((s, i) =>
        shown[i].tagName === "text" ? s.fill : s.stroke);
    const panel = getComputedStyle(document.querySelector("main > section")).backgroundColor;
    return [[...new Set(told.filter((colour) => colour.startsWith("rgb(")))], panel];
}"""


def luminance(colour: str) -> float:
    """Relative luminance (WCAG 2.2)."""
    shares = [int(part) / 255 for part in re.findall(r"\d+", colour)[:3]]
    red, green, blue = (s / 12.92 if s <= 0.04045 else ((s + 0.055) / 1.055) ** 2.4 for s in shares)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def contrast(one: str, other: str) -> float:
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("window", [{}, {"color_scheme": "dark"}], ids=["light", "dark"])
def test_every_curve_and_text_is_seen_on_its_ground(opened: Any, window: dict[str, Any]) -> None:
    """At least 3 : 1, as WCAG 2.2 asks of graphics."""
    colours, panel = opened(**window).evaluate(COLOURS)
    assert len(colours) > 10
    faint = {colour: contrast(colour, panel) for colour in colours if contrast(colour, panel) < 3}
    assert not faint


def test_dark_pages_are_printed_in_the_colours_of_light_ones(opened: Any) -> None:
    page = opened(color_scheme="dark")
    page.emulate_media(media="print", color_scheme="dark")
    colours, panel = page.evaluate(COLOURS)
    assert luminance(panel) == 1.0
    assert min(contrast(colour, panel) for colour in colours) > 3
