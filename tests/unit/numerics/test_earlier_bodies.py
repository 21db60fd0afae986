"""Solves that begin at the fields of a body before it moved: the same answer, in fewer cycles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from unittest.mock import patch

import numpy as np
import pytest
import scipy.sparse as sp

from cranktopo.base.arrays import Array
from cranktopo.numerics.tetrahedra import solver
from cranktopo.numerics.tetrahedra.earlier_bodies import EarlierBodies
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, assemble
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from tests.unit.numerics.cubes import cube_mesh


@pytest.fixture(scope="module")
def mesh() -> TetMesh:
    return cube_mesh(5)


def body(mesh: TetMesh, longer: float, earlier: EarlierBodies | None = None) -> Elasticity:
    stretched = mesh.points_mm * np.array([[1.0], [1.0 + longer], [1.0 + longer / 3]])
    return assemble(replace(mesh, points_mm=stretched), 2e5, 0.3, earlier=earlier)


def loads(of: Elasticity) -> Array:
    """Columns 1e11 apart, as a moment and a unit load are."""
    end = of.nodes_mm[1] > of.nodes_mm[1].max() - 1e-9
    forces = np.zeros((of.nodes_mm.size, 2))
    forces[2::3, 0], forces[0::3, 1] = 1e6 * end, 1e-5 * end * of.nodes_mm[2]
    return forces


def held(of: Elasticity) -> np.ndarray:
    return (3 * np.flatnonzero(of.nodes_mm[1] < 1e-9)[:, None] + np.arange(3)).ravel()


def solved(of: Elasticity) -> tuple[Array, int]:
    """Return the fields of the loads, and how many cycles they took."""
    cycles = 0
    cycle_of = solver.Equations.two_level_cycle

    def counted(self: solver.Equations, held: np.ndarray) -> object:
        cycle = cycle_of(self, held)

        def one(residual: Array) -> Array:
            nonlocal cycles
            cycles += 1
            return cycle(residual)

        return one

    with patch.object(solver, "DIRECT_LIMIT", 0), patch.object(solver.Equations, "two_level_cycle", counted):
        return of.equations.solver(held(of))(loads(of)), cycles


def test_a_moved_body_has_the_same_fields_in_fewer_cycles(mesh: TetMesh) -> None:
    earlier = EarlierBodies()
    solved(body(mesh, 0.0, earlier))
    once, one_known = solved(body(mesh, 0.01, earlier))
    fresh, from_zero = solved(body(mesh, 0.01))
    assert (np.abs(once - fresh).max(axis=0) < 1e-7 * np.abs(fresh).max(axis=0)).all()
    assert one_known < from_zero
    _, two_known = solved(body(mesh, 0.02, earlier))
    assert two_known < one_known, "two bodies of a straight drag tell the third"


def test_every_column_begins_near_its_answer(mesh: TetMesh) -> None:
    earlier = EarlierBodies()
    before, _ = solved(body(mesh, 0.0, earlier))
    moved = body(mesh, 0.01)
    fields, _ = solved(moved)
    matrix = moved.stiffness
    scaled = loads(moved)[matrix.unknowns] / matrix.root
    start = earlier.start(matrix, held(moved), scaled)
    assert start is not None
    off = np.abs(start / matrix.root - fields[matrix.unknowns]).max(axis=0)
    assert (off < 0.25 * np.abs(before - fields).max(axis=0)).all()


def test_what_is_held_otherwise_begins_at_zero(mesh: TetMesh) -> None:
    earlier, moved = EarlierBodies(), body(mesh, 0.01)
    solved(body(mesh, 0.0, earlier))
    scaled = loads(moved)[moved.stiffness.unknowns]
    assert earlier.start(moved.stiffness, held(moved)[3:], scaled) is None


def test_connections_are_found_once_and_give_the_same_matrix(mesh: TetMesh) -> None:
    """Also where the cells number the nodes in another order than the matrix does."""
    random = np.random.default_rng(3)
    number = random.permutation(mesh.points_mm.shape[1])
    points = np.empty_like(mesh.points_mm)
    points[:, number] = mesh.points_mm
    other = replace(mesh, points_mm=points, cells=number[mesh.cells])
    earlier = EarlierBodies()
    body(other, 0.0, earlier)
    known = earlier.connections
    moved, fresh = body(other, 0.02, earlier), body(other, 0.02)
    assert earlier.connections is known
    assert known is not None
    assert known.body.doflocs.tobytes() != moved.mesh.doflocs.tobytes(), "the first body stays where it is"
    assert moved.mesh.doflocs.tobytes() == fresh.mesh.doflocs.tobytes()
    for name in ("order", "start", "column", "value", "root"):
        assert getattr(moved.stiffness, name).tobytes() == getattr(fresh.stiffness, name).tobytes(), name
    assert (moved.equations.linear != fresh.equations.linear).nnz == 0


def test_the_linear_level_of_a_body_before_serves_until_it_is_too_far(mesh: TetMesh) -> None:
    """A far body takes many cycles with it, has its right fields, and lets the next one make its own."""
    made: list[int] = []
    cholesky = solver.cholesky

    def counted(matrix: sp.spmatrix) -> Callable[[Array], Array]:
        made.append(matrix.shape[0])
        return cholesky(matrix)

    earlier = EarlierBodies()
    with patch.object(solver, "cholesky", counted):
        solved(body(mesh, 0.0, earlier))
        solved(body(mesh, 0.01, earlier))
        assert len(made) == 1, "the second body is near"
        far, _ = solved(body(mesh, 8.0, earlier))
        assert len(made) == 1
        fresh, _ = solved(body(mesh, 8.0))
        assert np.abs(far - fresh).max(axis=0) == pytest.approx(0.0, abs=1e-5 * np.abs(fresh).max())
        made.clear()
        (key,) = earlier._cycles
        earlier.judge_coarse_level(np.frombuffer(key, dtype=np.intp), 10**6)  # a second solve says the same
        solved(body(mesh, 8.1, earlier))
        assert len(made) == 1, "the far body had it forgotten"


def test_a_solved_column_costs_no_further_cycles(mesh: TetMesh) -> None:
    """One column begins at its answer; its cycles are spent on the others alone, which end as without it."""
    model = body(mesh, 0.0)
    matrix, fixed = model.stiffness, held(model)
    own = np.isin(matrix.unknowns, fixed)
    given = loads(model)[matrix.unknowns] / matrix.root
    given[own] = 0.0
    cycle, widths = model.equations.two_level_cycle(fixed), []

    def counted(residual: Array) -> Array:
        widths.append(residual.shape[1])
        return cycle(residual)

    whole, cycles = solver._conjugate_gradients(matrix, own, given, cycle, 1e-10)
    start = np.zeros_like(given)
    start[:, 0] = whole[:, 0]
    found, after = solver._conjugate_gradients(matrix, own, given, counted, 1e-8, start)
    assert widths == [given.shape[1] - 1] * after
    assert after <= cycles
    assert found[:, 0].tolist() == whole[:, 0].tolist()
    assert np.linalg.norm(found - whole, axis=0) == pytest.approx(0.0, abs=1e-6 * np.linalg.norm(whole))
