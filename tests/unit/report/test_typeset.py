"""Text as a page sets it: signs, and no line that ends between a number and its unit."""

from __future__ import annotations

import pytest

from cranktopo.design.assumed import Assumption
from cranktopo.report.page import (
    Fact,
    Page,
    Section,
    assumed_words,
    clock_words,
    counted,
    pairs,
    quantity_words,
)
from cranktopo.report.report_file import html, markdown_text
from cranktopo.report.result_table import ResultTable
from cranktopo.report.typeset import typeset


@pytest.mark.parametrize(
    ("text", "set_as"),
    [
        ("+-377.5 N m, +-0.5 %", "±377.5_N_m, ±0.5_%"),
        ("545,049 kg mm2 and 3 mm3", "545,049_kg_mm² and 3_mm³"),
        ("0.34 um at 20 kN m/rad/kg", "0.34_µm at 20_kN_m/rad/kg"),
        ("residual 4.8e-09, load 6.844e+04.", "residual 4.8·10⁻⁹, load 6.844·10⁴."),
        ("1e-06", "10⁻⁶"),
        ("torsion >= 100 % of it", "torsion ≥ 100_% of it"),
        ("50 -> 26 % at x = 0, y = -199.9 mm", "50 → 26_% at x_=_0, y_=_-199.9_mm"),
        ("runs/1e-05/page, 9f7e28, web_2mm3, 5 minutes, x-2", None),
    ],
)
def test_signs_and_units(text: str, set_as: str | None) -> None:
    assert typeset(text) == (text if set_as is None else set_as.replace("_", "\u00a0"))


def test_a_page_is_typeset_and_shows_commands_as_code() -> None:
    table = ResultTable({"name": 0, "volume_mm3": 0}, ({"name": "worst +-2 um", "volume_mm3": 2.0},))
    section = Section("a", "A", "Written by `make <it>` in 3 s.", (("Area of 3 mm2", table),))
    text = html(Page("T", "t", "+-2 %.", (Fact("Mass", "1 kg", "+-0.1 kg", "good"),), (section,)))
    body = text[text.index("<body>") :]
    assert "+-" not in body
    assert "<code>make &lt;it&gt;</code> in 3\u00a0s." in body
    assert "<small>mm³</small>" in body
    assert "Area of 3\u00a0mm²" in body


def test_a_key_of_a_scene_breaks_behind_its_parts() -> None:
    rows = [("throw.main_journal.fillet_mm", "2.5 mm"), ("a name. Another_one", "1")]
    text = html(Page("T", "t", "h", (), (Section("a", "A", "", (("Keys", pairs(rows)),)),)))
    assert ">throw.<wbr>main_<wbr>journal.<wbr>fillet_<wbr>mm</th>" in text
    assert ">a name. Another_one</th>" in text


def test_what_follows_a_text_is_a_paragraph_of_its_own() -> None:
    page = Page("T", "t", "h", (), (Section("a", "A", "One.", more=("", "Two, by --limit x.")),))
    assert '<p>One.</p><p>Two, by <span class="word">--limit</span> x.</p>' in html(page)
    assert "\n\nOne.\n\nTwo, by " in markdown_text(page, "p")


def test_names_of_rows_break_in_front_of_a_unit_and_short_ones_nowhere() -> None:
    short = pairs([("webs 1 and 8", "39.999471"), ("half_width_1", "2")])
    tables = (("Short", short), ("Long", pairs([("torsion >= 748,652 N m/rad", "1")])))
    text = html(Page("T", "t", "h", (), (Section("a", "A", "", tables),)))
    assert '<th scope="row" class="word">webs 1 and 8</th>' in text
    assert 'class="text word">39.999471</td>' in text
    assert ">half_width_1</th>" in text
    assert "748,652 N\u00a0m/rad</th>" in text


def test_what_is_bad_is_said_first() -> None:
    facts = tuple(Fact(name, "1", "", status) for name, status in (("a", "good"), ("b", "bad"), ("c", "bad")))
    page = Page("T", "t", "h", facts, ())
    assert [fact.label for fact in page.verdict] == ["b", "c", "a"]
    for text in (html(page), markdown_text(page, "p")):
        places = [
            text.index(f"{mark}{name}")
            for mark in ("<dt>", "- ")
            for name in "bca"
            if f"{mark}{name}" in text
        ]
        assert places == sorted(places)


def test_assumed_numbers_have_units() -> None:
    assert assumed_words(Assumption("engine.gas.burn_duration_deg", 60.0, "")) == "60 deg"
    assert assumed_words(Assumption("bearings.width_mm", 22, "(of it)")) == "22 mm (of it)"
    assert assumed_words(Assumption("web.outline", "obround", "")) == "obround"
    assert quantity_words("inertia_kg_m2", 0.1) == "inertia 0.1 kg m²"


def test_a_time_and_a_number_of_things_read_as_one() -> None:
    assert (counted(1, "throw"), counted(4, "throw")) == ("1 throw", "4 throws")
    assert clock_words("2026-11-26T09:08:04+00:00") == "2026-11-26, 09:08 UTC"
    assert clock_words("2026-11-26T09:08:04+02:00") == "2026-11-26, 09:08 UTC+02:00"
    assert clock_words("2026-11-26") == "2026-11-26"
