"""Plugs of a counterweight as bodies of their own: each fits its hole, has its name, and sits where it is."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

from cranktopo.app.main import main
from cranktopo.bodies.solid.files import export_solid
from cranktopo.bodies.solid.plugs import add_plugs
from cranktopo.bodies.solid.throw import add_full_throw
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import cad_session
from tests.unit.throw.counterweight_cases import PLAIN, roomy_scene, weighted

AXIAL = {"axis": "axial", "x_mm": 18.0, "y_mm": -45.0, "diameter_mm": 14.0, "length_mm": 12.0}
AXIAL |= {"density_kg_m3": 17500.0}
RADIAL = {**AXIAL, "axis": "radial", "x_mm": -12.0, "diameter_mm": 10.0, "length_mm": 16.0}


@pytest.fixture(scope="module")
def plugged() -> Scene:
    scene = roomy_scene(load_scene("mikron-iiic-plain"))
    return weighted(scene, {**PLAIN, "plug": [AXIAL, RADIAL]})


def test_a_step_file_of_named_plugs(plugged: Scene, tmp_path: Path) -> None:
    """Four cylinders by their closed forms; those of the second web are mirrored in the middle of the pin."""
    volume = export_solid(plugged, "plugs", tmp_path / "plugs.step")
    axial, radial = math.pi * 7.0**2 * 12.0, math.pi * 5.0**2 * 16.0
    assert volume == pytest.approx(2 * (axial + radial), rel=1e-9)
    start, end = plugged.web_z_mm
    with cad_session("plugs") as gmsh:
        bodies = gmsh.model.occ.importShapes(str(tmp_path / "plugs.step"))
        masses = [gmsh.model.occ.getMass(*pair) for pair in bodies]
        centres = [gmsh.model.occ.getCenterOfMass(*pair) for pair in bodies]
    places = [(18.0, -45.0, start + 6.0), (-12.0, -45.0, (start + end) / 2)]
    places += [(x, y, plugged.pitch_mm - z) for x, y, z in places]
    assert masses == pytest.approx([axial, radial] * 2, rel=1e-9)
    for centre, place in zip(centres, places, strict=True):
        assert centre == pytest.approx(place, abs=1e-6)
    text = (tmp_path / "plugs.step").read_text(encoding="ascii")
    names = [f"plug {n} of web {web}, 17500 kg/m3" for web in (1, 2) for n in (1, 2)]
    assert re.findall(r"=\s*PRODUCT\('([^']*)'", text) == [f"{plugged.name} plugs", *names]
    assert re.findall(r"=\s*MANIFOLD_SOLID_BREP\('([^']*)'", text) == names


def test_each_plug_fits_its_hole(plugged: Scene) -> None:
    """Joined with the throw they make one body with the volume of all: they touch it, and overlap nowhere."""
    with cad_session("fit") as gmsh:
        occ = gmsh.model.occ
        throw, plugs = add_full_throw(occ, plugged), add_plugs(occ, plugged)
        alone = sum(occ.getMass(*pair) for pair in (*throw, *plugs))
        body, _ = occ.fuse(throw, plugs)
        assert len(body) == 1
        assert occ.getMass(*body[0]) == pytest.approx(alone, rel=1e-6)


def test_a_design_without_plugs_has_none_to_write(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["export", "mikron-iiic", str(tmp_path / "a.step"), "--part", "plugs"]) == 3
    assert "no counterweight of it has plugs" in capsys.readouterr().err
    assert not (tmp_path / "a.step").exists()
