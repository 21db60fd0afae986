"""Lines that commands print: within 80 columns on stdout and stderr, numbers plain.

`python -m pytest -m slow tests/cli/test_terminal_width.py` runs those that solve for long, some minutes.
"""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from cranktopo.app.main import main
from cranktopo.base.units import number_text, plain_number
from cranktopo.cli import output
from cranktopo.report.result_table import WIDTH, ResultTable, labelled, terminal, text_table
from tests.every_command import every_command

FAST = (
    "plan",
    "plan car-diesel --minimise mass",
    "loads",
    "loads industrial-gas",
    "loads --speed 1000:2800:600",
    "balance",
    "balance car-diesel",
    "bolts",
    "rod",
    "balancer",
    "designs list",
    "designs copy mikron-iiic copy.toml",
    "designs new new.toml",
    "designs sketch web web.svg",
    "designs pair mikron-iiic-plain pair.toml --first mikron-iiic-plain",
    "doctor",
    "runs list --root {runs}",
    "runs show {run}",
    "runs clean --root empty",
    "extract {run} --out web.stl",
    "export mikron-iiic-plain web.pdf",
    "evaluate mikron-iiic --element-size-mm 16",
)
"""Command lines that a few seconds suffice for; between them and `SLOW` every command is called."""
SLOW = (
    "film car-diesel",
    "film industrial-gas --speed 900:1800:300",
    "compare opposed-piston-variant-2 --baseline opposed-piston --element-size-mm 12",
    "vibration car-diesel --element-size-mm 14",
    "shaft mikron-iiic-plain --element-size-mm 14",
    "bound mikron-iiic-plain --resolution-mm 4.5",
    "optimise --minimise mass --resolution-mm 4.5 --out o",
    "fatigue mikron-iiic --baseline mikron-iiic-hollow --fillet-fraction 0.5",
    "fatigue mikron-iiic --method m53 --baseline mikron-iiic-rounded --fillet-fraction 0.5",
    "fatigue industrial-gas --method m53 --fillet-fraction 0.5",
    "accuracy mikron-iiic-plain --budget 40s --out a",
    "remodel {run} --out m --no-evaluation --cell-mm 3",
    "report {run} --out r.html",
    "shape mikron-iiic-plain --no-bound --cell-mm 3 --out s",
    "iterate mikron-iiic-plain --steps 2 --resolution-mm 4.5 --no-shape --no-bound --cell-mm 3 --out i",
    "modes mikron-iiic-plain --element-size-mm 14 --speeds 1000:2000:3",
    "sweep mikron-iiic-plain --vary web.thickness_mm=18,20 --element-size-mm 9 --out v",
    "import {step}",
    "drawing mikron-iiic-plain crank.svg",
    "completion bash",
)


_FOLDED = output._folded
"""As the program has it; taken before any fixture is made."""
_COPIED = re.compile(r"\s*cranktopo |error: ")


@pytest.fixture(autouse=True)
def folded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(output, "_folded", _FOLDED)


@pytest.mark.parametrize("line", [*FAST, *(pytest.param(line, marks=pytest.mark.slow) for line in SLOW)])
def test_lines_fit(
    line: str,
    request: pytest.FixtureRequest,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """A longer line is an error, or one command to copy, one path or another word, alone."""
    monkeypatch.chdir(tmp_path)
    if "{" in line:
        run: Path = request.getfixturevalue("default_run")
        if "{step}" in line:
            assert main(["export", "mikron-iiic-plain", "throw.step"]) == 0
        line = line.format(run=run, runs=run.parent, step="throw.step")
    capsys.readouterr()
    assert main(shlex.split(line)) in (0, 5, 6)
    shown, told = capsys.readouterr()
    assert shown
    if line.startswith("completion"):
        return
    lines = [text for text in f"{shown}\n{told}".splitlines() if len(text) > WIDTH]
    assert [text for text in lines if " " in text.strip() and not _COPIED.match(text)] == []
    odd = re.findall(r"\S*\d[eE][+-]\d+|(?<![\w.])-0(?:\.0+)?(?![\w.])", shown)
    assert not odd


def test_every_command_is_looked_at() -> None:
    called = {
        name for name in every_command() for line in (*FAST, *SLOW) if f"{line} ".startswith(f"{name} ")
    }
    assert called == set(every_command()) - {"bench"}  # it prints an address and stays


def test_numbers_have_no_exponent() -> None:
    assert (number_text(68441.0), number_text(685.71), number_text(-0.0)) == ("68,441", "685.7", "0")
    assert (plain_number(1.07e6, 6), plain_number(2.5e-7), plain_number(87_739_724.0)) == (
        "1070000",
        "0.00000025",
        "87740000",
    )
    table = ResultTable({"name": 0, "off_mm": 1}, ({"name": "a", "off_mm": -0.04},))
    assert terminal(table).splitlines()[-1] == "a     0.0"


def test_a_wide_table_repeats_its_first_column() -> None:
    names = [f"a_long_name_{number}_of_a_column_kNm_per_rad" for number in range(12)]
    table = ResultTable(
        {"target": 0, **dict.fromkeys(names, 1)},
        ({"target": "web", **dict.fromkeys(names, 1.0)}, {"target": "x" * 100, **dict.fromkeys(names, 2.0)}),
    )
    blocks = terminal(table).split("\n\n")
    assert len(blocks) > 1
    assert all("target" in block and "web" in block for block in blocks)
    assert max(map(len, terminal(table).splitlines())) <= WIDTH
    assert sum(block.count("1.0") for block in blocks) == len(names), "every value once"


def test_words_go_on_below() -> None:
    text = text_table("ll", ("effect", "because"), [("bores", "word " * 40)])
    assert max(map(len, text.splitlines())) <= WIDTH
    assert text.count("word") == 40
    assert labelled([("a", "b"), ("cc", "d")]) == "a   b\ncc  d"


def test_an_error_and_a_command_to_copy(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """An error is one line, of 300 letters here; the folder has spaces, its file is named in a sentence and
    in a command."""
    folder = tmp_path / "designs of the engine that stands in the shed beside the house"
    folder.mkdir()
    monkeypatch.chdir(folder)
    file = folder / "my own web.toml"
    assert main(["designs", "copy", "mikron-iiic", str(file)]) == 0
    command = shlex.join(["cranktopo", "compare", str(file), "--baseline", "mikron-iiic"])
    assert capsys.readouterr().out == f"{file}:\n  edit it, then for example:\n  {command}\n"
    assert main(["loads", "nothing"]) == 3
    (error,) = capsys.readouterr().err.splitlines()
    assert len(error) > 300
