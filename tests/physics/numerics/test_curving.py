"""Curved elements that fold when their edge nodes go to the surface, and what is done about them."""

from __future__ import annotations

import re

import numpy as np
import pytest
from numpy.typing import NDArray
from skfem import Basis, ElementTetP2, MeshTet2

from cranktopo.base.errors import CranktopoError
from cranktopo.base.notes import redirected
from cranktopo.bodies.mesh import solid_mesh as meshing
from cranktopo.design.loading import load_scene
from cranktopo.numerics.tetrahedra.elasticity import assemble
from cranktopo.numerics.tetrahedra.mesh import EDGES, TetMesh, straighten_folded
from tests.physics.fea.evaluation_cases import mikron_with

Array = NDArray[np.float64]


def pair() -> tuple[Array, NDArray[np.int64]]:
    """Two straight ten-node tetrahedra that share the face 0 1 2."""
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0.3, 0.3, -1]]).T
    tets = np.array([[0, 1, 2, 3], [1, 0, 2, 4]]).T
    points, cells, numbers = list(corners.T), [], {}
    for tet in tets.T:
        edges = []
        for a, b in EDGES:
            key = tuple(sorted((int(tet[a]), int(tet[b]))))
            if key not in numbers:
                numbers[key] = len(points)
                points.append((corners[:, key[0]] + corners[:, key[1]]) / 2)
            edges.append(numbers[key])
        cells.append([*tet, *edges])
    return np.array(points).T, np.array(cells, dtype=np.int64).T


def least_jacobian(points: Array, cells: NDArray[np.int64]) -> float:
    """Smallest Jacobian over a fine set of points, by scikit-fem's own mapping."""
    basis = Basis(MeshTet2(points, cells), ElementTetP2(), intorder=6)
    return float(basis.mapping.detDF(basis.X).min())


def test_sound_elements_stay() -> None:
    points, cells = pair()
    points[:, cells[9, 0]] += [0.02, -0.01, 0.03]
    kept, count = straighten_folded(points, cells)
    assert count == 0
    assert np.array_equal(kept, points)


def test_a_folded_element_is_straightened() -> None:
    """An edge node pushed through the opposite face; the element below bends with it and is sound."""
    points, cells = pair()
    straight = points.copy()
    node = cells[9, 0]  # between corners 2 and 3 of the first element, its own
    points[:, node] += [0.5, -0.9, -0.9]
    assert least_jacobian(points, cells) < 0
    kept, count = straighten_folded(points, cells)
    assert count == 1
    assert np.allclose(kept[:, node], straight[:, node])
    assert least_jacobian(kept, cells) > 0


def test_only_the_folded_element_moves() -> None:
    points, cells = pair()
    other = cells[9, 1]
    points[:, other] += [0.02, 0.0, 0.02]
    points[:, cells[9, 0]] += [0.5, -0.9, -0.9]
    kept, count = straighten_folded(points, cells)
    assert count == 1
    assert np.array_equal(kept[:, other], points[:, other])


def test_assembly_refuses_an_inverted_element() -> None:
    points, cells = pair()
    assemble(TetMesh(points, cells, mirrored=False), 1.0, 0.3)
    points[:, cells[9, 0]] += [0.5, -0.9, -0.9]
    with pytest.raises(CranktopoError, match="inverted"):
        assemble(TetMesh(points, cells, mirrored=False), 1.0, 0.3)


def test_flat_elements_are_refused() -> None:
    points, cells = pair()
    points[:, cells[3, 0]] = [0.2, 0.2, 0.0]
    with pytest.raises(CranktopoError, match="flat or inverted"):
        straighten_folded(points, cells)


def test_a_coarse_throw_has_some(monkeypatch: pytest.MonkeyPatch) -> None:
    """Large elements on small fillets fold; the mesh that is handed out has none."""
    found: list[tuple[float, int, float]] = []

    def spied(points: Array, cells: NDArray[np.int64]) -> tuple[Array, int]:
        kept, count = straighten_folded(points, cells)
        found.append((least_jacobian(points, cells), count, least_jacobian(kept, cells)))
        return kept, count

    monkeypatch.setattr("cranktopo.numerics.tetrahedra.cad_mesh.straighten_folded", spied)
    meshing.mesh_throw(mikron_with(), 15.0, graded=False)
    before, count, after = found[0]
    assert before < 0 < after
    assert count > 0


def test_elements_too_large_for_a_thin_part_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """Both algorithms for the surface leave there elements that cut across each other, at every size."""
    import gmsh

    tried, reasons = [], ("overlapping facets) on surface 2 surface 4", "intersection at point (1,2,3))")

    def generate(_: int) -> None:
        tried.append((gmsh.option.getNumber("Mesh.Algorithm"), gmsh.model.mesh.field.getString(1, "F")))
        raise Exception(f"Invalid boundary mesh ({reasons[len(tried) % 2]}")

    monkeypatch.setattr(gmsh.model.mesh, "generate", generate)
    with pytest.raises(CranktopoError, match=r"variant-1: no mesh with .* 21, 16.8 or 13.4 mm") as told:
        meshing.mesh_throw(load_scene("opposed-piston-variant-1"), 21.0)
    assert "smaller element size" in told.value.hint
    assert len(set(tried)) == len(tried) == 6
    assert "Invalid boundary mesh (intersection at point (1,2,3)) (3 of 6)" in told.value.message
    assert re.search(r"on surface 2 surface 4 near \(.*\) mm \(3 of 6\)\.$", told.value.message)


def test_smaller_elements_are_taken_where_the_asked_ones_make_no_mesh(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The size that is told, and all that follows from it, is that of the mesh."""
    import gmsh

    real, tried, told = gmsh.model.mesh.generate, list[int](), list[str]()

    def generate(dimension: int) -> None:
        tried.append(dimension)
        if len(tried) <= 2:
            raise Exception("Invalid boundary mesh")
        real(dimension)

    monkeypatch.setattr(gmsh.model.mesh, "generate", generate)
    with redirected(told.append):
        found = meshing.mesh_throw(mikron_with(), 15.0, graded=False)
    monkeypatch.undo()
    wanted = meshing.mesh_throw(mikron_with(), 12.0, graded=False)
    assert found.element_size_mm == pytest.approx(12.0)
    assert found.mesh.points_mm.shape == wanted.mesh.points_mm.shape
    assert any("no mesh with elements of 15 mm; taken are 12 mm" in line for line in told)
