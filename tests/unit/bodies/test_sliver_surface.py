"""A surface whose slivers turn triangles over when it is remeshed: the rounded outlet of an oil drilling."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import redirected
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, self_intersections_mm
from cranktopo.numerics.tetrahedra import mesh

SIZE_MM = 7.2


@pytest.fixture
def outlet() -> SurfaceMesh:
    """Part of the surface of a random engine's web, cut out beside the outlet in its main journal."""
    with np.load(Path(__file__).parents[2] / "data" / "sliver_surface.npz") as data:
        found = SurfaceMesh(data["v"].astype(np.float64), data["f"].astype(np.int64))
    assert len(self_intersections_mm(found)) == 0, "the surface itself is sound"
    return found


def filled(surface: SurfaceMesh) -> tuple[np.ndarray, np.ndarray]:
    return mesh.tetrahedralise(surface, SIZE_MM, lambda at: np.full(len(at), SIZE_MM), "outlet")


def test_small_triangles_are_joined_where_the_surface_cannot_be_meshed(outlet: SurfaceMesh) -> None:
    told = list[str]()
    with redirected(told.append):
        points, cells = filled(outlet)
    corners = points[:, cells[:4]]
    sides = corners[:, 1:] - corners[:, :1]
    volume = np.einsum("ie,ie->e", sides[:, 0], np.cross(sides[:, 1], sides[:, 2], axis=0)) / 6
    assert volume.min() > 0
    assert volume.sum() == pytest.approx(outlet.volume_mm3, rel=5e-3)
    assert any("small triangles were joined within 0.0" in line for line in told), "what was done is told"


def test_a_surface_that_no_try_meshes_is_refused_with_its_place(
    outlet: SurfaceMesh, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mesh, "_JOINED", ())
    with pytest.raises(CranktopoError, match=r"cannot be meshed near \(.*\) mm, 3 tries: ") as caught:
        filled(outlet)
    assert caught.value.code is ExitCode.SOLVER
