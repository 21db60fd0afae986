"""A run stands for the scene it was started with, whatever its folder and the options of its command."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import design_text, designs_folder, load_scene
from cranktopo.design.scene_files import input_files
from cranktopo.design.schema import Scene
from cranktopo.design.writing import design_from_run, toml_text
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.runs.directories import RunStore, create_run
from cranktopo.runs.manifest import settings_hash
from cranktopo.tasks.refit import stage as pipeline_remodel
from cranktopo.tasks.throw_fea.targets import resolve_target
from cranktopo.throw.manufacturing_limits import ManufacturingLimits
from tests.unit.engine.test_indicator import write as write_indicator

PEAK = "peak_pressure_MPa = 5.16\npeak_angle_deg = 11.0"


def with_files(folder: Path) -> Path:
    """The Mikron with an indicator diagram and an envelope whose paths are relative to the design."""
    folder.mkdir()
    write_indicator(folder / "p.csv")
    trimesh.creation.box(bounds=[[-48, -34, 10], [48, 82, 45]]).export(folder / "space.stl")
    text = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
    assert PEAK in text
    text = text.replace(PEAK, "indicator_csv = 'p.csv'").split("[envelope]")[0]
    path = folder / "engine.toml"
    path.write_text(f'{text}[envelope]\nshape = "stl"\nfile = "space.stl"\n', encoding="utf-8")
    return path


@pytest.fixture
def run(tmp_path: Path) -> RunStore:
    """A run of that design elsewhere, with the options of a command line, that has its surface."""
    design = with_files(tmp_path / "made")
    scene = load_scene(str(design)).with_optimise(volume_fraction=0.123, process="cast")
    made = create_run(
        design=scene.name,
        design_toml=design_text(str(design)),
        scene=scene.model_dump(mode="json"),
        options={},
        command=["cranktopo", "optimise"],
        inputs=input_files(scene),
        out=tmp_path / "elsewhere" / "run",
    )
    trimesh.creation.box(bounds=[[-30, -25, 0], [30, 75, 57]]).export(made.path / "web.stl")
    return made


def check(scene: Scene, folder: Path) -> None:
    assert input_files(scene) == {
        "engine.gas.indicator_csv": folder / "p.csv",
        "envelope.file": folder / "space.stl",
    }
    assert (scene.optimise.volume_fraction, scene.optimise.process) == (0.123, "cast")


def test_a_run_is_evaluated_with_its_own_scene(run: RunStore, tmp_path: Path) -> None:
    check(design_from_run(run), tmp_path.resolve() / "made")
    check(resolve_target(str(run.path)).scene, tmp_path.resolve() / "made")


def test_a_run_is_re_modelled_with_its_own_scene(
    run: RunStore, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What the fit is given, and the text that is written of it."""
    given: list[Scene] = []

    def fit(surface: Any, scene: Scene, limits: ManufacturingLimits, beside: Any) -> Any:
        given.append(scene)
        raise CranktopoError("enough")

    box = SurfaceMesh(np.zeros((3, 3)), np.array([[0, 1, 2]]))
    monkeypatch.setattr(pipeline_remodel, "read_half_throw", lambda *_: box)
    monkeypatch.setattr(pipeline_remodel, "fit_web", fit)
    assert main(["remodel", str(run.path)]) == 3
    check(given[0], tmp_path.resolve() / "made")
    (tmp_path / "web.toml").write_text(toml_text(given[0], "fitted"), encoding="utf-8")
    check(load_scene(str(tmp_path / "web.toml")), tmp_path.resolve() / "made")


def test_a_folder_without_a_manifest_is_no_run(run: RunStore, capsys: pytest.CaptureFixture[str]) -> None:
    (run.path / "manifest.json").unlink()
    assert main(["evaluate", str(run.path)]) == 3
    assert "not a run directory (manifest.json is missing)" in capsys.readouterr().err


def test_a_manifest_without_a_sound_scene_is_named(run: RunStore, capsys: pytest.CaptureFixture[str]) -> None:
    path = run.path / "manifest.json"
    whole = path.read_text(encoding="utf-8")
    path.write_text(whole.replace('"radius_mm": 48.0', '"radius_mm": 47.0'), encoding="utf-8")
    assert main(["evaluate", str(run.path)]) == 3
    assert "changed by hand" in capsys.readouterr().err
    data = json.loads(whole.replace('"radius_mm": 48.0', '"radius_mm": -48.0'))
    data["settings_sha256"] = settings_hash(data["scene"], data["options"])
    path.write_text(json.dumps(data), encoding="utf-8")
    assert main(["evaluate", str(run.path)]) == 3
    assert f"{path}: throw.radius_mm = -48.0" in capsys.readouterr().err
    path.write_text(whole.replace('"scene":', '"seen":'), encoding="utf-8")
    assert main(["evaluate", str(run.path)]) == 3
    assert "incomplete, scene missing" in capsys.readouterr().err
