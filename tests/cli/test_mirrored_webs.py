"""A web found as a throw that has it twice, beside the throw that it is for: the mirroring is no change."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path

import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import designs_folder, load_scene, one_web
from cranktopo.design.schema import Scene
from cranktopo.design.writing import save_scene
from cranktopo.tasks.compare.stage import compare_targets, report_comparison
from cranktopo.tasks.throw_fatigue.assessment import FatigueAssessment
from cranktopo.tasks.throw_fatigue.stage import assess_fatigue
from cranktopo.tasks.throw_fea.evaluation import Evaluation
from cranktopo.tasks.throw_fea.mirrored_webs import counted_alike, next_line
from cranktopo.tasks.throw_fea.targets import Target, resolve_targets
from cranktopo.tasks.throw_fea.throw_stiffness import Stiffness

PLAIN = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
DRILLING = """
[[throw.drilling]]
diameter_mm = 5.0
web = "first"
from = { on = "main_journal", angle_deg = 180.0, place_mm = 10.0 }
to = { on = "crankpin", angle_deg = 0.0, place_mm = 10.0 }

[web]"""
GOAL = """
[goal]
minimise = "mass"
limits = { bending = ">= 99.9 %" }
"""
LINE = "small: a throw that has its first web twice (throw.mirrored_web). So drilled counts"


def invented(target: Target, *_: object) -> Evaluation:
    """A drilling takes stiffness and mass from its half, so that only unlike drillings make a difference."""
    halves = 2 if all(one.web == "both" for one in target.scene.throw.drilling) else 1
    bending, mass_kg = 70e3 - 500 * halves, 2.0 - 0.01 * halves - 0.1 * (target.scene.name == "small")
    fine = Stiffness({"free": 100e3}, {"pinned": bending}, 1234, 4.0, 1.0, 2.0)
    return Evaluation(target.name, mass_kg, 0.6, 5000, 50, fine, "free", "pinned", 0.01, 0.01, 3.0)


@pytest.fixture
def drilled(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A throw drilled through its first web only, and beside it small.toml, its first web found lighter."""
    monkeypatch.setattr("cranktopo.tasks.throw_fea.stage.evaluate", invented)
    path = tmp_path / "drilled.toml"
    text = re.sub(r'(?m)^name = ".*?"', 'name = "drilled"', PLAIN, count=1)
    path.write_text(text.replace("\n[web]", DRILLING, 1) + GOAL, encoding="utf-8")
    found = one_web(load_scene(str(path), whole=True), "first").model_copy(update={"name": "small"})
    save_scene(found, tmp_path / "small.toml")
    return path


def test_its_changes_are_those_of_the_web(drilled: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Told first, with a command that works; the limit holds, as it does in the search."""
    small, pair = str(drilled.parent / "small.toml"), str(drilled.parent / "pair.toml")
    words = ["compare", small, "--baseline", str(drilled)]
    assert main(words) == 0
    text = capsys.readouterr().out
    assert " ".join(text.split()).startswith(LINE)
    assert "NO" not in text
    assert main([*words, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["mirrored_web"].startswith(LINE)
    assert found["baseline"] == "drilled-first-web"
    changed = next(row for row in found["percent_of_baseline"] if row["target"] == "small")
    assert changed["bending_percent"] == pytest.approx(100.0)
    assert changed["mass_percent"] == pytest.approx(100 * 1.88 / 1.98)
    command = shlex.split(found["mirrored_web"].rpartition("On its throw: ")[2])
    assert command[1:] == ["designs", "pair", str(drilled), "pair.toml", "--first", small]
    assert main([*command[1:4], pair, *command[5:]]) == 0
    capsys.readouterr()
    assert main(["compare", pair, "--baseline", str(drilled), "--json"]) == 0
    assert "mirrored_web" not in json.loads(capsys.readouterr().out)


@pytest.mark.slow
def test_its_page_says_so_first(drilled: Path, tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    report_comparison(compare_targets([str(drilled.parent / "small.toml")], str(drilled)), page)
    text = " ".join(page.read_text(encoding="utf-8").replace("\\", "").split())
    assert 0 < text.index(LINE) < text.index("Lightest"), "before the first card"


def scenes(drilled: Path) -> tuple[Scene, Scene, Scene]:
    whole = load_scene(str(drilled), whole=True)
    return whole, one_web(whole, "first"), one_web(whole, "second")


def test_only_what_is_mirrored_changes_what_stands_beside_it(drilled: Path) -> None:
    """Throws of equal halves, and any that stand beside no mirrored web, stay as they are."""
    whole, first, _ = scenes(drilled)
    alike = load_scene("mikron-iiic-plain")
    for given in ([whole, alike], [first, alike], [alike]):
        targets = resolve_targets(given, whole=True)
        assert counted_alike(given, targets) == (targets, "")
    given = [whole, first, alike]
    found, line = counted_alike(given, resolve_targets(given, whole=True))
    assert [one.scene.throw.mirrored_web for one in found] == ["first", "first", None]
    assert found[0].scene.throw == first.throw
    assert line


def test_their_fatigue_is_that_of_the_web(drilled: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Beside a baseline; without one each throw is itself."""
    seen: list[list[str]] = []

    def nothing_found(targets: list[Target], *_: object) -> list[FatigueAssessment]:
        seen.append([one.name for one in targets])
        return [FatigueAssessment("m53", "extremes", (), ())]

    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.stage.assess_by_methods", nothing_found)
    names = [str(drilled), str(drilled.parent / "small.toml")]
    assert assess_fatigue(names, "m53", baseline=0).mirrored.startswith(LINE)
    assert not assess_fatigue(names, "m53").mirrored
    assert seen == [["drilled-first-web", "small"], ["drilled", "small"]]


def test_first_and_second_webs_are_refused_together(drilled: Path) -> None:
    whole, first, second = scenes(drilled)
    with pytest.raises(CranktopoError, match=r"has its first web twice and .* has its second web twice"):
        counted_alike([whole, first, second], resolve_targets([whole, first, second], whole=True))


def test_a_run_of_one_web_names_what_puts_it_on_the_throw(drilled: Path) -> None:
    whole, _, second = scenes(drilled)
    pair = "cranktopo designs pair a.toml pair.toml --second runs/x"
    assert next_line(second, "a.toml", Path("runs/x")) == f"on the throw: {pair}"
    told = next_line(second, "a.toml", Path("runs/x"), "cranktopo", "remodel")
    assert told == f"on the throw: cranktopo remodel runs/x, then {pair}"
    assert not next_line(whole, "a.toml", Path("runs/x"))
