"""Sentences in lines of 80 letters: what stays whole, and the way back."""

from __future__ import annotations

import pytest

from cranktopo.base import line_width
from cranktopo.base.line_width import WIDTH, in_width, unfolded

FILL = "these are words that go on for so long that nearly all of the first line is "


@pytest.mark.parametrize(
    "whole",
    [
        "12.3 kN m/rad",
        "-0.5 %",
        "'my folder/of runs'",
        "`cranktopo runs list`",
        "cranktopo report --stress",
        "web.thickness_mm = 20.5",
        'design.name = "two words"',
    ],
)
def test_what_belongs_together_stays_together(whole: str) -> None:
    """At every place of the end of the line."""
    for start in range(60, len(FILL)):
        text = f"{FILL[:start].rstrip()} {whole}, and more than that for the rest of the second line"
        folded = in_width(text)
        assert whole in folded
        assert max(map(len, folded.splitlines())) <= WIDTH
        assert unfolded(folded) == [text]


def test_what_is_copied_stays_one_line() -> None:
    command = "cranktopo shape --resume '/a folder/" + "deep/" * 20 + "run'"
    assert in_width(f"not finished; continue with: {command}") == f"not finished; continue with:\n  {command}"
    assert in_width(command) == command
    path = "/a folder/" + "deep/" * 20 + "the page.html"
    assert in_width(f"report: {path}", [path]) == f"report:\n  {path}"


def test_what_a_line_cannot_hold_stays_as_it_is() -> None:
    row = "main 1  " + "  ".join(f"{number}.0" for number in range(30))
    word = "x" * 100
    assert in_width(f"{row}\n{word}\n\nshort\n") == f"{row}\n{word}\n\nshort\n"


def test_the_way_back_keeps_lines_of_their_own() -> None:
    """A part of the work tells its lines indented, as what goes on is."""
    long = f"{FILL}not enough for this"
    lines = [long, "  part: begins", f"  part: {long}", "next", "", long, "    deeper"]
    folded = in_width("\n".join(lines))
    assert max(map(len, folded.splitlines())) <= WIDTH
    assert unfolded(folded) == lines


def test_the_way_back_of_many_short_lines_folds_none(monkeypatch: pytest.MonkeyPatch) -> None:
    """The server of the bench reads 256 kB of a job's notes so, while a drag waits: 0.3 s by folding each."""

    def folds(*_: object) -> str:
        raise AssertionError("a line beside another is no rest of it")

    lines = [f"    solving, 72,588 unknowns: step {number} of elements of 4.2 mm" for number in range(100)]
    monkeypatch.setattr(line_width, "in_width", folds)
    assert unfolded("\n".join(lines)) == lines
