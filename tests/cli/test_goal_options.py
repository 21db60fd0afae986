"""Goal and limits as options of the commands."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError
from cranktopo.design.goal.scene_goal import with_goal
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.design.writing import toml_text
from cranktopo.tasks.optimise import stage


def run(capsys: pytest.CaptureFixture[str], *args: str) -> tuple[int, str, str]:
    code = main(list(args))
    out = capsys.readouterr()
    return code, out.out, out.err


def test_plan_shows_goal_cases_and_what_is_assumed(capsys: pytest.CaptureFixture[str]) -> None:
    options = ["--maximise", "torsion_per_mass", "--limit", "bending none", "--limit", "mass <= 1.4 kg"]
    code, out, err = run(capsys, "plan", *options)
    assert code == 0
    assert "goal: largest torsional stiffness per mass; mass <= 1.4 kg\n" in out
    assert "neither goal" in out
    assert "limits by the evaluation: about 4 evaluations of original and surfaces, +60 s\n" in out
    assert 'goal.limits.fatigue_safety = ">= 100 %" (of the original web)' in err
    code, out, _ = run(capsys, "plan", *options, "--json")
    plan = json.loads(out)
    assert plan["evaluations"] == {"number": 4, "seconds": 60.0}
    assert any("neither goal nor limits need it" in effect["reason"] for effect in plan["effects"])
    states = {effect["name"]: effect["state"] for effect in plan["effects"]}
    assert (states["torsion"], states["bending"]) == ("on", "off")
    assert plan["goal"]["maximise"] == "torsion_per_mass"
    assert plan["goal"]["limits"][0] == {
        **{"quantity": "mass", "sense": "<=", "value": 1.4, "unit": "kg"},
        **{"percent": False, "assumed": False},
    }
    assert {
        "key": "goal.limits.fatigue_safety",
        "value": ">= 100 %",
        "meaning": "of the original web",
    } in plan["assumed"]


@pytest.mark.parametrize(
    ("options", "code", "message"),
    [
        (["--minimise", "mass", "--maximise", "torsion"], 2, "--minimise excludes --maximise"),
        (["--limit", "torsion >= 100 %"], 2, "--limit needs a goal: add --minimise or --maximise"),
        (["--minimise", "weight"], 2, "unknown quantity. Did you mean 'mass'?"),
        (["--minimise", "x y"], 2, "unknown quantity. Valid: balance_factor, bearing_pressure,"),
        (["--minimise", "mass", "--limit", "torsion > 1 %"], 2, "goal.limits.torsion = '> 1 %'"),
        (["--minimise", "mass", "--limit", "mass <= 1 kg"], 3, "the goal itself makes it as low as"),
    ],
)
@pytest.mark.parametrize("command", ["plan", "optimise"])
def test_a_mistake_in_the_options_is_one_line(
    capsys: pytest.CaptureFixture[str], command: str, options: list[str], code: int, message: str
) -> None:
    found, out, err = run(capsys, command, *options)
    assert (found, out) == (code, "")
    assert message in err
    assert len(err.splitlines()) == 1


def test_a_resumed_run_keeps_its_goal(capsys: pytest.CaptureFixture[str]) -> None:
    code, _, err = run(capsys, "optimise", "--resume", "x", "--minimise", "mass")
    assert code == 2
    assert "leave out --minimise" in err


def test_a_volume_fraction_beside_a_goal_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    code, _, err = run(capsys, "optimise", "--minimise", "mass", "--volume-fraction", "0.3")
    assert code == 2
    assert "--volume-fraction excludes a goal: limit the mass instead" in err


def test_a_volume_fraction_beside_the_goal_of_a_design_names_its_key_and_the_way_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The user had given no goal: "limit the mass instead" answered a question that nobody asked."""
    monkeypatch.chdir(tmp_path)
    scene = with_goal(load_scene("mikron-iiic"), minimise="mass")
    Path("own.toml").write_text(toml_text(scene, "With a goal."), encoding="utf-8")
    code, _, err = run(capsys, "optimise", "own.toml", "--volume-fraction", "0.3")
    assert code == 2
    assert "excludes the goal of the design, goal.minimise = 'mass': add --no-goal" in err
    seen: list[Scene] = []

    def taken(scene: Scene, *_: object) -> None:
        seen.append(scene)
        raise CranktopoError("enough.")

    monkeypatch.setattr(stage, "optimise_design", taken)
    run(capsys, "optimise", "own.toml", "--volume-fraction", "0.3", "--no-goal")
    assert (seen[0].goal, seen[0].optimise.volume_fraction) == (None, 0.3)


def test_load_states_of_stresses_that_nobody_wants_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    goal = ["--minimise", "mass", "--limit", "fatigue_safety none"]
    assert main(["shape", "mikron-iiic", *goal, "--loads", "cycle"]) == 2
    assert "--loads is of fatigue safety and stress, and neither is wanted" in capsys.readouterr().err


def test_a_cycle_that_the_design_does_not_tell_is_refused_before_anything_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    data = load_scene("mikron-iiic").model_dump(mode="json", exclude_none=True)
    del data["engine"]["gas"]
    data["engine"] |= {"max_gas_force_N": 35000.0, "max_torque_Nm": 400.0}
    Path("given.toml").write_text(toml_text(scene_from_dict(data), "Given loads."), encoding="utf-8")
    assert main(["shape", "given.toml", "--loads", "cycle", "--out", "here"]) == 3
    assert "engine.gas: is missing, so there is no cycle to follow" in capsys.readouterr().err
    assert not Path("here").exists()
