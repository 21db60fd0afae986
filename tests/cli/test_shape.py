"""`cranktopo shape` on coarse cells: files, limits by the evaluation, interruption, bad input."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.design.goal.scene_goal import with_goal
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.tasks.web_shape import run as shape_run
from cranktopo.tasks.web_shape.optimum import ShapeSettings
from cranktopo.tasks.web_shape.run import resume_shape, shape_design

COARSE = ShapeSettings(cell_mm=9.0, mesh_mm=16.0, rounds=3, element_size_mm=14.0)


def light(scene: Scene) -> Scene:
    return with_goal(scene, minimise="mass", maximise=None, limits=("fatigue_safety none",))


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    folder = tmp_path_factory.mktemp("shape") / "run"
    found = shape_design(light(load_scene("mikron-iiic-plain")), COARSE, folder)
    return folder, found.result.as_json()


@pytest.mark.slow
def test_limits_hold_by_the_evaluation_and_the_web_is_lighter(run: tuple[Path, dict[str, Any]]) -> None:
    _, data = run
    assert data["status"] == "converged"
    assert [limit["quantity"] for limit in data["goal"]["limits"]] == ["torsion", "bending"]
    assert all(limit["holds"] for limit in data["goal"]["limits"])
    assert data["change_percent"]["mass"] < -8.0
    assert data["change_percent"]["torsion"] > -0.06


@pytest.mark.slow
def test_the_design_evaluates_as_it_says(run: tuple[Path, dict[str, Any]], capsys: Any) -> None:
    folder, data = run
    assert (
        main(["evaluate", str(folder / "web.toml"), "--element-size-mm", "14", "--json", "--quiet"])
        == ExitCode.DONE
    )
    (found,) = json.loads(capsys.readouterr().out)["evaluations"]
    assert found["mass_kg"]["throw"] == pytest.approx(data["values"]["result"]["mass"], rel=1e-9)
    assert found["torsion"]["free_Nm_per_rad"] == pytest.approx(data["values"]["result"]["torsion"], rel=1e-6)


@pytest.mark.slow
def test_what_a_millimetre_is_worth_predicts_the_evaluation(run: tuple[Path, dict[str, Any]]) -> None:
    """The deeper of two bevels, 1 mm less deep: the mass by the exact solid against the table."""
    from cranktopo.bodies.volume import half_throw_volume_mm3

    folder, data = run
    scene = load_scene(str(folder / "web.toml"))
    name, bevel = "bevel-pin.depth", next(b for b in scene.web.bevel if b.face == "pin")
    (row,) = [row for row in data["parameters"] if row["name"] == name]
    changed = bevel.model_copy(update={"depth_mm": bevel.depth_mm - 0.5})
    others = tuple(changed if b is bevel else b for b in scene.web.bevel)
    web = scene.web.model_copy(update={"bevel": others})
    before, after = (half_throw_volume_mm3(s) for s in (scene, scene.model_copy(update={"web": web})))
    change = 2 * (after - before) * 1e-9 * scene.material.density_kg_m3 / data["values"]["original"]["mass"]
    assert 100 * change == pytest.approx(-0.5 * row["per_unit"]["mass_percent"], rel=0.15)


@pytest.mark.slow
def test_files_and_page(run: tuple[Path, dict[str, Any]]) -> None:
    folder, data = run
    for name in data["files"].values():
        assert (folder / name).stat().st_size > 1000, name
    page = (folder / "report.html").read_text()
    assert "What a millimetre is worth" in page
    assert "Every limit holds" in page
    assert main(["report", str(folder), "--out", str(folder / "again.html")]) == ExitCode.DONE
    assert (folder / "again.html").read_text() == page


@pytest.mark.slow
def test_runs_show_and_list_know_it(run: tuple[Path, dict[str, Any]], capsys: Any) -> None:
    folder, _ = run
    assert main(["runs", "show", str(folder)]) == ExitCode.DONE
    assert "Every limit holds" in capsys.readouterr().out
    assert main(["runs", "list", "--root", str(folder.parent), "--json"]) == ExitCode.DONE
    (entry,) = json.loads(capsys.readouterr().out)["runs"]
    assert entry["command"] == "shape"


@pytest.mark.slow
def test_an_interrupted_optimisation_goes_on_to_the_same_web(
    run: tuple[Path, dict[str, Any]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    _, data = run
    done, once = [], shape_run.StageMemory.once

    def interrupted(self: Any, name: str, make: Any) -> Any:
        if len(done) == 4:
            raise KeyboardInterrupt
        done.append(name)
        return once(self, name, make)

    monkeypatch.setattr(shape_run.StageMemory, "once", interrupted)
    with pytest.raises(CranktopoError, match="interrupted") as error:
        shape_design(light(load_scene("mikron-iiic-plain")), COARSE, tmp_path / "run")
    assert error.value.code == ExitCode.INTERRUPTED
    monkeypatch.undo()
    again = resume_shape(str(tmp_path / "run")).result.as_json()
    assert again["parameters"] == data["parameters"]
    assert again["values"] == data["values"]


def test_without_an_envelope_there_is_no_search(tmp_path: Path, capsys: Any) -> None:
    out = tmp_path / "run"
    assert main(["shape", "opposed-piston-casting", "--out", str(out)]) == ExitCode.INVALID_INPUT
    assert "envelope" in capsys.readouterr().err
    assert not out.exists()
