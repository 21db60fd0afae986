"""A remeshed surface that meets itself is a failed try: the mesher of tetrahedra may not survive it."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from cranktopo.base.errors import CranktopoError
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.numerics.tetrahedra import mesh as tetrahedra


def ball(x_mm: float = 0.0) -> SurfaceMesh:
    found = trimesh.creation.icosphere(subdivisions=3, radius=10.0)
    return SurfaceMesh(np.add(found.vertices, (x_mm, 0.0, 0.0)), np.asarray(found.faces, np.int64))


def both(one: SurfaceMesh, other: SurfaceMesh) -> SurfaceMesh:
    vertices = np.vstack([one.vertices_mm, other.vertices_mm])
    return SurfaceMesh(vertices, np.vstack([one.faces, other.faces + len(one.vertices_mm)]))


def test_balls_that_pierce_each_other_are_never_filled(monkeypatch: pytest.MonkeyPatch) -> None:
    pierced, filled = both(ball(), ball(9.0)), list[SurfaceMesh]()
    monkeypatch.setattr(tetrahedra, "_prepared", lambda surface, *_: surface)
    monkeypatch.setattr(tetrahedra, "_resurfaced", lambda surface, *_: surface)
    monkeypatch.setattr(tetrahedra, "_inside", lambda surface, *_: filled.append(surface))
    with pytest.raises(CranktopoError, match=r"15 tries: the remeshed surface meets itself at \d+ places"):
        tetrahedra.tetrahedralise(pierced, 3.0, lambda points: np.full(len(points), 3.0), "balls")
    assert not filled


def test_a_ball_is_filled() -> None:
    points, cells = tetrahedra.tetrahedralise(ball(), 4.0, lambda at: np.full(len(at), 4.0), "ball")
    corners = points[:, cells[:4]]
    edges = corners[:, 1:] - corners[:, :1]
    volume = np.abs((edges[:, 0] * np.cross(edges[:, 1], edges[:, 2], axis=0)).sum(axis=0)).sum() / 6
    assert volume == pytest.approx(ball().volume_mm3, rel=5e-3)
