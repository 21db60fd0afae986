"""Products and solvers of elastic bodies against the same matrix assembled by scikit-fem."""

from __future__ import annotations

from dataclasses import replace
from unittest.mock import patch

import numpy as np
import pytest
from scipy.sparse import csr_matrix
from skfem import Basis, ElementTetP2, ElementVector, asm
from skfem.models.elasticity import linear_elasticity

from cranktopo.base.errors import CranktopoError
from cranktopo.numerics.tetrahedra import solver, symmetric_blocks
from cranktopo.numerics.tetrahedra.connections import connections
from cranktopo.numerics.tetrahedra.elasticity import STIFFNESS_ORDER, Elasticity, assemble, lame_constants_MPa
from cranktopo.numerics.tetrahedra.solver import cholesky, solve_directly
from tests.unit.numerics.cubes import cube_mesh

YOUNGS, POISSON = 210.0, 0.3


@pytest.fixture(scope="module")
def bent() -> Elasticity:
    cube = cube_mesh(3)
    bent_mm = cube.points_mm + 0.05 * np.sin(2.0 * cube.points_mm[[1, 2, 0]])
    return assemble(replace(cube, points_mm=bent_mm), YOUNGS, POISSON)


def held(body: Elasticity) -> np.ndarray:
    return (3 * np.flatnonzero(body.mesh.doflocs[2] < 0.06)[:, None] + np.arange(3)).ravel()


@pytest.mark.parametrize("columns", [1, 2, 3, 4, 5, 9])
def test_product_is_that_of_scikit_fem(bent: Elasticity, columns: int) -> None:
    basis = Basis(bent.mesh, ElementVector(ElementTetP2()), intorder=STIFFNESS_ORDER)
    theirs = asm(linear_elasticity(*lame_constants_MPa(YOUNGS, POISSON)), basis).tocsr()
    place = np.empty(theirs.shape[0], dtype=int)
    for axis in range(3):
        nodes = np.concatenate([basis.nodal_dofs[axis], basis.edge_dofs[axis]])
        place[axis::3] = nodes
    field = np.random.default_rng(0).standard_normal((bent.nodes_mm.size, columns))
    found = bent.stiffness @ field
    np.testing.assert_allclose(found, (theirs[place][:, place] @ field), atol=1e-12 * np.abs(found).max())
    np.testing.assert_allclose(found, bent.stiffness.tocsr() @ field, atol=1e-12 * np.abs(found).max())
    np.testing.assert_allclose(found[:, 0], bent.stiffness @ field[:, 0], atol=1e-12 * np.abs(found).max())


def test_what_two_threads_do_at_once_shares_nothing(
    bent: Elasticity, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Rows of blocks of a product, and elements of an assembly: a sum that both write to may lose a part."""
    monkeypatch.setattr(symmetric_blocks, "_FEW_ROWS", 10)
    matrix = replace(bent.stiffness)
    first, middle = matrix._apart
    assert 0 < first < middle < len(matrix.order)
    assert matrix.column[: matrix.start[first]].max() < middle
    field = np.random.default_rng(5).standard_normal((bent.nodes_mm.size, 3))
    np.testing.assert_allclose(
        matrix @ field, matrix.tocsr() @ field, atol=1e-12 * np.abs(field).max() * YOUNGS
    )
    connected = connections(cube_mesh(4))
    one, other, between = connected.apart
    assert min(map(len, (one, other, between))) > 0
    assert not set(connected.cells[:, one].ravel()) & set(connected.cells[:, other].ravel())
    every = np.sort(np.concatenate([one, other, between]))
    np.testing.assert_array_equal(every, np.arange(connected.cells.shape[1]))


def test_product_in_single_precision(bent: Elasticity) -> None:
    matrix = bent.stiffness
    field = np.random.default_rng(3).standard_normal((bent.nodes_mm.size, 4))
    found, expected = np.zeros(field.shape, np.float32), np.zeros(field.shape)
    matrix.single.add_product(field.astype(np.float32), found, -2.0)
    matrix.add_product(field, expected, -2.0)
    assert 0 < np.abs(found - expected).max() < 1e-5 * np.abs(expected).max()


def test_two_levels_find_what_the_factorisation_finds(bent: Elasticity) -> None:
    """Large and small loads, one of them nothing, on held unknowns as well."""
    forces = np.random.default_rng(1).standard_normal((bent.nodes_mm.size, 3)) * (1.0, 1e-10, 0.0)
    found = []
    for most in (0, 10**9):
        with patch.object(solver, "DIRECT_LIMIT", most):
            found.append(bent.equations.solver(held(bent))(forces))
    for one, other in zip(found[0].T, found[1].T, strict=True):
        np.testing.assert_allclose(one, other, atol=1e-7 * np.abs(other).max())
    assert (found[0][held(bent)] == 0).all()
    assert (found[0][:, 2] == 0).all()


def test_body_that_nothing_holds_is_refused(bent: Elasticity) -> None:
    forces = np.ones((bent.nodes_mm.size, 1))
    with pytest.raises(CranktopoError, match=r"factorisation|residual"):
        bent.equations.solver(np.zeros(0, dtype=int))(forces)


def test_same_numbers_every_time(bent: Elasticity) -> None:
    forces = np.random.default_rng(2).standard_normal((bent.nodes_mm.size, 2))
    one, other = (bent.equations.solver(held(bent))(forces) for _ in range(2))
    np.testing.assert_array_equal(one, other)


def test_factorisation_takes_either_triangle() -> None:
    matrix = np.array([[4.0, 1.0, 0.0], [1.0, 3.0, -1.0], [0.0, -1.0, 2.0]])
    loads = np.array([[1.0, 0.0], [2.0, 1.0], [3.0, 0.0]])
    expected = np.linalg.solve(matrix, loads)
    np.testing.assert_allclose(solve_directly(csr_matrix(matrix), loads), expected, rtol=1e-14)
    np.testing.assert_allclose(cholesky(csr_matrix(np.triu(matrix)))(loads), expected, rtol=1e-14)
