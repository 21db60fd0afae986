"""Checks refuse every kind of broken surface, and what is written is what was checked."""

from __future__ import annotations

import dataclasses
import os
from pathlib import Path

import numpy as np
import pytest
import trimesh
from manifold3d import CrossSection, Manifold

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.numerics.surfaces.files import write_stl
from cranktopo.numerics.surfaces.mesh import (
    SurfaceMesh,
    check_manifold,
    check_self_intersection,
    mesh_of,
    outward,
    shell_volumes_mm3,
    shells,
    solid_of,
    sound_mesh_of,
)
from cranktopo.tasks.extraction.checked_surface import check_surface
from cranktopo.tasks.extraction.half_throw import WebSurface, extract_half_throw
from tests.unit.extraction.surface_cases import grid_of, obround, scene_with

_CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=np.float64)
_FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


@pytest.fixture(scope="module")
def slot() -> WebSurface:
    scene = scene_with()
    return extract_half_throw(grid_of(scene, obround(), cell_mm=2.0), scene)


def _two(shift: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray]:
    return np.concatenate([_CORNERS, _CORNERS + shift]), np.concatenate([_FACES, _FACES + 4])


def test_report_holds_measured_values(slot: WebSurface) -> None:
    report = check_surface(slot)
    mesh = trimesh.Trimesh(slot.half_throw.vertices_mm, slot.half_throw.faces, process=False)
    assert report.volume_mm3 == pytest.approx(mesh.volume, rel=1e-9)
    assert (report.vertices, report.faces) == (len(mesh.vertices), len(mesh.faces))
    assert (report.bodies, report.cavities) == (1, 0)
    assert abs(report.web_volume_error_percent) < 0.02
    # two bores through one body: every closed half throw has the Euler number 2 - 2 x 2 holes
    assert mesh.euler_number == -2


def test_volume_and_moments_of_a_body_off_the_origin() -> None:
    mesh = mesh_of(Manifold.cube((2, 3, 4)).translate((1, 5, -2)))
    assert mesh.volume_mm3 == pytest.approx(24.0, rel=1e-14)
    assert mesh.first_moments_mm4 == pytest.approx(24.0 * np.array([2.0, 6.5, 0.0]), abs=1e-11)


def test_unit_tetrahedron_passes() -> None:
    mesh = SurfaceMesh(_CORNERS, _FACES)
    check_manifold(mesh)
    assert mesh.volume_mm3 == pytest.approx(1 / 6)


def test_open_surface_is_refused() -> None:
    with pytest.raises(CranktopoError, match="not watertight") as caught:
        check_manifold(SurfaceMesh(_CORNERS, _FACES[1:]))
    assert caught.value.code == ExitCode.CRITERION_NOT_MET
    # `extract` has an option for the iteration and none for the cells.
    assert "Optimise again on cells of another size" in caught.value.hint


def test_one_turned_face_is_refused() -> None:
    faces = _FACES.copy()
    faces[2] = faces[2, ::-1]
    with pytest.raises(CranktopoError, match="not oriented alike"):
        check_manifold(SurfaceMesh(_CORNERS, faces))


def test_inside_out_is_refused() -> None:
    with pytest.raises(CranktopoError, match="inside out"):
        check_manifold(SurfaceMesh(_CORNERS, _FACES[:, ::-1]))


def test_bodies_touching_in_a_vertex_are_refused() -> None:
    vertices, faces = _two((1.0, 0.0, 0.0))  # corner 4 of the second is corner 1 of the first
    faces = np.where(faces == 4, 1, faces)
    with pytest.raises(CranktopoError, match="touch in 1 single vertices"):
        check_manifold(SurfaceMesh(vertices, faces))


def test_bodies_touching_in_an_edge_are_refused() -> None:
    vertices, faces = _two((1.0, 0.0, 0.0))
    turned = vertices.copy()
    turned[4:] = [[1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 1]]
    faces = np.where(faces == 4, 1, np.where(faces == 6, 2, faces))
    with pytest.raises(CranktopoError, match="more than two faces at an edge"):
        check_manifold(SurfaceMesh(turned, faces))


def test_flat_face_is_refused() -> None:
    # A vertex on the edge 0-1 that only one of its faces uses: closed, but one face has no area.
    vertices = np.concatenate([_CORNERS, [[0.5, 0.0, 0.0]]])
    faces = np.array([[0, 2, 1], [0, 4, 3], [4, 1, 3], [1, 2, 3], [0, 3, 2], [0, 1, 4]])
    with pytest.raises(CranktopoError, match="1 degenerate faces"):
        check_manifold(SurfaceMesh(vertices, faces))


def test_a_dent_through_the_far_side_is_refused() -> None:
    """Closed and oriented all the same: only the crossing faces tell."""
    ball = trimesh.creation.icosphere(subdivisions=3, radius=10.0)
    vertices, faces = np.array(ball.vertices), np.array(ball.faces)
    check_self_intersection(SurfaceMesh(vertices, faces))
    top = int(vertices[:, 2].argmax())
    for depth, sound in ((-9.0, True), (-11.0, False)):
        vertices[top, 2] = depth
        mesh = SurfaceMesh(vertices.copy(), faces)
        check_manifold(mesh)
        if sound:
            check_self_intersection(mesh)
        else:
            with pytest.raises(CranktopoError, match="intersects itself near"):
                check_self_intersection(mesh)


