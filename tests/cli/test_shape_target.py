"""What `cranktopo shape` begins with: a design, a scene, a run of any kind, the folder of a re-model."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import redirected
from cranktopo.design.goal.scene_goal import with_goal
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.design.writing import toml_text
from cranktopo.runs.directories import RunStore, create_run
from cranktopo.runs.kind import RESULT_FILES, RunKind
from cranktopo.tasks.designs.run_webs import web_target
from cranktopo.tasks.refit.family import Layout, web_of
from cranktopo.tasks.refit.result import RefitFiles
from cranktopo.tasks.web_shape import run as shape
from cranktopo.tasks.web_shape.optimum import ShapeSettings
from cranktopo.throw.bevel import FittedBevel
from cranktopo.throw.fitted_slot import FittedSlot
from tests.physics.shape.shape_cases import Array, full_web

COARSE = ShapeSettings(cell_mm=9.0, rounds=1, element_size_mm=14.0)


@pytest.fixture(scope="module")
def web() -> Scene:
    """A scene of the family on the throw of the design."""
    scene, layout, values = full_web()
    data = scene.model_dump(mode="json", exclude={"published"}, exclude_none=True)
    return scene_from_dict({**data, "web": web_of(layout, values, scene), "name": "fitted"})


def run_of(kind: RunKind, folder: Path, web: Scene, result: dict[str, Any] | None = None) -> RunStore:
    """A run of a kind as it lies on the disk when it is done."""
    scene = load_scene("mikron-iiic-plain")
    run = create_run(
        design=scene.name,
        design_toml=toml_text(scene, "design"),
        scene=scene.model_dump(mode="json"),
        options={} if kind == "optimise" else {kind: {}},
        command=["cranktopo", kind],
        out=folder,
    )
    places: dict[RunKind, list[str]] = {
        "shape": ["web.toml"],
        "iterate": ["step-01/web.toml", "step-02/web.toml"],
        "optimise": [],
    }
    for place in places[kind]:
        (folder / place).parent.mkdir(exist_ok=True)
        (folder / place).write_text(toml_text(web, "web"))
    (folder / RESULT_FILES[kind]).write_text(json.dumps(result or {}))
    return run


def remodel_of(run: RunStore, folder: Path, web: Scene) -> Path:
    folder.mkdir()
    (folder / "fitted.toml").write_text(toml_text(web, "re-model"))
    (folder / "remodel.json").write_text(json.dumps({"run": run.name, "files": {"design": "fitted.toml"}}))
    return folder / "fitted.toml"


def test_a_design_begins_with_itself() -> None:
    found = web_target("opposed-piston")
    assert (found.design.name, found.file, found.run, found.begun) == ("opposed-piston", None, None, None)


def test_a_scene_is_its_own_original(tmp_path: Path, web: Scene) -> None:
    (tmp_path / "web.toml").write_text(toml_text(web, "web"))
    assert web_target(str(tmp_path / "web.toml")).design.web == web.web


def test_a_shape_run_begins_with_its_result_and_refers_to_its_design(tmp_path: Path, web: Scene) -> None:
    found = web_target(str(run_of("shape", tmp_path / "run", web).path))
    assert found.file == tmp_path / "run" / "web.toml"
    assert found.design.web == load_scene("mikron-iiic-plain").web
    assert isinstance(found.begun, Scene)
    assert found.begun.web == web.web


def test_a_loop_begins_with_its_best_step(tmp_path: Path, web: Scene) -> None:
    steps = [{"number": number} for number in range(3)]
    run = run_of("iterate", tmp_path / "run", web, {"best_step": 2, "steps": steps})
    assert web_target(str(run.path)).file == tmp_path / "run" / "step-02" / "web.toml"
    (run.path / "iterate.json").write_text(json.dumps({"best_step": None}))
    with pytest.raises(CranktopoError, match="found no better web"):
        web_target(str(run.path))


def test_an_optimisation_begins_with_its_newest_remodel(tmp_path: Path, web: Scene) -> None:
    run, other = (run_of("optimise", tmp_path / name, web) for name in ("run", "other"))
    assert web_target(str(run.path)).file is None
    assert web_target(str(run.path)).begun == run
    first = remodel_of(run, run.path / "remodel", web)
    second = remodel_of(run, tmp_path / "again", web)
    remodel_of(other, tmp_path / "of-another", web)
    os.utime(first.parent / "remodel.json", (1e9, 1e9))
    assert web_target(str(run.path)).file == second
    os.utime(second.parent / "remodel.json", (9e8, 9e8))
    assert web_target(str(run.path)).file == first


def test_the_folder_of_a_remodel_knows_its_run(tmp_path: Path, web: Scene) -> None:
    run = run_of("optimise", tmp_path / "run", web)
    for folder in (run.path / "remodel", tmp_path / "beside"):
        file = remodel_of(run, folder, web)
        found = web_target(str(folder))
        assert (found.file, found.design.web) == (file, load_scene("mikron-iiic-plain").web)
    remodel_of(RunStore(tmp_path / "gone"), tmp_path / "orphan", web)
    with pytest.raises(CranktopoError, match="is gone") as error:
        web_target(str(tmp_path / "orphan"))
    assert "fitted.toml" in error.value.hint


@pytest.mark.parametrize(
    ("name", "said"),
    [("nothing", "no such file or built-in design"), ("folder", "not a run directory"), ("body.stl", "STL")],
)
def test_anything_else_is_refused(tmp_path: Path, name: str, said: str, capsys: Any) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "body.stl").write_text("solid a")
    out = tmp_path / "out"
    assert main(["shape", str(tmp_path / name), "--out", str(out)]) == ExitCode.INVALID_INPUT
    assert said in capsys.readouterr().err
    assert not out.exists()


def test_an_unfinished_run_is_refused(tmp_path: Path, web: Scene, capsys: Any) -> None:
    run = run_of("shape", tmp_path / "run", web)
    (run.path / "shape.json").unlink()
    assert main(["shape", str(run.path), "--out", str(tmp_path / "out")]) == ExitCode.INVALID_INPUT
    assert "cranktopo shape --resume" in capsys.readouterr().err


def forged_start() -> tuple[Layout, Array]:
    """The web as a die that parts in x = 0 leaves it: without its last two features, pockets from a face, and
    with the draft of the die on its bevels and its radius along the floor of its groove."""
    _, layout, values = full_web()
    lost = sum(len(part.names) for part in layout.parts[3:])
    first, second, groove = layout.parts[:3]
    assert isinstance(first, FittedBevel)
    assert isinstance(second, FittedBevel)
    assert isinstance(groove, FittedSlot)
    parts = (
        replace(first, draft_deg=5.0),
        replace(second, draft_deg=5.0),
        replace(groove, floor_radius_mm=3.25),
    )
    return replace(layout, parts=parts), values[:-lost]


class AskedError(Exception):
    """The search was reached."""


def test_the_search_begins_with_the_web_of_the_run(
    tmp_path: Path, web: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The scene is that of the design, the start the web of the run; a continued search begins alike."""
    asked: list[tuple[Any, ...]] = []

    def stop(scene: Scene, *rest: Any) -> Any:
        asked.append((scene, rest[3]))
        raise AskedError

    monkeypatch.setattr(shape, "optimise_shape", stop)
    run = run_of("shape", tmp_path / "run", web)
    main(["shape", str(run.path), "--minimise", "mass", "--out", str(tmp_path / "out")])
    with pytest.raises(AskedError):
        shape.resume_shape(str(tmp_path / "out"))
    layout, values = forged_start()
    assert len(asked) == 2
    for scene, start in asked:
        assert scene.web == load_scene("mikron-iiic-plain").web
        assert start.layout == layout
        assert start.values == pytest.approx(values, abs=0.02)


def test_a_run_without_a_remodel_gets_one_first(
    tmp_path: Path, web: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    run, lines = run_of("optimise", tmp_path / "run", web), list[str]()

    def made(reference: str, **_: Any) -> SimpleNamespace:
        assert reference == str(run.path)
        remodel_of(run, run.path / "remodel", web)
        return SimpleNamespace(folder=str(run.path / "remodel"), files=RefitFiles(design="fitted.toml"))

    def stop(*asked: Any) -> Any:
        raise AskedError(asked[4].layout)

    monkeypatch.setattr(shape, "remodel_run", made)
    monkeypatch.setattr(shape, "optimise_shape", stop)
    target = web_target(str(run.path))
    scene = with_goal(target.design, minimise="mass")
    with pytest.raises(AskedError) as asked, redirected(lines.append):
        shape.shape_design(scene, COARSE, tmp_path / "out", begun=target.begun)
    assert asked.value.args == (forged_start()[0],)
    assert any("so it is made first" in line for line in lines)
