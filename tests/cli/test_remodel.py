"""`cranktopo remodel`: files of a fitted web, what it refuses; the whole command in a slow test."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh
from matplotlib.image import imread

from cranktopo.app.main import main
from cranktopo.bodies.solid.files import surface_of
from cranktopo.bodies.volume import half_throw_volume_mm3
from cranktopo.design.loading import designs_folder, load_scene
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import mesh_of
from cranktopo.runs.directories import create_run
from cranktopo.tasks.refit import stage as remodel
from cranktopo.tasks.refit.fit import FittedWeb
from cranktopo.tasks.refit.select import FitTrial
from cranktopo.tasks.refit.shape_error import shape_error
from cranktopo.tasks.refit.stage import write_refit
from tests.step_volume import step_volume_mm3
from tests.unit.refit.remodel_cases import PLAIN, WHOLE, body_of, known_scene, values_of

COARSE_MM = "4.5"


@pytest.mark.slow
def test_files_of_a_fitted_web(mikron: Scene, tmp_path: Path) -> None:
    """The scene reads back the same, STEP and STL hold its volume, the drawing shows something everywhere."""
    scene = known_scene(mikron, WHOLE)
    body = mesh_of(body_of(known_scene(mikron, PLAIN), 1.0))
    trials = (FitTrial("outline", 7, 80.0, 0.0, True),)
    fitted = FittedWeb(scene, WHOLE.names, tuple(values_of(WHOLE)), trials, (0.8,), ())
    near, half_throw = shape_error(scene, body), surface_of(scene, "half")
    files = write_refit(fitted, near, half_throw, body, tmp_path)
    assert load_scene(str(tmp_path / files.design)) == scene
    volume = half_throw_volume_mm3(scene)
    assert step_volume_mm3(tmp_path / files.step) == pytest.approx(volume, rel=1e-6)
    stl = trimesh.load_mesh(tmp_path / files.stl)
    assert stl.is_watertight
    assert stl.volume == pytest.approx(volume, rel=2e-3)
    picture = imread(tmp_path / files.drawing)[..., :3]
    ink = picture.min(axis=-1) < 0.9
    quarters = [part for half in np.array_split(ink, 2) for part in np.array_split(half, 2, axis=1)]
    assert all(0.005 < part.mean() < 0.5 for part in quarters)
    svg = (tmp_path / files.drawing_svg).read_text()
    assert "<svg" in svg


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda run: None, "not a run directory"),
        (lambda run: (run / "manifest.json").write_text("{}"), "manifest"),
    ],
    ids=["empty folder", "empty manifest"],
)
def test_what_is_no_run_is_refused(
    make: Callable[[Path], object], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = tmp_path / "run"
    run.mkdir()
    make(run)
    assert main(["remodel", str(run)]) == 3
    assert message in capsys.readouterr().err


def block(*extra: tuple[float, float, float]) -> trimesh.Trimesh:
    """A block over the half throw's height, with further blocks of the same size beside it."""
    first = trimesh.creation.box(bounds=[[-30.0, -25.0, 0.0], [30.0, 75.0, 57.0]])
    others = [first.copy().apply_translation(shift) for shift in extra]
    return trimesh.util.concatenate([first, *others])


def joined_at_an_edge() -> trimesh.Trimesh:
    mesh = block((60.0, 100.0, 0.0))
    mesh.merge_vertices()
    return mesh


def opened() -> trimesh.Trimesh:
    mesh = block()
    mesh.update_faces(np.arange(len(mesh.faces)) > 0)
    return mesh


BAD_SURFACES: dict[str, tuple[Callable[[], bytes], str]] = {
    "open": (lambda: stl_of(opened()), "not watertight"),
    "non-manifold": (lambda: stl_of(joined_at_an_edge()), "not watertight"),
    "in metres": (lambda: stl_of(block().apply_scale(1e-3)), "in metres: export it in mm"),
    "no triangles": (lambda: stl_of(trimesh.Trimesh()), "no triangles"),
    "empty file": (lambda: b"", "no triangles"),
    "text": (lambda: b"not a surface at all", "no triangles"),
    "two bodies": (lambda: stl_of(block((200.0, 0.0, 0.0))), "2 separate bodies"),
}


def stl_of(mesh: trimesh.Trimesh) -> bytes:
    """Binary STL: header, count, 50 bytes per triangle."""
    records = np.zeros(len(mesh.faces), dtype=[("v", "<f4", (4, 3)), ("end", "<u2")])
    if len(mesh.faces):
        records["v"][:, 1:] = mesh.vertices[mesh.faces]
    return bytes(80) + len(mesh.faces).to_bytes(4, "little") + records.tobytes()


