"""Native code that does not survive triangles of another program: one line, exit code 3."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest

from cranktopo import load_scene
from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.bodies.solid.files import export_solid
from cranktopo.tasks.crank_import import stage
from cranktopo.tasks.importing import imported_body
from cranktopo.tasks.importing.imported_body import mesh_file

SIZE_MM = 15.0


def dying(*_: object) -> None:
    """Stand for native code that breaks off its process."""
    os.kill(os.getpid(), signal.SIGSEGV)


@pytest.fixture(scope="module")
def stl(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("triangles") / "half.stl"
    export_solid(load_scene("mikron-iiic-plain"), "half", path, 4.0)
    return path


@pytest.mark.slow
def test_a_mesh_from_the_child_is_that_of_this_process(stl: Path) -> None:
    scene = load_scene("mikron-iiic-plain")
    here, there = (mesh_file(stl, scene, SIZE_MM, own=own) for own in (True, False))
    assert (here.mesh.points_mm == there.mesh.points_mm).all()
    assert (here.mesh.cells == there.mesh.cells).all()


def test_the_mesher_breaks_off(stl: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(imported_body, "_filled", dying)
    with pytest.raises(CranktopoError, match=r"half.stl': the mesher crashed on it \(SIGSEGV\)") as caught:
        mesh_file(stl, load_scene("mikron-iiic-plain"), SIZE_MM)
    assert caught.value.code == ExitCode.INVALID_INPUT


def test_the_reader_of_a_crank_breaks_off(
    stl: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(stage, "crank_of_mesh", dying)
    assert main(["import", str(stl), "--out", str(tmp_path / "x")]) == ExitCode.INVALID_INPUT
    told = capsys.readouterr().err
    assert "half.stl': the reader of triangles crashed on it (SIGSEGV)" in told
    assert not (tmp_path / "x").exists()
