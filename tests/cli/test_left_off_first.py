"""Loads that are left out above the threshold: said before anything is solved, in results, first on pages."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import NoReturn

import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError
from cranktopo.base.result import Result
from cranktopo.design.loading import load_scene
from cranktopo.design.named import with_values
from cranktopo.report.page import left_off_first
from cranktopo.tasks.compare.printed import comparison_text
from cranktopo.tasks.compare.result import Entry, compare
from cranktopo.tasks.iterate.result import ShapeOutcome
from cranktopo.tasks.optimise.result import RunMetrics
from cranktopo.tasks.shaft.stage import shaft_left_off
from cranktopo.tasks.shaft_safety.result import ShaftSafety
from cranktopo.tasks.sweep.page import sweep_html
from cranktopo.tasks.sweep.plan import sweep_plan
from cranktopo.tasks.sweep.points import left_off_lines, points_of
from cranktopo.tasks.sweep.result import SweepResult
from cranktopo.tasks.sweep.text import sweep_summary
from cranktopo.tasks.sweep.variation import read_option
from cranktopo.tasks.throw_fatigue.assessment import FatigueAssessment
from cranktopo.tasks.throw_fatigue.needs import alone_left_off, safety_left_off
from cranktopo.tasks.throw_fatigue.result import CriticalPoint, FieldFatigue
from cranktopo.tasks.throw_fatigue.text import FatigueComparison
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.web_shape.each_web.result import EachWebResult
from cranktopo.tasks.web_shape.loads_told import loads_left_off
from cranktopo.tasks.web_shape.page import page_headline
from cranktopo.tasks.web_shape.result import ShapeResult
from cranktopo.tasks.web_shape.text import shape_summary
from tests.cli.test_comparison_report import NO_FATIGUE, evaluated
from tests.unit.shape.test_least_place import shaped
from tests.unit.sweep.test_sweep_shown import sweep

LINE = "left out although above the threshold of 2 %: tangential 25.2 % (set off in the scene)"
TWIN = Path(__file__).parent.parent / "data" / "v-twin.toml"
_JUDGED = "throw_fatigue.stage.with_throw_stiffness"
ALONE = (
    ("fatigue mikron-iiic", _JUDGED),
    ("fatigue mikron-iiic --method m53", _JUDGED),
    ("compare mikron-iiic-hollow --baseline mikron-iiic --fatigue lsa", _JUDGED),
    ("shape mikron-iiic --minimise mass --out o", "web_shape.run.scene_start"),
    ("sweep mikron-iiic --vary web.thickness_mm=18,20 --stage fatigue --out o", "sweep.run.new_run"),
    ("sweep mikron-iiic --vary web.thickness_mm=18,20 --stage shape --out o", "sweep.run.new_run"),
    ("optimise mikron-iiic --resolution-mm 4.5 --out o", "optimise.stage.build_problem"),
    ("iterate mikron-iiic --resolution-mm 4.5 --out o", "iterate.loop.new_run"),
)
"""Every command that tells the safety of a throw that stands alone, or keeps one, and where it is stopped."""
IN_SHAFT = (
    ("shaft {design} --method lsa", "shaft_safety.stage.judged_shaft"),
    ("fatigue {design}", _JUDGED),
)


def stopped(*_: object, **__: object) -> NoReturn:
    raise CranktopoError("stopped before the first solve.")


@pytest.mark.parametrize(("line", "at"), ALONE)
def test_it_is_said_before_anything_is_solved(
    line: str,
    at: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(f"cranktopo.tasks.{at}", stopped)
    assert main(shlex.split(line)) != 0
    said = capsys.readouterr().err
    assert "stopped before the first solve" in said
    assert LINE.split(" 25.")[0] in said


@pytest.mark.usefixtures("every_step")
@pytest.mark.parametrize(("line", "at"), IN_SHAFT)
def test_a_vibration_that_is_off_is_said_of_the_shaft_too(
    line: str,
    at: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    design = tmp_path / "twin.toml"
    design.write_text(TWIN.read_text() + '\n[effects]\ntorsional_vibration = "off"\n')
    monkeypatch.setattr(f"cranktopo.tasks.{at}", stopped)
    assert main(shlex.split(line.format(design=design))) != 0
    assert "threshold of 2 %: torsional_vibration 8.73 % (set off in the scene)" in capsys.readouterr().err


def test_on_all_bearings_every_force_counts_whatever_the_plan_has() -> None:
    scene = load_scene("mikron-iiic")
    assert alone_left_off(scene) == safety_left_off(scene) == loads_left_off(scene, "extremes") == LINE
    assert loads_left_off(scene, None) == shaft_left_off(scene) == ""
    assert safety_left_off(with_values(scene, {"effects.continuous_shaft": "on"})) == ""


def test_fatigue_has_it_in_its_result() -> None:
    scene = load_scene("mikron-iiic")
    found = FatigueAssessment("lsa", "extremes", (), (), targets=(Target(scene.name, scene),))
    assert found._remarks(found.targets[0])["left_off"] == LINE


def told_fatigue() -> FatigueComparison:
    point = CriticalPoint.model_construct(place="pin fillet")
    entries = tuple(
        FieldFatigue.model_construct(target=name, safety=1.2, critical=point, left_off=line, judged_as=None)
        for name, line in (("a", LINE), ("b", None))
    )
    return FatigueComparison((1.2, 1.2), (), NO_FATIGUE.model_copy(update={"fatigue": entries}))


def test_compare_tells_it_above_its_tables() -> None:
    targets = [Entry(evaluated(name, 90e3, 0.1), None, 1.2) for name in ("a", "b")]
    assert comparison_text(compare(targets, "a", told_fatigue()), "table").startswith(f"a: {LINE}.\n")
    assert "left out" not in comparison_text(compare(targets, "a"), "table")


def test_shape_tells_it_below_the_verdict_and_in_front_of_the_page() -> None:
    found = shaped().model_copy(update={"left_off": LINE})
    assert shape_summary(found, Path("o")).splitlines()[1] == LINE
    assert page_headline(found).startswith(f"L{LINE[1:]}. ")


def test_sweep_tells_it_of_every_design_first() -> None:
    keys = [read_option("web.thickness_mm=18,20")]
    points = points_of(sweep_plan(["mikron-iiic", "mikron-iiic-plain"], keys, stage="fatigue"))
    lines = left_off_lines(points)
    assert [line.split(": ")[0] for line in lines] == ["mikron-iiic", "mikron-iiic-plain"]
    assert not left_off_lines(points_of(sweep_plan(["mikron-iiic"], keys)))
    found = sweep().model_copy(update={"left_off": tuple(lines)})
    assert sweep_summary(found, Path("run")).splitlines()[1:3] == lines
    page = sweep_html(found, {})
    assert page.index(f'<p class="headline">{lines[0]}.</p>') < page.index('class="pick"')


def test_what_is_left_out_is_in_front_of_a_headline() -> None:
    """As on the pages of shaft, shape --each-web, optimise and iterate."""
    assert left_off_first(LINE, "The rest.") == f"L{LINE[1:]}. The rest."
    assert left_off_first(None, "The rest.") == "The rest."


def test_every_result_has_it() -> None:
    safe: tuple[type[Result], ...] = FieldFatigue, ShaftSafety, ShapeResult, EachWebResult, SweepResult
    assert all("left_off" in one.model_fields for one in (*safe, ShapeOutcome, RunMetrics))