def test_faces_that_rounding_makes_flat_are_taken_out() -> None:
    """A vertex 1e-7 mm off the straight edge of a block: in single precision it lies on it."""
    corners = np.array([[0, 0, 0], [40, 0, 0], [40, 30, 0], [0, 30, 0], [20, -1e-7, 0]], dtype=np.float64)
    block = Manifold.extrude(CrossSection([corners[[0, 4, 1, 2, 3], :2]]), 10.0)
    plain, sound = mesh_of(block), sound_mesh_of(block, 1e-3)
    assert sound.volume_mm3 == pytest.approx(12000.0)
    assert len(sound.faces) <= len(plain.faces)
    check_manifold(sound)
    with pytest.raises(CranktopoError, match="degenerate"):
        check_manifold(SurfaceMesh(*_with_flat_face()))
    vertices, faces = _with_flat_face()
    check_manifold(sound_mesh_of(solid_of(SurfaceMesh(vertices, faces)), 1e-3))


def _with_flat_face() -> tuple[np.ndarray, np.ndarray]:
    vertices = np.concatenate([_CORNERS, [[0.5, 0.0, 0.0]]])
    return vertices, np.array([[0, 2, 1], [0, 4, 3], [4, 1, 3], [1, 2, 3], [0, 3, 2], [0, 1, 4]])


def test_two_bodies_are_refused(slot: WebSurface) -> None:
    vertices, faces = _two((3.0, 0.0, 0.0))
    broken = dataclasses.replace(slot, half_throw=SurfaceMesh(vertices, faces))
    # Not "raise the resolution": that of `--resolution-mm` is the size of the cells.
    with pytest.raises(CranktopoError, match=r"2 separate bodies .* take smaller cells\."):
        check_surface(broken)


def test_hollow_counts_as_cavity_and_not_as_body() -> None:
    inner = 0.1 * _CORNERS + 0.1
    vertices, faces = np.concatenate([_CORNERS, inner]), np.concatenate([_FACES, _FACES[:, ::-1] + 4])
    mesh = SurfaceMesh(vertices, faces)
    np.testing.assert_allclose(np.sort(shell_volumes_mm3(mesh)), [-1e-3 / 6, 1 / 6])
    body, hollow = shells(mesh)
    np.testing.assert_array_equal(body.corners_mm, _CORNERS[_FACES])
    np.testing.assert_array_equal(hollow.corners_mm, inner[_FACES[:, ::-1]])


@pytest.mark.parametrize(("scale", "passes"), [(1.0049, True), (1.0051, False), (0.9949, False)])
def test_volume_check_is_half_a_percent(slot: WebSurface, scale: float, passes: bool) -> None:
    changed = dataclasses.replace(slot, volume_mm3=slot.target_volume_mm3 * scale)
    if passes:
        assert check_surface(changed).web_volume_error_percent == pytest.approx(100 * (scale - 1))
    else:
        with pytest.raises(CranktopoError, match=r"% of the density's"):
            check_surface(changed)


def test_stl_is_the_checked_surface(slot: WebSurface, tmp_path: Path) -> None:
    path = tmp_path / "web.stl"
    write_stl(path, slot.half_throw)
    assert os.listdir(tmp_path) == ["web.stl"]
    assert path.stat().st_size == 84 + 50 * len(slot.half_throw.faces)
    mesh = trimesh.load_mesh(path)
    assert mesh.is_watertight
    assert len(mesh.faces) == len(slot.half_throw.faces)
    assert len(mesh.vertices) == len(slot.half_throw.vertices_mm)
    assert mesh.volume == pytest.approx(slot.half_throw.volume_mm3, rel=1e-9)
    np.testing.assert_array_equal(mesh.bounds[:, 2], [0, 57])
    check_manifold(SurfaceMesh(np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces)))


def test_gmsh_reads_the_stl(slot: WebSurface, tmp_path: Path) -> None:
    path = tmp_path / "web.stl"
    write_stl(path, slot.half_throw)
    with cad_session("web") as gmsh:
        gmsh.merge(str(path))
        triangles = gmsh.model.mesh.getElements(2)[1][0]
        nodes = gmsh.model.mesh.getNodes()[0]
    assert len(triangles) == len(slot.half_throw.faces)
    assert len(nodes) == len(slot.half_throw.vertices_mm)


def test_unwritable_stl_is_a_clear_error(slot: WebSurface, tmp_path: Path) -> None:
    with pytest.raises(CranktopoError, match="cannot be written"):
        write_stl(tmp_path / "absent" / "web.stl", slot.half_throw)


def test_faces_are_turned_as_their_neighbours() -> None:
    """Of two bodies, one with a hollow, with a third of the faces turned, or two thirds: as they were."""
    outside, hollow = (trimesh.creation.icosphere(3, radius) for radius in (3.0, 1.0))
    hollow.invert()
    ring = trimesh.creation.torus(5.0, 1.0)
    ring.apply_translation([20.0, 0.0, 0.0])
    body = trimesh.util.concatenate([outside, hollow, ring])
    faces = np.array(body.faces, np.int64)
    some = np.random.default_rng(1).random(len(faces)) < 0.3
    mixed = np.where(some[:, None], faces[:, ::-1], faces)
    for given in (mixed, mixed[:, ::-1]):
        found = outward(SurfaceMesh(np.asarray(body.vertices), given))
        assert (np.sort(found.faces, axis=1) == np.sort(faces, axis=1)).all()
        assert found.as_trimesh().is_winding_consistent
        assert found.volume_mm3 == pytest.approx(body.volume, rel=1e-12)
    assert (shell_volumes_mm3(outward(SurfaceMesh(np.asarray(body.vertices), mixed))) < 0).sum() == 1
