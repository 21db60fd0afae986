"""Commands on a throw with two different webs, as a user runs them."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from cranktopo.accuracy.level import EVALUATION, FILLET_STRESS
from cranktopo.accuracy.study import planned_studies, run_studies
from cranktopo.cli.main import main
from cranktopo.evaluate.targets import Target, resolve_targets
from cranktopo.pipeline import compare
from cranktopo.report.tables.fatigue_tables import FatigueComparison
from cranktopo.scene.loading import designs_folder

MIKRON = (designs_folder() / "mikron-iiic.toml").read_text(encoding="utf-8")
SECOND = """
[second_web]
thickness_mm = 25.0
outline = "tapered"
main_radius_mm = 30.0
pin_radius_mm = 26.0
"""
COARSE = ("--element-size-mm", "24", "--quiet")


@pytest.fixture
def two(tmp_path: Path) -> str:
    path = tmp_path / "two.toml"
    path.write_text(MIKRON.replace('name = "mikron-iiic"', 'name = "two"', 1) + SECOND, encoding="utf-8")
    return str(path)


def printed(capsys: pytest.CaptureFixture[str], *command: str) -> str:
    assert main(list(command)) == 0
    return capsys.readouterr().out


def test_the_table_has_the_mass_of_both_webs(two: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Those of `loads`, in closed form; a throw with equal webs beside it has a dash."""
    balance = json.loads(printed(capsys, "loads", two, "--json"))["balance"]
    lines = printed(capsys, "evaluate", two, "mikron-iiic", *COARSE).splitlines()
    assert re.split(r"  +", lines[0])[:4] == ["target", "throw", "web", "second web"]
    masses = [f"{balance[f'{which}web_mass_kg']:.3f}" for which in ("", "second_")]
    assert re.split(r"  +", lines[3])[2:4] == masses
    assert re.split(r"  +", lines[4])[3] == "-"


def test_compare_says_in_the_row_what_it_cannot_tell(
    two: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The rule tells the safety of half a throw: here of the baseline alone, by a stand-in for its solves."""

    class Assessed:
        def compared(self) -> FatigueComparison:
            return FatigueComparison((1.5,), (), {"fatigue": []})

    judged: list[str] = []

    def assess(targets: list[Target], *_: object, **__: object) -> Assessed:
        judged.extend(target.name for target in targets)
        return Assessed()

    monkeypatch.setattr(compare, "assess_fatigue", assess)
    options = ("--baseline", "mikron-iiic", "--element-size-mm", "24", "--fatigue", "m53")
    assert main(["compare", two, *options]) == 0
    out, err = capsys.readouterr()
    assert judged == ["mikron-iiic"]
    assert "two: no fatigue safety by m53: second_web makes the halves of its throw differ" in err
    rows = [re.split(r"  +", line) for line in out.splitlines() if line.startswith(("two", "mikron"))]
    assert [(row[0], row[-1]) for row in rows] == [
        ("mikron-iiic", "1.500*"),
        ("two", "-"),
        ("mikron-iiic", "100.0*"),
        ("two", "-"),
    ]


def test_the_page_of_a_comparison_shows_both_webs(two: str) -> None:
    """Each half throw in its own frame, both looked at for undercuts."""
    target = resolve_targets([two], whole=True)[0]
    shown = compare.half_throws(target)
    assert [half.name for half in shown] == ["two, first web", "two, second web"]
    assert [half.scene.web.thickness_mm for half in shown] == [19.0, 25.0]
    assert [half.scene.pitch_mm for half in shown] == [114.0, 126.0]


def test_accuracy_tells_what_it_leaves_out(two: str) -> None:
    """Without time no level is solved."""
    target = resolve_targets([two], whole=True)[0]
    assert list(planned_studies(target)) == [EVALUATION, FILLET_STRESS]
    (said,) = run_studies(target, 0.0).failures
    assert said == "optimiser: models half of a throw, and second_web makes its halves differ"


def test_balance_of_two_webs(two: str, capsys: pytest.CaptureFixture[str]) -> None:
    """The heavier web needs more; the couples balance each other, the pistons are 3 mm off the middle."""
    data = json.loads(printed(capsys, "balance", two, "--json", "--quiet"))
    first, second = data["counterweights"][:2]
    assert second["web_kg_mm"] > 1.2 * first["web_kg_mm"]
    assert second["unbalance_kg_mm"] > 1.1 * first["unbalance_kg_mm"]
    for entry in data["orders"]:
        assert entry["moment_Nm"] == pytest.approx(3e-3 * entry["force_N"], rel=1e-9)
    page = printed(capsys, "balance", two, "--quiet")
    assert re.search(r"^web +throw +web +has +for its throw", page, re.MULTILINE)


@pytest.mark.slow
def test_vibration_takes_the_closed_form_of_both_halves(two: str, capsys: pytest.CaptureFixture[str]) -> None:
    """With a stiffness given no elements are needed; the softer half is not that at the flywheel; 20 s."""
    path = Path(two)
    given = "\n[shaft]\nthrow_stiffness_Nm_per_rad = 1.5e5\n[shaft.flywheel]\ninertia_kg_m2 = 0.5\n"
    path.write_text(path.read_text(encoding="utf-8") + given, encoding="utf-8")
    data = json.loads(printed(capsys, "vibration", two, "--json", "--quiet"))
    assert data["stiffness_source"] == "shaft.throw_stiffness_Nm_per_rad"
    *inner, last = (section["stiffness_Nm_per_rad"] for section in data["sections"])
    assert inner == pytest.approx([1.5e5] * 3, rel=1e-12)
    assert last > 1.01 * 3e5


@pytest.mark.parametrize("command", ["optimise", "bound", "shape", "iterate"])
def test_optimisers_ask_which_web(command: str, two: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([command, two]) == 3
    err = capsys.readouterr().err
    assert "second_web: the halves of the throw differ, and one web is optimised at a time. " in err
    assert "--web first or --web second" in err


def test_pair_writes_a_design(two: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "pair.toml"
    assert main(["designs", "pair", two, str(file)]) == 2
    assert "give --first, --second or both" in capsys.readouterr().err
    out = printed(capsys, "designs", "pair", two, str(file), "--second", "mikron-iiic")
    assert out == f"{file}: cranktopo evaluate {file}\n"
    assert "whole_throw" not in printed(capsys, "plan", str(file))
