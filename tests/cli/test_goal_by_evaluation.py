"""A comparison tells the limits of a design's goal by the evaluation, which has the last word."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest

from cranktopo.app.main import main
from cranktopo.design.loading import load_scene, resolve_design
from cranktopo.engine.states import load_cases
from cranktopo.tasks.throw_fea import stage as evaluating
from cranktopo.tasks.throw_fea.evaluation import Evaluation
from cranktopo.tasks.throw_fea.throw_stiffness import Stiffness

GOAL = """
[goal]
minimise = "mass"
[goal.limits]
bending = ">= 90 %"
unbalance = "<= 40 kg mm"
twist = "<= 0.5 deg"
pin_displacement = "<= 110 %"
"""


def invented(target: Any, *_: object) -> Evaluation:
    light = target.name == "light"
    fine = Stiffness(
        {"free": 80e3 if light else 100e3}, {"pinned": 68e3 if light else 70e3}, 1234, 4.0, 1.0, 2.0
    )
    return Evaluation(
        target.name, 1.5 if light else 2.0, 0.6, 5000, 50, fine, "free", "pinned", 0.3, 0.4, 3.0
    )


@pytest.fixture
def design(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.setattr(evaluating, "evaluate", invented)
    text = resolve_design("mikron-iiic-plain").read_text(encoding="utf-8")
    path = tmp_path / "light.toml"
    path.write_text(text.replace('name = "mikron-iiic-plain"', 'name = "light"') + GOAL, encoding="utf-8")
    return str(path)


def test_limits_are_told_by_the_evaluation(design: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["compare", design, "--baseline", "mikron-iiic-plain", "--json"]) == 0
    goal = json.loads(capsys.readouterr().out)["goals"]["light"]
    assert (goal["minimise"], goal["reached"], goal["reached_percent"]) == ("mass", 1.5, 75.0)
    limits = {limit["quantity"]: limit for limit in goal["limits"]}
    assert {name: limit["holds"] for name, limit in limits.items()} == {
        "bending": True,
        "unbalance": False,
        "twist": True,
        "pin_displacement": True,
        "torsion": False,
        "fatigue_safety": None,
    }
    bending, torsion = load_cases(load_scene("mikron-iiic-plain"))
    assert limits["twist"]["reached"] == pytest.approx(math.degrees(torsion.torque_Nm / 80e3))
    assert limits["pin_displacement"]["required"] == pytest.approx(1.1 * bending.radial_N / 70e3)


def test_the_table_says_which_limit_breaks(design: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["compare", design, "--baseline", "mikron-iiic-plain"]) == 0
    out = capsys.readouterr().out
    assert "light: least mass: 1.5 kg, 75.0 % of mikron-iiic-plain" in out
    (line,) = (line for line in out.splitlines() if line.startswith("torsion >="))
    assert line.split()[-3:] == ["100.0", "80.0", "NO"]


@pytest.mark.slow
def test_the_page_says_it_too(design: str, tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    assert (
        main(["compare", design, "--baseline", "mikron-iiic-plain", "--report", str(page), "--no-bound"]) == 0
    )
    assert "light: least mass: 1.5 kg, 75.0 % of mikron-iiic-plain" in page.read_text(encoding="utf-8")


def test_the_baseline_has_nothing_to_reach(design: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["compare", "mikron-iiic-plain", "--baseline", design, "--json"]) == 0
    assert "goals" not in json.loads(capsys.readouterr().out)
