"""Bodies that were a crank before they were sheared, scaled or shaken: refused, with what and by how much."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from manifold3d import CrossSection, Manifold

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.numerics.surfaces.files import write_stl
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of
from cranktopo.tasks.crank_import.crank_finder import find_crank
from cranktopo.tasks.crank_import.distortion import Roundness, noise_named, remarks
from cranktopo.tasks.crank_import.half_body import FoundBody
from cranktopo.tasks.crank_import.mesh_halves import crank_of_mesh
from cranktopo.tasks.importing.faces import Faces, PlaneFace
from tests.physics.crank_import.test_crank_import import cylinder, synthetic


def throw(segments: int = 120) -> SurfaceMesh:
    """Two webs of 18 mm, a pin of 36 mm at 50 mm, main journals of 44 mm."""

    def bar(radius: float, low: float, high: float, y: float = 0.0) -> Manifold:
        return Manifold.cylinder(high - low, radius, circular_segments=segments).translate((0.0, y, low))

    web = CrossSection.batch_hull(
        [CrossSection.circle(r, 3 * segments // 4).translate((0.0, y)) for r, y in ((36, 0), (30, 50))]
    )
    webs = [Manifold.extrude(web, 18.0).translate((0.0, 0.0, z)) for z in (25.0, 83.0)]
    return mesh_of(
        webs[0] + webs[1] + bar(22.0, 0.0, 25.0) + bar(22.0, 101.0, 126.0) + bar(18.0, 43.0, 83.0, 50.0)
    )


def sheared(row: int, column: int, by: float) -> np.ndarray:
    matrix = np.eye(3)
    matrix[row, column] = by
    return matrix


def crank_of(mesh: SurfaceMesh, folder: Path) -> FoundBody:
    write_stl(folder / "body.stl", mesh)
    return crank_of_mesh(folder / "body.stl", None, "auto", "mm", folder)


@pytest.mark.parametrize(
    ("matrix", "told"),
    [
        (sheared(0, 2, 0.005), r"is sheared: no face stands square.*off by 0.286 deg \(at most 0.05 deg\)"),
        (sheared(1, 2, 0.002), r"is sheared: no face stands square.*off by 0.115 deg"),
        (sheared(2, 0, -0.005), r"is sheared: no face stands square.*off by 0.286 deg"),
        (
            sheared(0, 1, 0.005),
            r"a journal of 44 mm is oval by 0.055 mm \(at most 0.02 mm\): the body is sheared",
        ),
        (np.diag([1.01, 1.0, 1.0]), r"a journal of 44.\d+ mm is oval by 0.11 mm .*scaled in one direction"),
    ],
)
def test_a_sheared_or_scaled_body_is_refused(tmp_path: Path, matrix: np.ndarray, told: str) -> None:
    mesh = throw()
    with pytest.raises(CranktopoError, match=told) as raised:
        crank_of(SurfaceMesh(mesh.vertices_mm @ matrix.T, mesh.faces), tmp_path)
    assert raised.value.code == ExitCode.INVALID_INPUT
    assert "rotations and translations only" in raised.value.hint
    assert [file.name for file in tmp_path.iterdir()] == ["body.stl"]


@pytest.mark.parametrize("scatter_mm", [0.05, 0.1])
def test_noise_is_named(tmp_path: Path, scatter_mm: float) -> None:
    mesh = throw()
    noise = np.random.default_rng(1).normal(scale=scatter_mm, size=mesh.vertices_mm.shape)
    with pytest.raises(
        CranktopoError, match=r"corners of the triangles scatter by about .* \(at most 0.02 mm\)"
    ) as raised:
        crank_of(SurfaceMesh(mesh.vertices_mm + noise, mesh.faces), tmp_path)
    value = float(re.search(r"scatter by about ([\d.]+) mm", raised.value.message)[1])  # type: ignore[index]
    assert value == pytest.approx(scatter_mm, rel=0.35)
    assert raised.value.hint.startswith("Smooth the mesh")


def test_small_noise_is_named_where_a_later_step_fails(tmp_path: Path) -> None:
    mesh = throw(72)
    noise = np.random.default_rng(1).normal(scale=0.008, size=mesh.vertices_mm.shape)
    with pytest.raises(
        CranktopoError, match=r"looks like no crank: .*; corners .* by about 0.0\d+ mm, which may be"
    ):
        crank_of(SurfaceMesh(mesh.vertices_mm + noise, mesh.faces), tmp_path)
    told = ("corners of the triangles scatter by 0.004 mm about the journals: no dimension is better",)
    failed = CranktopoError("throw 1: 4 bodies, not one.", hint="Join them.")
    assert re.fullmatch(
        r"throw 1: 4 bodies, not one; corners of the triangles scatter by \S+ mm about the journals, which "
        "may be why.",
        noise_named(failed, told).message,
    )
    assert noise_named(failed, ("step of 30 x 4 mm",)) is failed


def test_an_undistorted_body_is_taken(tmp_path: Path) -> None:
    assert not crank_of(throw(), tmp_path).crank.unread


def test_noise_and_draft_within_the_limits_are_told() -> None:
    """The webs' largest face leans by 3 deg; a smaller square one keeps the body from being sheared."""
    along, angle = np.array([0.0, 0.0, 1.0]), np.radians(3.0)
    drafted = PlaneFace(np.array([0.0, np.sin(angle), np.cos(angle)]), np.zeros(3), 900.0)
    square = PlaneFace(along, np.zeros(3), 400.0)
    quiet, noisy = (Roundness(40.0, off, 0.0, 0.0, off) for off in (1e-4, 0.004))
    assert remarks(Faces((), (square,), (), ()), [quiet], along) == []
    assert remarks(Faces((), (square, drafted), (), ()), [quiet, noisy], along) == [
        "faces of the webs lean by 3 deg, as draft does",
        "corners of the triangles scatter by 0.004 mm about the journals: no dimension is better",
    ]


def leaning(degrees: float) -> Faces:
    """Two throws of exact faces and a pin that leans."""
    pin = cylinder(18.0, (136.0, 172.0), y=-40.0)
    own = synthetic()
    angle = np.radians(degrees)
    pins = [one for one in own.cylinders if one.point_mm[1] >= 0]
    object.__setattr__(pin, "axis", np.array([0.0, np.sin(angle), np.cos(angle)]))
    return Faces((*pins, pin), (), (), ())


def test_a_leaning_journal_of_exact_faces_is_refused() -> None:
    with pytest.raises(CranktopoError, match=r"a journal of 36 mm leans by 0.3 deg .*\(at most 6e-06 deg\)"):
        find_crank(leaning(0.3), "crank")
    assert len(find_crank(leaning(0.0), "crank").pins) == 2


def test_a_body_of_splines_is_refused_with_what_made_them() -> None:
    with pytest.raises(
        CranktopoError, match=r"no face is a full cylinder, and 9 are B-spline surfaces, as shear"
    ):
        find_crank(Faces((), (), (), ("BSpline surface",) * 9), "crank")
