"""Surfaces whose triangles turn over when they are replaced: slivers at an outlet, chords of a drilling."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import redirected
from cranktopo.bodies.prisms import journal_halves
from cranktopo.design.loading import scene_from_dict
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of, self_intersections_mm
from cranktopo.numerics.tetrahedra import mesh
from tests.hostile.featured_engines import featured_engine

SIZE_MM = 7.2


@pytest.fixture
def outlet() -> SurfaceMesh:
    """Part of the surface of a random engine's web, cut out beside the outlet in its main journal."""
    with np.load(Path(__file__).parents[2] / "data" / "sliver_surface.npz") as data:
        found = SurfaceMesh(data["v"].astype(np.float64), data["f"].astype(np.int64))
    assert len(self_intersections_mm(found)) == 0, "the surface itself is sound"
    return found


def filled(surface: SurfaceMesh, size_mm: float = SIZE_MM) -> tuple[np.ndarray, np.ndarray]:
    points, cells = mesh.tetrahedralise(surface, size_mm, lambda at: np.full(len(at), size_mm), "outlet")
    corners = points[:, cells[:4]]
    sides = corners[:, 1:] - corners[:, :1]
    volume = np.einsum("ie,ie->e", sides[:, 0], np.cross(sides[:, 1], sides[:, 2], axis=0)) / 6
    lengths = [np.linalg.norm(corners[:, i] - corners[:, j], axis=0) for i, j in mesh.EDGES]
    assert (volume / np.max(lengths, axis=0) ** 3).min() > 1e-6, "no flat element"
    assert volume.sum() == pytest.approx(surface.volume_mm3, rel=5e-3)
    return points, cells


def test_small_triangles_are_joined_where_the_surface_cannot_be_meshed(
    outlet: SurfaceMesh, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mesh, "_JOINED", mesh._JOINED[-1:])
    told = list[str]()
    with redirected(told.append):
        filled(outlet)
    assert any("small triangles were joined within 0.036 mm" in line for line in told), (
        "what was done is told"
    )


@pytest.mark.slow
def test_long_triangles_are_cut_first_where_the_surface_cannot_be_meshed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The drilled main journal of a random engine, the half x >= 0, by elements as `evaluate` takes them."""
    scene = scene_from_dict(featured_engine(7))
    main, _ = journal_halves(scene)
    surface = mesh_of(main.trim_by_plane((1.0, 0.0, 0.0), 0.0))
    size_mm, told = 16.18, list[str]()
    with redirected(told.append):
        filled(surface, size_mm)
    assert not told, "the same shape"
    monkeypatch.setattr(mesh, "_JOINED", ())
    with pytest.raises(CranktopoError, match="3 tries"):
        filled(surface, size_mm)


def test_a_surface_that_no_try_meshes_is_refused_with_its_place(
    outlet: SurfaceMesh, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mesh, "_JOINED", ())
    with pytest.raises(CranktopoError, match=r"cannot be meshed near \(.*\) mm, 3 tries: ") as caught:
        filled(outlet)
    assert caught.value.code is ExitCode.SOLVER
    assert re.search(r"meets itself at \d+ places \(2 of 3\); .* \(1 of 3\)\.$", caught.value.message)


def test_reasons_are_told_once_each() -> None:
    failures = ["it meets itself at 20 places.", "a node is lost", "it meets itself at 7 places."]
    assert mesh.reasons_of(failures) == "it meets itself at 20 places (2 of 3); a node is lost (1 of 3)"
