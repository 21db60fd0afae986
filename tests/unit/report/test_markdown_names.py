"""Whatever a design is called, a Markdown report shows its name as it is; judged by a CommonMark parser."""

from __future__ import annotations

import random

import pytest
from markdown_it import MarkdownIt
from markdown_it.token import Token

from cranktopo.report.page import Fact, Page, Section
from cranktopo.report.report_file import markdown_text
from cranktopo.report.result_table import ResultTable, markdown

NAMES = [
    "a|b",
    "my_web_two",
    "*bold*",
    "**",
    "`code`",
    "<b>x</b>",
    "[a](b)",
    "a\\|b\\",
    "~~gone~~",
    "&lt;",
    "# one",
    "- one",
    "1. one",
    "+ x",
    "two\nlines",
    "$x$",
]
LETTERS = "ab 1|_*`<>[]()\\~&;#-+.!$:="


def drawn(seed: int) -> list[str]:
    """Names of random signs; a space at either end is no part of a name."""
    draw = random.Random(seed)
    words = ("".join(draw.choices(LETTERS, k=draw.randint(1, 9))) for _ in range(60))
    return [" ".join(word.split()) or "x" for word in words]


def shown(text: str) -> list[str]:
    """What a reader sees of every heading, paragraph, list entry and cell, in order."""
    parser = MarkdownIt("commonmark").enable("table")
    return [_words(token) for token in parser.parse(text) if token.type == "inline"]


def _words(inline: Token) -> str:
    kinds = {"text", "text_special", "strong_open", "strong_close"}
    assert {child.type for child in inline.children or ()} <= kinds, inline.content
    return "".join(child.content for child in inline.children or ())


@pytest.mark.parametrize("names", [NAMES, *map(drawn, range(5))])
def test_names_in_a_table(names: list[str]) -> None:
    rows = tuple({"design": name, "mass_kg": 1.0, "from": name} for name in names)
    table = ResultTable({"design": 0, "mass_kg": 1, "from": 0}, rows, frozenset({(0, "mass_kg")}))
    found = shown(markdown(table))
    lines = [" ".join(name.split()) for name in names]
    assert found[:6] == ["design", "mass kg", "from", lines[0], "1.0*", lines[0]]
    assert found[6:] == [cell for line in lines[1:] for cell in (line, "1.0", line)]


@pytest.mark.parametrize("name", [*NAMES, *drawn(9)])
def test_a_name_everywhere_on_a_page(name: str) -> None:
    table = ResultTable({"what": 0}, ({"what": name},))
    sections = (Section("one", name, name, ((name, table),)),)
    page = Page(name, name, f"{name} is lighter", (Fact(name, name, name, "good"),), sections)
    line = " ".join(name.split())
    assert shown(markdown_text(page, "pictures")) == [
        *(line, line, f"{line} is lighter", f"{line}: {line} ({line})"),
        *(line, line, f"{line}:", "what", line),
    ]