def unfinished_run(folder: Path, scene: Scene) -> Path:
    """A run of the Mikron that holds nothing but its inputs."""
    return create_run(
        design="mikron-iiic-plain",
        design_toml=(designs_folder() / "mikron-iiic-plain.toml").read_text(),
        scene=scene.model_dump(mode="json"),
        options={},
        command=["cranktopo", "optimise"],
        inputs={},
        out=folder / "run",
    ).path


@pytest.mark.parametrize("name", BAD_SURFACES)
def test_a_surface_that_is_no_solid_is_refused(
    name: str, tmp_path: Path, mikron: Scene, capsys: pytest.CaptureFixture[str]
) -> None:
    """As the surface of a run, as a file to be evaluated: one clear line, exit code 3, nothing written."""
    make, message = BAD_SURFACES[name]
    run = unfinished_run(tmp_path, mikron)
    (run / "web.stl").write_bytes(make())
    for command in (
        ["remodel", str(run)],
        ["evaluate", str(run / "web.stl"), "--design", "mikron-iiic-plain"],
    ):
        before = sorted(tmp_path.rglob("*"))
        assert main(command) == 3, command
        captured = capsys.readouterr()
        assert captured.out == ""
        errors = [line for line in captured.err.splitlines() if line.startswith("error: ")]
        assert len(errors) == 1, captured.err
        assert message in errors[0]
        assert "Traceback" not in captured.err
        assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize("name", BAD_SURFACES)
def test_an_envelope_that_is_no_solid_is_refused(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """As the design space of the loop: one line that names the file, exit code 3, nothing written."""
    make, _ = BAD_SURFACES[name]
    (tmp_path / "space.stl").write_bytes(make())
    text = (designs_folder() / "mikron-iiic-plain.toml").read_text().split("[envelope]")[0]
    (tmp_path / "web.toml").write_text(f'{text}[envelope]\nshape = "stl"\nfile = "space.stl"\n')
    out = tmp_path / "loop"
    assert main(["iterate", str(tmp_path / "web.toml"), "--resolution-mm", COARSE_MM, "--out", str(out)]) == 3
    (error,) = capsys.readouterr().err.splitlines()
    assert re.search(ENVELOPE_MESSAGES.get(name, "closed surface|no triangles"), error)
    assert "space.stl" in error
    assert not out.exists()


ENVELOPE_MESSAGES = {"in metres": "in metres: export it in mm", "two bodies": "holds 2 separate bodies"}


def test_a_run_without_a_surface_is_refused(
    tmp_path: Path, mikron: Scene, capsys: pytest.CaptureFixture[str]
) -> None:
    run = unfinished_run(tmp_path, mikron)
    assert main(["remodel", str(run)]) == 3
    error = capsys.readouterr().err
    assert "web.stl is missing, so this is no finished run" in error
    assert len(error.splitlines()) == 1


def test_an_interrupted_remodel_leaves_nothing(
    tmp_path: Path, mikron: Scene, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not even the folder, which would be in the way of the next try."""
    run = unfinished_run(tmp_path, mikron)
    (run / "web.stl").write_bytes(stl_of(block()))
    before = sorted(tmp_path.rglob("*"))
    seen: list[list[str]] = []

    def interrupted(
        fitted: object, near: object, half: object, surface: object, folder: Path, *_: object
    ) -> None:
        (folder / "half_throw.step").touch()
        seen.append([path.name for path in run.iterdir() if path.is_dir()])
        raise KeyboardInterrupt

    for name in ("read_half_throw", "fit_web", "shape_error", "strip_features", "surface_of", "as_stored"):
        monkeypatch.setattr(remodel, name, lambda *_: SimpleNamespace(scene=mikron))
    monkeypatch.setattr(remodel, "write_refit", interrupted)
    assert main(["remodel", str(run)]) == 130
    assert "interrupted" in capsys.readouterr().err
    assert len(seen[0]) == 1
    assert seen[0][0].startswith(".unfinished-")
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.slow
def test_whole_command_on_a_coarse_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Run, re-model, and every command that takes a design takes the result."""
    run = tmp_path / "run"
    assert main(["optimise", "--resolution-mm", COARSE_MM, "--out", str(run)]) == 0
    capsys.readouterr()
    assert main(["remodel", str(run), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["iou"]["half_throw"] > 0.85
    assert abs(data["stiffness"]["difference_percent"]["torsion"]) < 10
    assert any(trial["step"].endswith("stations") and trial["kept"] for trial in data["trials"])
    design = str(run / "remodel" / data["files"]["design"])
    assert main(["plan", design]) == 0
    assert main(["loads", design]) == 0
    assert main(["export", design, str(tmp_path / "throw.step")]) == 0
    again = ["optimise", design, "--resolution-mm", COARSE_MM, "--max-iterations", "2"]
    assert main([*again, "--out", str(tmp_path / "again")]) in (0, 5)
    assert main(["remodel", str(run)]) == 3  # its folder is taken
