"""Leavings of rounding in STL files: triangles without area, vertices a hair apart."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh

from cranktopo.base.errors import CranktopoError
from cranktopo.base.notes import redirected
from cranktopo.numerics.surfaces.files import read_stl


def stored(path: Path, triangles: np.ndarray) -> Path:
    """A binary STL of triangles (n, 3, 3) as they are, nothing joined."""
    flat = triangles.reshape(-1, 3)
    mesh = trimesh.Trimesh(flat, np.arange(len(flat)).reshape(-1, 3), process=False)
    path.write_bytes(trimesh.exchange.stl.export_stl(mesh))
    return path


def sphere() -> np.ndarray:
    return np.array(trimesh.creation.icosphere(subdivisions=2, radius=50.0).triangles)


def test_a_triangle_without_area_is_left_out(tmp_path: Path) -> None:
    triangles = sphere()
    a, b = triangles[0, 0], triangles[0, 1]
    path, lines = stored(tmp_path / "a.stl", np.concatenate([triangles, [[a, a, b]]])), list[str]()
    with redirected(lines.append):
        surface = read_stl(path, "body")
    assert lines == ["body: 1 triangle without area left out"]
    assert len(surface.faces) == len(triangles)
    assert surface.as_trimesh().is_watertight
    assert surface.volume_mm3 == pytest.approx(read_stl(stored(tmp_path / "b.stl", triangles)).volume_mm3)


def test_vertices_that_rounding_keeps_apart_are_joined(tmp_path: Path) -> None:
    triangles, lines = sphere(), list[str]()
    triangles[5] += 4e-6
    path = stored(tmp_path / "a.stl", triangles)
    assert not trimesh.load_mesh(path).is_watertight
    with redirected(lines.append):
        surface = read_stl(path, "body")
    assert surface.as_trimesh().is_watertight
    assert "body: 3 vertices within 1e-05 mm of others are joined" in lines[0]


def test_a_file_of_which_nothing_is_left_is_refused(tmp_path: Path) -> None:
    """A stored body cut off at any place, or emptied: the page of a resumed loop ended in exit 1."""
    a = [1.0, 2.0, 3.0]
    flat = stored(tmp_path / "flat.stl", np.array([[a, a, a]]))
    (tmp_path / "empty.stl").write_bytes(b"")
    whole = stored(tmp_path / "whole.stl", sphere()).read_bytes()
    (tmp_path / "cut.stl").write_bytes(whole[: len(whole) // 3])
    for path in (flat, tmp_path / "empty.stl", tmp_path / "cut.stl"):
        with pytest.raises(CranktopoError, match=r"body: (holds no triangles|cannot be read as STL)"):
            read_stl(path, "body")


def test_a_true_gap_stays_open(tmp_path: Path) -> None:
    triangles = sphere()
    triangles[5] += 0.01
    assert not read_stl(stored(tmp_path / "a.stl", triangles)).as_trimesh().is_watertight
    assert not read_stl(stored(tmp_path / "b.stl", sphere()[1:])).as_trimesh().is_watertight
