"""The VTK file holds the kept cells, in their place, with positive volume."""

from __future__ import annotations

import os
from pathlib import Path

import meshio
import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.report.vtu import write_density_vtu

X = np.array([-3.0, -1.0, 0.5, 1.0])
Y = np.array([0.0, 2.0, 2.5])
Z = np.array([20.0, 21.0, 23.0, 26.0, 26.5])
SHAPE = (3, 2, 4)


def _cells() -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(2)
    return random.random(SHAPE), random.random(SHAPE) > 0.4


def _read(tmp_path: Path, keep: np.ndarray, **data: np.ndarray) -> meshio.Mesh:
    path = tmp_path / "density.vtu"
    write_density_vtu(path, X, Y, Z, data, keep)
    assert os.listdir(tmp_path) == ["density.vtu"]
    return meshio.read(path)


def _volumes(mesh: meshio.Mesh) -> np.ndarray:
    """Signed volume of each hexahedron from its corners 0, 1, 3, 4 (they are all boxes)."""
    p = mesh.points[mesh.cells_dict["hexahedron"]]
    return np.einsum("ij,ij->i", np.cross(p[:, 1] - p[:, 0], p[:, 3] - p[:, 0]), p[:, 4] - p[:, 0])


def test_volume_and_mean_agree(tmp_path: Path) -> None:
    density, keep = _cells()
    mesh = _read(tmp_path, keep, density=density)
    volume = np.einsum("i,j,k->ijk", np.diff(X), np.diff(Y), np.diff(Z))
    volumes, values = _volumes(mesh), mesh.cell_data_dict["density"]["hexahedron"]
    assert len(volumes) == keep.sum()
    assert volumes.min() > 0
    assert volumes.sum() == pytest.approx(volume[keep].sum(), rel=1e-14)
    assert volumes @ values == pytest.approx((density * volume)[keep].sum(), rel=1e-14)


def test_every_value_lies_in_its_cell(tmp_path: Path) -> None:
    density, keep = _cells()
    mesh = _read(tmp_path, keep, density=density, other=-density)
    centre = mesh.points[mesh.cells_dict["hexahedron"]].mean(axis=1)
    index = tuple(np.searchsorted(edges, centre[:, axis]) - 1 for axis, edges in enumerate((X, Y, Z)))
    np.testing.assert_array_equal(mesh.cell_data_dict["density"]["hexahedron"], density[index])
    np.testing.assert_array_equal(mesh.cell_data_dict["other"]["hexahedron"], -density[index])
    assert keep[index].all()


def test_corners_are_in_vtk_order(tmp_path: Path) -> None:
    keep = np.zeros(SHAPE, bool)
    keep[1, 0, 2] = True
    mesh = _read(tmp_path, keep, density=np.zeros(SHAPE))
    assert len(mesh.points) == 8
    # VTK file formats, hexahedron: 0-3 counter-clockwise at the bottom, 4-7 above them.
    x, y, z = (-1.0, 0.5), (0.0, 2.0), (23.0, 26.0)
    expected = [(x[i], y[j], z[k]) for k in (0, 1) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
    np.testing.assert_array_equal(mesh.points[mesh.cells_dict["hexahedron"][0]], expected)


def test_neighbours_share_points(tmp_path: Path) -> None:
    mesh = _read(tmp_path, np.ones(SHAPE, bool), density=np.zeros(SHAPE))
    assert len(mesh.points) == 4 * 3 * 5


def test_file_is_compressed(tmp_path: Path) -> None:
    edges = np.arange(41.0)
    density = np.zeros((40, 40, 40))
    write_density_vtu(tmp_path / "a.vtu", edges, edges, edges, {"density": density}, density == 0)
    assert (tmp_path / "a.vtu").stat().st_size < 40**3 * 8 * 8 / 3  # a third of the connectivity alone
    assert b"vtkZLibDataCompressor" in (tmp_path / "a.vtu").read_bytes()[:1000]


def test_wrong_shape_and_unwritable_file(tmp_path: Path) -> None:
    density, keep = _cells()
    with pytest.raises(ValueError, match=r"need the shape \(3, 2, 4\)"):
        write_density_vtu(tmp_path / "a.vtu", X, Y, Z, {"density": density.T}, keep)
    with pytest.raises(CranktopoError, match="cannot be written"):
        write_density_vtu(tmp_path / "absent" / "a.vtu", X, Y, Z, {"density": density}, keep)
