"""Every command that computes with the cylinder pressure says before its work where that cannot be."""

from __future__ import annotations

from pathlib import Path
from unittest.mock import patch

import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import designs_folder, load_scene
from cranktopo.engine.performance import pressure_warnings
from tests.hostile.outcome import stubbed

UNCHARGED = "[engine.gas]\npeak_pressure_MPa = 20.0\npeak_angle_deg = 12.0\ncompression_ratio = 15.0\n"
"""A medium-speed engine of 200 bar without a word of its charge: a mean of 3.6 MPa from ambient pressure."""
TOLD = "no engine has more than 20 times: give engine.gas.intake_pressure_MPa of a charged engine"
COMMANDS = (
    ["plan"],
    ["film"],
    ["vibration"],
    ["shaft"],
    ["shaft", "--method", "lsa"],
    ["fatigue"],
    ["shape"],
    pytest.param(["optimise", "--resolution-mm", "15"], marks=pytest.mark.slow),
)


@pytest.fixture(scope="module")
def uncharged(tmp_path_factory):
    text = (designs_folder() / "industrial-gas.toml").read_text()
    start, end = text.index("[engine.gas]"), text.index("[engine.masses]")
    path = tmp_path_factory.mktemp("designs") / "uncharged.toml"
    path.write_text(text[:start] + UNCHARGED + text[end:], encoding="utf-8")
    return str(path)


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_a_pressure_that_cannot_be_is_told_before_the_work(
    words: list[str], uncharged, capsys, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    with (
        stubbed(),
        patch("cranktopo.tasks.film.stage.orbits_of", side_effect=CranktopoError("no work here.")),
    ):
        main([words[0], uncharged, *words[1:]])
    assert capsys.readouterr().err.count(TOLD) == 1


@pytest.mark.parametrize("path", sorted(designs_folder().glob("*.toml")), ids=lambda path: path.stem)
def test_no_built_in_design_has_such_a_pressure(path: Path):
    assert pressure_warnings(load_scene(path)) == ()


def test_a_shaft_judged_by_strength_says_what_the_strength_holds_for(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with stubbed():
        main(["shaft", "industrial-gas", "--method", "lsa"])
    assert "ultimate_MPa = 1100 of 42CrMo4 is that of sections to 16 mm" in capsys.readouterr().err
