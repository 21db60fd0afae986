"""The loop as it hands over to the shape optimiser: interruption, continuation, the last row everywhere."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.tasks.bound.result import NoBound
from cranktopo.tasks.designs.run_webs import web_target
from cranktopo.tasks.iterate import loop
from cranktopo.tasks.web_shape import run as shape_run
from tests.cli.test_iterate import with_stand_ins
from tests.shape_stand_in import ShapeStandIn

ARGUMENTS = ["iterate", "--steps", "1", "--resolution-mm", "4.5", "--volume-fraction", "0.6"]


@pytest.fixture
def stand_in(monkeypatch: pytest.MonkeyPatch) -> ShapeStandIn:
    with_stand_ins(monkeypatch)
    found = ShapeStandIn({"torsion": 118.0, "bending": 102.0})
    monkeypatch.setattr(shape_run, "shape_design", found.design)
    monkeypatch.setattr(shape_run, "resume_shape", found.resume)
    # The bound itself is no subject here, only what it is asked to stand beside.
    monkeypatch.setattr(
        loop, "bounds_for_result", lambda _, reached, *__: NoBound(none=f"beside {reached['torsion']} %")
    )
    return found


@pytest.mark.slow
def test_a_loop_interrupted_in_its_last_step_goes_on_there(
    stand_in: ShapeStandIn, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "loop"
    stand_in.error = CranktopoError("interrupted", code=ExitCode.INTERRUPTED)
    assert main([*ARGUMENTS, "--out", str(out)]) == ExitCode.INTERRUPTED
    assert f"cranktopo iterate --resume {out}" in capsys.readouterr().err
    assert json.loads((out / "manifest.json").read_text())["status"] == "interrupted"
    assert not (out / "iterate.json").exists()
    step = (out / "step-01" / "step.json").read_bytes()
    stand_in.error = None
    assert main(["iterate", "--resume", str(out)]) == 0
    printed = capsys.readouterr().out
    assert stand_in.asked[1:] == [out / "shape"]
    assert (out / "step-01" / "step.json").read_bytes() == step
    data = json.loads((out / "iterate.json").read_text())
    assert [row["name"] for row in data["steps"]] == ["original", "1", "shape"]
    assert data["best_step"] is None
    assert data["shape"]["better_than_best_step"]
    assert data["bound"] == {"none": f"beside {data['steps'][-1]['percent_of_original']['torsion']} %"}
    assert "shape: largest torsional stiffness per mass 118.0 % of the original web, every limit" in printed
    assert "\nbest: shape, torsional stiffness per mass " in printed
    assert printed.count(f"\n{out / 'shape' / 'web.toml'}\n") == 1
    with (out / "steps.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["step"] for row in rows] == ["original", "1", "shape"]
    assert float(rows[-1]["throw_kg"]) == 1.6
    page = (out / "report.html").read_text(encoding="utf-8")
    assert ">shape</option>" in page
    assert "Shape is the best: " in page
    assert web_target(str(out)).file == out / "shape" / "web.toml"
    assert main(["runs", "list", "--root", str(tmp_path)]) == 0
    assert "best: shape" in capsys.readouterr().out


@pytest.mark.slow
def test_a_shape_that_finds_no_web_leaves_the_loop_as_it_is(
    stand_in: ShapeStandIn, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    stand_in.error = CranktopoError("shape: no web keeps the limits.")
    assert main([*ARGUMENTS, "--out", str(tmp_path / "loop")]) == 0
    data = json.loads((tmp_path / "loop" / "iterate.json").read_text())
    assert [row["name"] for row in data["steps"]] == ["original", "1"]
    said = "shape: no web that keeps the limits, the result of the loop stands: shape: no web keeps"
    assert said in capsys.readouterr().out
    assert said[1:] in (tmp_path / "loop" / "report.html").read_text(encoding="utf-8")


@pytest.mark.slow
def test_a_goal_is_for_the_last_step_only(
    stand_in: ShapeStandIn, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["designs", "copy", "mikron-iiic-plain", str(tmp_path / "x.toml")]) == 0
    with (tmp_path / "x.toml").open("a", encoding="utf-8") as file:
        file.write('\n[goal]\nminimise = "mass"\n')
    out = tmp_path / "loop"
    design = [*ARGUMENTS, str(tmp_path / "x.toml"), "--out", str(out)]
    assert main([*design, "--no-shape"]) == ExitCode.INVALID_INPUT
    assert "only its shape step knows a goal. Leave out --no-shape" in capsys.readouterr().err
    assert not out.exists()
    assert main(design) == 0
    assert "shape: least mass 100.0 % of the original web" in capsys.readouterr().out
    assert stand_in.asked[0][0].goal.quantity == "mass"
    assert json.loads((out / "step-01" / "step.json").read_text())["scene"]["goal"] is None
