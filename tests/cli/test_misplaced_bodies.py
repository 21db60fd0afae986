"""Bodies from CAD that lie elsewhere, through the command line: refused, and evaluated with --align."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from cranktopo.app.main import main
from cranktopo.bodies.solid.files import export_solid, surface_of
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.numerics.surfaces.files import write_stl
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.tasks.importing.imported_body import fillets_of_step

COARSE = ("--design", "mikron-iiic-plain", "--element-size-mm", "14", "--json")


@pytest.fixture(scope="module")
def turned(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The half throw of the built-in design, turned by a quarter about the crank axis."""
    path = tmp_path_factory.mktemp("cad") / "turned.stl"
    body = surface_of(load_scene("mikron-iiic-plain"), "half", 3.0)
    points = body.vertices_mm @ np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    write_stl(path, SurfaceMesh(points, body.faces))
    return path


def test_a_turned_body_is_refused(turned: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["evaluate", str(turned), *COARSE]) == 3
    error = json.loads(capsys.readouterr().out)["error"]
    assert "looks turned by 90 deg about z" in error["message"]
    assert "--align" in error["hint"]


@pytest.mark.slow
def test_align_evaluates_it_where_it_belongs(turned: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["evaluate", str(turned), *COARSE, "--align"]) == 0
    out, err = capsys.readouterr()
    assert "turned.stl: moved to where the journals are: it looks turned by 90 deg about z" in err
    found = json.loads(out)["evaluations"][0]
    assert found["unbalance_kg_mm"] == pytest.approx(37.56, rel=0.01)


def test_a_body_in_inches_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "body.stl"
    body = surface_of(load_scene("mikron-iiic-plain"), "half", 6.0)
    write_stl(path, SurfaceMesh(body.vertices_mm / 25.4, body.faces))
    assert main(["evaluate", str(path), *COARSE]) == 3
    assert "in inches" in json.loads(capsys.readouterr().out)["error"]["hint"]


@pytest.mark.parametrize(
    "content",
    [
        pytest.param("ISO-10303-21;", marks=pytest.mark.slow),
        "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1=X(",
    ],
    ids=repr,
)
def test_a_damaged_step_is_said_to_be_one(
    content: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """Nothing of the reader's own messages stands beside it, also where stdout is to hold JSON alone."""
    path = tmp_path / "body.step"
    path.write_text(content)
    assert main(["evaluate", str(path), *COARSE]) == 3
    error = json.loads(capfd.readouterr().out)["error"]
    assert "body.step': cannot be read as STEP." in error["message"] + "." or "0 solids" in error["message"]


ATTITUDES = {
    "turned by 90 deg about z": ((0, 0, 1), 90.0, (0.0, 0.0, 0.0)),
    "turned by 180 deg about z": ((0, 0, 1), 180.0, (0.0, 0.0, 0.0)),
    "turned end for end": ((0, 1, 0), 180.0, (0.0, 0.0, 57.0)),
    "turned by 90 deg about y": ((0, 1, 0), 90.0, (0.0, 0.0, 0.0)),
    "turned by 3 deg about z": ((0, 0, 1), 3.0, (0.0, 0.0, 0.0)),
    "shifted by (1.00, 0.00, 0.00) mm": ((0, 0, 1), 0.0, (1.0, 0.0, 0.0)),
}


@pytest.mark.slow
@pytest.mark.parametrize("words", ATTITUDES)
def test_step_bodies_that_lie_elsewhere(
    words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    axis, angle_deg, shift = ATTITUDES[words]
    right, wrong = tmp_path / "half.step", tmp_path / "wrong.step"
    export_solid(load_scene("mikron-iiic-plain"), "half", right)
    with cad_session("wrong") as gmsh:
        body = gmsh.model.occ.importShapes(str(right))
        gmsh.model.occ.rotate(body, 0, 0, 0, *axis, np.radians(angle_deg))
        gmsh.model.occ.translate(body, *shift)
        gmsh.model.occ.synchronize()
        gmsh.write(str(wrong))
    assert main(["evaluate", str(wrong), *COARSE]) == 3
    error = json.loads(capsys.readouterr().out)["error"]
    assert words in error["message"]
    assert "--align" in error["hint"]


@pytest.mark.slow
def test_a_step_body_that_lies_right_is_evaluated(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "half.step"
    export_solid(load_scene("mikron-iiic-plain"), "half", path)
    assert main(["evaluate", str(path), *COARSE]) == 0
    out, err = capsys.readouterr()
    assert "moved" not in err
    assert json.loads(out)["evaluations"][0]["unbalance_kg_mm"] == pytest.approx(37.56, rel=1e-3)


@pytest.mark.slow
def test_a_throw_with_drillings_that_open_in_its_ends_lies_right(tmp_path: Path) -> None:
    """The kernel's box of such a body reaches 1.6 mm beyond both end sections."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", by_alias=True, exclude_none=True)
    ends = {"from": {"on": "main_journal", "angle_deg": 180.0, "place_mm": 0.0}}
    ends["to"] = {"on": "crankpin", "angle_deg": 0.0, "place_mm": 6.0}
    data["throw"]["drilling"] = [{**ends, "diameter_mm": 5.0, "outlet_radius_mm": 1.0}]
    for journal in ("main_journal", "crankpin"):
        data["throw"][journal]["bore_diameter_mm"] = 0.0
    scene, path = scene_from_dict(data), tmp_path / "throw.step"
    export_solid(scene, "throw", path)
    with cad_session("box") as gmsh:
        (body,) = gmsh.model.occ.importShapes(str(path))
        assert gmsh.model.occ.getBoundingBox(*body)[2] < -0.1, "the case that was refused"
    assert fillets_of_step(path, scene).throw.crankpin.fillet_mm == pytest.approx(2.5, abs=1e-3)
