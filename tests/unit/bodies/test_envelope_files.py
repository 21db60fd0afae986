"""Envelopes from files: STEP bodies give the cells of the same body as STL or formula; sides that differ."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.cells.domain import build_domain
from cranktopo.bodies.cells.grid import DensityGrid
from cranktopo.bodies.envelope_file import envelope_from_file, mirror_difference, symmetrised
from cranktopo.bodies.prisms import envelope_solid
from cranktopo.bodies.solid.step import step_surface
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import cad_session

HALF, LOW, HIGH, Z = 30.0, -30.0, 78.0, (18.0, 41.0)


def write_step(path: Path, build: Callable[[Any], object]) -> Path:
    with cad_session("test body") as gmsh:
        build(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        gmsh.write(str(path))
    return path


def box(occ: Any) -> tuple[int, int]:
    return 3, occ.addBox(-HALF, LOW, Z[0], 2 * HALF, HIGH - LOW, Z[1] - Z[0])


def drilled(occ: Any) -> object:
    return occ.cut([box(occ)], [(3, occ.addCylinder(0, 24, 0, 0, 0, 60, 5.0))])


def with_envelope(scene: Scene, **envelope: Any) -> Scene:
    return scene_from_dict({**scene.model_dump(mode="json", exclude_none=True), "envelope": envelope})


def test_step_gives_the_cells_of_its_box(mikron: Scene, tmp_path: Path) -> None:
    path = write_step(tmp_path / "box.step", box)
    plain = with_envelope(mikron, shape="box", half_width_mm=HALF, y_min_mm=LOW, y_max_mm=HIGH)
    for symmetric in (False, True):
        filed = with_envelope(mikron, shape="stl", file=str(path), symmetric=symmetric)
        extent = "quarter" if symmetric else "half"
        found, wanted = (build_domain(scene, 6.0, extent=extent) for scene in (filed, plain))
        volume = float((wanted.design_fraction * wanted.volume_mm3).sum())
        assert float((found.design_fraction * found.volume_mm3).sum()) == pytest.approx(volume, rel=1e-6)


@pytest.mark.parametrize("unit", [pytest.param("MM", marks=pytest.mark.slow), "M"])
def test_curved_step_is_a_closed_surface_of_its_volume(unit: str, tmp_path: Path) -> None:
    """A file in metres says so itself, and is read in mm."""
    scale = 1.0 if unit == "MM" else 1e-3
    path = tmp_path / "body.stp"
    with cad_session("test body") as gmsh:
        drilled(gmsh.model.occ)
        gmsh.model.occ.dilate(gmsh.model.occ.getEntities(3), 0, 0, 0, scale, scale, scale)
        gmsh.model.occ.synchronize()
        gmsh.option.setString("Geometry.OCCTargetUnit", unit)
        gmsh.write(str(path))
    mesh = step_surface(path, "body")
    exact = (Z[1] - Z[0]) * (2 * HALF * (HIGH - LOW) - np.pi * 25)
    assert mesh.as_trimesh().is_watertight
    assert mesh.volume_mm3 == pytest.approx(exact, rel=1e-5)


def two(occ: Any) -> None:
    box(occ)
    occ.addBox(100, 0, 18, 10, 10, 10)


@pytest.mark.parametrize(
    ("build", "message"),
    [(two, "holds 2 solids"), (lambda occ: occ.addRectangle(0, 0, 18, 10, 10), "holds 0 solids")],
)
def test_what_is_not_one_solid_is_refused(build: Any, message: str, tmp_path: Path) -> None:
    path = write_step(tmp_path / "body.step", build)
    with pytest.raises(CranktopoError, match=message):
        envelope_from_file(path)


def test_unreadable_step_is_refused(tmp_path: Path) -> None:
    (tmp_path / "text.step").write_text("no STEP file")
    for name, message in (("text.step", "is no STEP file"), ("absent.step", "cannot be read: No such file")):
        with pytest.raises(CranktopoError, match=rf"envelope\.file.*{message}"):
            envelope_from_file(tmp_path / name)


def lopsided_stl(path: Path, more_mm: float) -> Path:
    """The box, one of whose sides is `more_mm` farther out."""
    mesh = trimesh.creation.box(bounds=[[-HALF, LOW, Z[0]], [HALF + more_mm, HIGH, Z[1]]])
    mesh.export(path)
    return path


def test_sides_that_differ_by_their_triangles_are_made_alike(tmp_path: Path) -> None:
    """0.006 mm of 60 are 0.01 %: the side x >= 0 decides and it is said."""
    path = lopsided_stl(tmp_path / "nearly.stl", 0.006)
    assert mirror_difference(envelope_from_file(path)) == pytest.approx(1e-4, rel=0.01)
    body = envelope_from_file(path, symmetric=True)
    assert mirror_difference(body) < 1e-9
    assert body.bounding_box()[0] == pytest.approx(-HALF - 0.006, abs=1e-5)
    assert "0.01 %" in symmetrised(path)


def test_sides_alike_are_left_as_they_are(tmp_path: Path) -> None:
    path = lopsided_stl(tmp_path / "alike.stl", 0.0)
    assert symmetrised(path) == ""
    assert envelope_from_file(path, symmetric=True).volume() == envelope_from_file(path).volume()


def test_sides_that_differ_are_refused(tmp_path: Path) -> None:
    path = lopsided_stl(tmp_path / "lopsided.stl", 0.6)
    with pytest.raises(CranktopoError, match=r"envelope\.symmetric.*0\.99 % of its volume"):
        envelope_from_file(path, symmetric=True)


@pytest.mark.parametrize("rounding_mm", [0.0, 5e-5, -5e-5])
def test_faces_that_a_file_rounds_lie_on_those_of_the_web(
    mikron: Scene, tmp_path: Path, rounding_mm: float
) -> None:
    """Slivers between a rounded face and the exact one passed through each other in loops of random engines.

    Heights of 85.605 mm are 85.605003 in an STL.
    """
    data = mikron.model_dump(mode="json", exclude_none=True)
    data["throw"]["main_journal"]["length_mm"] += 0.202
    data["envelope"] = {"shape": "stl", "file": str(tmp_path / "envelope.stl"), "symmetric": True}
    scene = scene_from_dict(data)
    start, end = scene.web_z_mm
    assert start != float(np.float32(start))
    round_body = trimesh.creation.cylinder(40.0, segment=([0, 20, start + rounding_mm], [0, 20, end]))
    round_body.export(tmp_path / "envelope.stl")
    grid = DensityGrid(np.array([-40.0, -20.0, start]), np.full(3, 4.0), np.ones((20, 20, 6)))
    solid = envelope_solid(scene, grid)
    assert set(np.asarray(solid.to_mesh64().vert_properties)[:, 2]) == {start, end}
