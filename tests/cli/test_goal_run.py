"""A density optimisation with a goal, end to end on a coarse grid and cut short."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import pytest

from cranktopo.app.main import main
from tests.page_text import typed_page
from tests.plain_runs import plain_runs

pytestmark = pytest.mark.slow
OPTIONS = [
    *("--minimise", "mass", "--limit", "bending none", "--limit", "torsion >= 90 %"),
    *("--limit", "unbalance <= 0.05 kg m", "--resolution-mm", "4.5", "--max-iterations", "4"),
]


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("goal") / "run"
    assert main(["optimise", *OPTIONS, "--out", str(out)]) == 5
    return out


@pytest.fixture(scope="module")
def metrics(run: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((run / "metrics.json").read_text(encoding="utf-8"))
    return found


def test_metrics_hold_goal_and_limits(metrics: dict[str, Any]) -> None:
    goal, original = metrics["goal"], metrics["original_web"]
    assert goal["minimise"] == "mass"
    assert goal["reached"] == pytest.approx(metrics["mass_kg"]["throw"], rel=1e-9)
    assert goal["original"] == pytest.approx(original["mass_kg"]["throw"], rel=1e-9)
    limits = {limit["quantity"]: limit for limit in goal["limits"]}
    assert list(limits) == ["unbalance", "torsion", "fatigue_safety"]
    before, now = (web["load_cases"]["torsion"]["stiffness_Nm_per_rad"] for web in (original, metrics))
    assert limits["torsion"]["required"] == pytest.approx(0.9 * before, rel=1e-9)
    assert limits["torsion"]["reached"] == pytest.approx(now, rel=1e-9)
    assert limits["unbalance"]["required"] == 50.0
    assert (limits["fatigue_safety"]["reached"], limits["fatigue_safety"]["holds"]) == (None, None)
    assert {"key": "goal.limits.fatigue_safety", "value": ">= 100 %", "meaning": "of the original web"} in (
        metrics["assumed"]
    )


def test_only_the_load_case_that_is_needed_was_solved(metrics: dict[str, Any]) -> None:
    assert list(metrics["load_cases"]) == ["torsion"]


def test_history_follows_goal_and_limits(run: Path, metrics: dict[str, Any]) -> None:
    with open(run / "history.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert {"mass_kg", "torsion_Nm_per_rad", "unbalance_kg_mm"} <= rows[0].keys()
    assert float(rows[-1]["mass_kg"]) == pytest.approx(metrics["mass_kg"]["throw"], rel=1e-6)


def test_the_page_shows_the_limits(run: Path, metrics: dict[str, Any]) -> None:
    page = typed_page(run / "report.html")
    assert "Goal and limits" in page
    assert "unknown" in page
    assert f"{metrics['goal']['reached_percent']:.1f} % of the original web" in page


def test_the_summary_shows_the_limits(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A run that is done shows them when it is looked at again, too."""
    with plain_runs():
        assert main(["optimise", "--resume", str(run), "--max-iterations", "5"]) == 5
    out = capsys.readouterr()
    assert "least mass: " in out.out
    assert "torsion >= " in out.out
    assert "goal: least mass; unbalance <= 50 kg mm, torsion >= 90 %" in out.err
