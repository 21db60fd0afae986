"""Bodies from CAD that lie elsewhere, through the command line: refused, and evaluated with --align."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from cranktopo.cad.solid_files import export_solid, surface_of
from cranktopo.cli.main import main
from cranktopo.scene import load_scene
from cranktopo.triangles.surface_files import write_stl
from cranktopo.triangles.surface_mesh import SurfaceMesh

COARSE = ("--design", "mikron-iiic", "--element-size-mm", "14", "--json")


@pytest.fixture(scope="module")
def turned(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The half throw of the built-in design, turned by a quarter about the crank axis."""
    path = tmp_path_factory.mktemp("cad") / "turned.stl"
    body = surface_of(load_scene("mikron-iiic"), "half", 3.0)
    points = body.vertices_mm @ np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    write_stl(path, SurfaceMesh(points, body.faces))
    return path


def test_a_turned_body_is_refused(turned: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["evaluate", str(turned), *COARSE]) == 3
    error = json.loads(capsys.readouterr().out)["error"]
    assert "looks turned by 90 deg about z" in error["message"]
    assert "--align" in error["hint"]


def test_align_evaluates_it_where_it_belongs(turned: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["evaluate", str(turned), *COARSE, "--align"]) == 0
    out, err = capsys.readouterr()
    assert "turned.stl: moved to where the journals are: it looks turned by 90 deg about z" in err
    found = json.loads(out)["evaluations"][0]
    assert found["unbalance_kg_mm"] == pytest.approx(37.56, rel=0.01)


def test_a_body_in_inches_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "body.stl"
    body = surface_of(load_scene("mikron-iiic"), "half", 6.0)
    write_stl(path, SurfaceMesh(body.vertices_mm / 25.4, body.faces))
    assert main(["evaluate", str(path), *COARSE]) == 3
    assert "in inches" in json.loads(capsys.readouterr().out)["error"]["hint"]


@pytest.mark.slow
def test_a_step_body_that_lies_right_is_evaluated(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "half.step"
    export_solid(load_scene("mikron-iiic"), "half", path)
    assert main(["evaluate", str(path), *COARSE]) == 0
    out, err = capsys.readouterr()
    assert "moved" not in err
    assert json.loads(out)["evaluations"][0]["unbalance_kg_mm"] == pytest.approx(37.56, rel=1e-3)
