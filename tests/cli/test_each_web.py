"""`cranktopo shape --each-web`: the whole run, with searches and shafts that take no time; refusals."""

from __future__ import annotations

import json
import shlex
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.design.loading import design_text, load_scene
from cranktopo.design.schema import Scene
from cranktopo.runs.directories import create_run
from cranktopo.tasks.web_shape import evaluated_web
from cranktopo.tasks.web_shape import run as shape_run
from cranktopo.tasks.web_shape.each_web import rounds, run
from cranktopo.tasks.web_shape.run import resume_shape, shape_settings
from tests import shape_stand_in
from tests.page_text import typed_page
from tests.shaft_stand_in import told_shaft
from tests.shape_stand_in import ShapeStandIn

DESIGN = (1.2, 1.3, 1.6, 1.5, 1.5, 1.6, 1.3, 1.2)
"""Safety of each web with the design's web: pairs (1, 8), (2, 7), and (3, 6), (4, 5)."""
HALF = tuple(1.2 for _ in DESIGN)


@pytest.fixture
def stand_in(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ShapeStandIn:
    """Searches that end at 90 % of the mass; a crank of the design's web, of one for all, of their own."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(shape_stand_in, "export_solid", lambda *_: None)
    found = ShapeStandIn({"mass": 90.0})
    after: Iterator[Any] = iter([told_shaft(HALF, 5.6), told_shaft(HALF, 5.32)])
    monkeypatch.setattr(run, "loaded_shaft", lambda scene, fraction: told_shaft(DESIGN, 6.0))
    monkeypatch.setattr(rounds, "loaded_shaft", lambda design, fraction: next(after))
    monkeypatch.setattr(evaluated_web, "web_safety", lambda scene, judging: 2.0)
    monkeypatch.setattr(shape_run, "shape_design", found.design)
    monkeypatch.setattr(shape_run, "resume_shape", found.resume)
    return found


def test_the_whole_run(stand_in: ShapeStandIn, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["shape", "mikron-iiic", "--each-web", "--out", "out"]) == ExitCode.DONE
    said = capsys.readouterr()
    assert "With 4 different webs the crank has 5.320 kg, 5.00 % less than with one web for all" in said.out
    assert "torsion >= 100 %, bending >= 100 %; safety of 1.200 in the shaft" in said.out
    assert "webs 1 and 8; webs 2 and 7; webs 3 and 6; webs 4 and 5" in said.out
    assert "5 of 7, webs 3 and 6: safety >= 2," in said.err  # that of its throw alone, after four parts
    assert load_scene("out/own-webs/crank.toml", whole=True).name == "mikron-iiic-own-webs"
    kept = json.loads(Path("out/each-web.json").read_text(encoding="utf-8"))
    assert kept["required_safety"] == 1.2
    assert [group["webs"] for group in kept["each_web"]["groups"]] == [[1, 8], [2, 7], [3, 6], [4, 5]]
    assert [group["required"] for group in kept["each_web"]["groups"]] == [2.0] * 4
    assert main(["shape", "--resume", "out", "--json"]) == ExitCode.DONE  # nothing is done again
    again = json.loads(capsys.readouterr().out)
    assert {**again, "seconds": 0} == {**kept, "seconds": 0}
    assert main(["runs", "show", "out"]) == ExitCode.DONE
    assert "5.00 % less" in capsys.readouterr().out
    assert main(["runs", "list", "--root", "."]) == ExitCode.DONE
    assert "crank 5.320 kg" in " ".join(capsys.readouterr().out.split())
    assert main(["report", "out", "--out", "page.html"]) == ExitCode.DONE
    assert "5.00 % less" in typed_page(Path("page.html"))
    assert main(["shape", "out"]) == ExitCode.INVALID_INPUT
    assert "has a web for every place of a crank" in capsys.readouterr().err


def test_webs_that_safety_does_not_decide_gain_nothing(
    stand_in: ShapeStandIn, capsys: pytest.CaptureFixture[str]
) -> None:
    """The one search is that for all; what two webs share is not free in it."""
    stand_in.percent["fatigue_safety"] = 120.0
    free = "[shape.free]\npin_fillet_mm = [2.0, 5.0]\n\n[effects]\n"
    Path("mine.toml").write_text(design_text("mikron-iiic").replace("[effects]\n", free, 1), encoding="utf-8")
    assert main(["shape", "mine.toml", "--each-web", "--out", "out"]) == ExitCode.DONE
    said = capsys.readouterr()
    assert "Webs of their own gain nothing: the least safety of 1.200 does not" in said.out
    assert "pin_fillet not free here: webs of their own share their journals" in said.err
    ((scene, _, _),) = stand_in.asked
    assert scene.shape.free.pin_fillet_mm is None


def test_an_interrupted_run_tells_how_to_go_on(
    stand_in: ShapeStandIn, capsys: pytest.CaptureFixture[str]
) -> None:
    stand_in.error = CranktopoError("interrupted", code=ExitCode.INTERRUPTED)
    assert main(["shape", "mikron-iiic", "--each-web", "--out", "out"]) == ExitCode.INTERRUPTED
    assert "cranktopo shape --resume out" in " ".join(capsys.readouterr().err.split())
    stand_in.error = None
    assert main(["shape", "--resume", "out"]) == ExitCode.DONE
    assert "5.00 % less" in capsys.readouterr().out


def test_one_search_alone_is_not_continued(tmp_path: Path, mikron: Scene) -> None:
    """Its load states lie with the run of the whole shaft."""
    settings = {**asdict(shape_settings(mikron)), "loads": "shaft"}
    create_run(
        design="one",
        design_toml="",
        scene=mikron.model_dump(mode="json"),
        options={"shape": settings},
        command=["cranktopo"],
        out=tmp_path / "web-1-8",
    )
    with pytest.raises(CranktopoError, match="search of one web") as refused:
        resume_shape(tmp_path / "web-1-8")
    assert refused.value.hint.endswith(f"--resume {tmp_path}")


@pytest.mark.parametrize(
    ("change", "words", "line"),
    [
        (("", ""), "--web first", "leave --web and --throw out"),
        (("", ""), "--throw 2", "leave --web and --throw out"),
        (("", ""), "--loads cycle", "leave --loads out"),
        (("", ""), "--maximise torsion --limit 'fatigue_safety none'", "all webs of a shaft are the same"),
        (("", ""), "--maximise fatigue_safety", "keeps a least fatigue safety"),
        (('bending = "pinned"', 'bending = "clamped"'), "", "supports.bending"),
        (("[engine.gas]", "[shape]\nsame_webs = [[1, 9]]\n[engine.gas]"), "", "shape.same_webs"),
        (
            ("[throw]", '[crank]\nthrows = ["throw", "other.toml", "throw", "throw"]\n[throw]'),
            "",
            "all begin with one web",
        ),
    ],
)
def test_what_it_cannot_do_is_refused_before_anything_is_written(
    change: tuple[str, str],
    words: str,
    line: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    text = design_text("mikron-iiic")
    Path("other.toml").write_text(text.replace("width_mm = 50.0", "width_mm = 52.0"), encoding="utf-8")
    Path("mine.toml").write_text(text.replace(*change, 1) if change[0] else text, encoding="utf-8")
    code = main(["shape", "mine.toml", "--each-web", "--out", "out", *shlex.split(words)])
    assert code in (ExitCode.USAGE, ExitCode.INVALID_INPUT)
    assert line in " ".join(capsys.readouterr().err.split())
    assert not Path("out").exists()
