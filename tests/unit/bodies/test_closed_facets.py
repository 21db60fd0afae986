"""An STL file of a solid is closed, or not written: facets that do not close are joined or made anew."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.bodies.solid import files
from cranktopo.bodies.solid.facets import closed_facets, open_error
from cranktopo.bodies.solid.files import export_solid
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import triangles
from cranktopo.numerics.surfaces.files import read_stl
from cranktopo.numerics.surfaces.mesh import SurfaceMesh


def box() -> SurfaceMesh:
    made = trimesh.creation.box((20.0, 30.0, 40.0)).subdivide()
    return SurfaceMesh(np.asarray(made.vertices, float), np.asarray(made.faces, np.int64))


def apart(by_mm: float) -> SurfaceMesh:
    """A box whose top has vertices of its own."""
    whole = box()
    top = (whole.corners_mm[:, :, 2] > 19.9).all(axis=1)
    faces = np.where(top[:, None], whole.faces + len(whole.vertices_mm), whole.faces)
    return SurfaceMesh(np.vstack([whole.vertices_mm, whole.vertices_mm + np.array([0.0, 0.0, by_mm])]), faces)


def test_closed_facets_stay_as_they_are() -> None:
    whole = box()
    assert closed_facets(whole) is whole


def test_edges_within_the_tolerance_of_the_kernel_are_joined() -> None:
    joined = closed_facets(apart(1e-5))
    assert joined is not None
    assert joined.as_trimesh().is_watertight
    assert joined.volume_mm3 == pytest.approx(24000.0, rel=1e-6)


def test_edges_farther_apart_are_told_with_their_place() -> None:
    open_box = apart(0.5)
    assert closed_facets(open_box) is None
    error = open_error("crankshaft of mine", open_box, [4.0, 3.6])
    assert error.code == ExitCode.SOLVER
    assert "facets of 4, 3.6 mm" in str(error)
    assert "16 edges have not two faces" in str(error)


def holed(monkeypatch: pytest.MonkeyPatch, times: int) -> None:
    """Let the mesher leave out the faces around a vertex, some times."""
    calls = []

    def some(gmsh: Any) -> tuple[Any, Any]:
        vertices, faces = triangles(gmsh)
        calls.append(1)
        far = np.linalg.norm(vertices[faces].mean(axis=1) - vertices[0], axis=1) > 12.0
        return vertices, faces[far] if len(calls) <= times else faces

    monkeypatch.setattr(files, "triangles", some)


def test_another_size_is_tried_and_told(
    mikron: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[str] = []
    monkeypatch.setattr(files, "note", told.append)
    holed(monkeypatch, 1)
    export_solid(mikron, "web", tmp_path / "web.stl", 4.0)
    assert read_stl(tmp_path / "web.stl").as_trimesh().is_watertight
    assert told == [f"web of {mikron.name}: facets of 4 mm do not close; written with 3.6 mm"]


def test_nothing_is_written_that_is_open(
    mikron: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    holed(monkeypatch, 3)
    path = tmp_path / "web.stl"
    path.write_text("mine")
    with pytest.raises(CranktopoError, match=r"edges have not two faces, one of them at \(.*\) mm") as caught:
        export_solid(mikron, "web", path, 4.0)
    assert caught.value.code == ExitCode.SOLVER
    assert "STEP" in str(caught.value.hint)
    assert path.read_text() == "mine"
    assert [one.name for one in tmp_path.iterdir()] == ["web.stl"]
