"""Order of convergence of the evaluation's elements on an exact solution, and on the Mikron throw.

The exact solution is a sum of plane waves u = sum a sin(k.x + p): its body force follows in closed form from
Navier's equation, -(lambda + mu) grad div u - mu laplace u, and no axis or plane of it is special.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.typing import NDArray
from skfem import Basis, ElementTetP2, MeshTet

from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, assemble
from cranktopo.numerics.tetrahedra.mesh import TetMesh, quadratic
from cranktopo.numerics.tetrahedra.solver import largest_eigenvalue
from cranktopo.tasks.throw_fea.throw_stiffness import condensed_stiffness
from tests.physics.fea.evaluation_cases import mikron_with

Array = NDArray[np.float64]
YOUNGS, POISSON = 2.0, 0.3
LAME, SHEAR = YOUNGS * POISSON / (1 + POISSON) / (1 - 2 * POISSON), YOUNGS / 2 / (1 + POISSON)


@dataclass(frozen=True)
class Wave:
    amplitude: Array
    number: Array
    phase: float

    def angle(self, x: Array) -> Array:
        return np.tensordot(self.number, x, 1) + self.phase


WAVES = (
    Wave(np.array([1.0, -0.4, 0.3]), np.array([2.1, 0.7, -1.3]), 0.4),
    Wave(np.array([0.2, 0.8, -0.6]), np.array([-0.9, 1.9, 1.1]), 1.1),
)


def displacement(x: Array) -> Array:
    return np.asarray(sum(np.multiply.outer(w.amplitude, np.sin(w.angle(x))) for w in WAVES))


def gradient(x: Array) -> Array:
    """du_i / dx_j."""
    parts = [np.multiply.outer(np.outer(w.amplitude, w.number), np.cos(w.angle(x))) for w in WAVES]
    return np.asarray(sum(parts))


def body_force(x: Array) -> Array:
    total = np.zeros_like(x)
    for w in WAVES:
        spread = (LAME + SHEAR) * (w.amplitude @ w.number) * w.number
        shear = SHEAR * (w.number @ w.number) * w.amplitude
        total += np.multiply.outer(spread + shear, np.sin(w.angle(x)))
    return total


def cube(cells: int, bend: float) -> TetMesh:
    """Ten-node tetrahedra on the unit cube, its inside and edges bent by a smooth map."""
    steps = np.linspace(0, 1, cells + 1)
    linear = MeshTet.init_tensor(steps, steps, steps)
    corners = linear.t.copy()
    sides = linear.p[:, corners[1:]] - linear.p[:, corners[:1]]
    left = np.linalg.det(sides.transpose(2, 0, 1)) < 0
    corners[:2, left] = corners[1::-1, left]
    points, cells = quadratic(linear.p.T, corners.T.astype(np.int64))
    points = points + bend * np.sin(2.0 * points[[1, 2, 0]] + points[[2, 0, 1]])
    return TetMesh(points, cells, mirrored=False)


def solved(model: Elasticity, outside: NDArray[np.intp]) -> Array:
    """Displacement of all unknowns: exact on the outside, body force within."""
    basis = Basis(model.mesh, ElementTetP2(), intorder=6)
    force = np.zeros(model.nodes_mm.size)
    density = body_force(np.asarray(basis.global_coordinates()))
    for axis in range(3):
        values = np.stack(
            [(np.asarray(phi[0]) * density[axis] * basis.dx).sum(axis=1) for phi in basis.basis]
        )
        np.add.at(force, 3 * basis.element_dofs + axis, values)
    held = (3 * outside[:, None] + np.arange(3)).ravel()
    u = np.zeros(force.size)
    u[held] = displacement(model.nodes_mm).T.ravel()[held]
    return u + model.equations.solver(held)((force - model.stiffness @ u)[:, None])[:, 0]


def errors(cells: int, bend: float) -> tuple[float, float]:
    """Relative errors of a solution in the L2 norm of displacement and in the energy norm."""
    model = assemble(cube(cells, bend), YOUNGS, POISSON)
    u = solved(model, _outside(model))
    basis = Basis(model.mesh, ElementTetP2(), intorder=6)
    x = np.asarray(basis.global_coordinates())
    parts = [basis.interpolate(u[axis::3]) for axis in range(3)]
    missed = np.stack([np.asarray(p) for p in parts]) - displacement(x)
    slope = np.stack([p.grad for p in parts]) - gradient(x)
    length = (missed**2).sum(axis=0) * basis.dx, (displacement(x) ** 2).sum(axis=0) * basis.dx
    energy = _energy(slope) * basis.dx, _energy(gradient(x)) * basis.dx
    in_length, in_energy = (float(np.sqrt(a.sum() / b.sum())) for a, b in (length, energy))
    return in_length, in_energy


def _energy(slope: Array) -> Array:
    strain = (slope + slope.swapaxes(0, 1)) / 2
    return np.asarray(LAME * np.trace(strain) ** 2 + 2 * SHEAR * (strain**2).sum(axis=(0, 1)))


def _outside(model: Elasticity) -> NDArray[np.intp]:
    basis = Basis(model.mesh, ElementTetP2(), intorder=2)
    return np.asarray(basis.get_dofs().all(), dtype=np.intp)


@pytest.mark.parametrize(("bend", "bounds"), [(0.0, (1e-4, 4e-3)), (0.08, (1.2e-4, 4.5e-3))])
def test_orders_on_an_exact_solution(bend: float, bounds: tuple[float, float]) -> None:
    """Straight and curved elements: third order in displacement, second in energy."""
    found = np.array([errors(cells, bend) for cells in (2, 4, 8)])
    orders = -np.diff(np.log2(found), axis=0)
    assert (orders[-1] > (2.8, 1.9)).all(), orders
    assert (found[-1] < bounds).all(), found


@pytest.mark.slow
def test_order_on_the_mikron_throw() -> None:
    """With fillets: three meshes, the finest within 0.1 % of a reference of four digits.

    The order scatters with the meshes: 1.5 (torsion free), 1.6 (held) and 2.0 (pinned) on these; frontal
    surface meshes of the same sizes gave 1.8 to 2.0.
    """
    scene = mikron_with()
    levels = []
    for size in (6.3, 4.2, 2.8):
        found = condensed_stiffness(mesh_throw(scene, size), scene, size, 0.0)
        levels.append([found.torsion["free"], found.torsion["held"], found.bending["pinned"]])
    coarse, middle, fine = np.array(levels)
    orders = np.log((coarse - middle) / (middle - fine)) / np.log(1.5)
    assert (orders > 1.4).all(), orders
    assert fine == pytest.approx([141.2e3, 194.3e3, 230.2e3], rel=1e-3)


def test_linear_elements_are_the_quadratic_ones_held_to_linear_fields() -> None:
    """Same curved elements, same quadrature: their matrix is the Galerkin projection of the quadratic one."""
    mesh = cube(2, 0.08)
    linear, quadratic_ = (assemble(mesh, YOUNGS, POISSON, order) for order in (1, 2))
    assert linear.order == 1
    assert linear.volume_mm3 == pytest.approx(quadratic_.volume_mm3, rel=1e-12)
    p = sp.kron(quadratic_.equations.prolongation, sp.eye(3))
    projected = (p.T @ quadratic_.stiffness.tocsr() @ p).toarray()
    np.testing.assert_allclose(
        linear.stiffness.tocsr().toarray(), projected, atol=1e-12 * np.abs(projected).max()
    )
    np.testing.assert_array_equal(linear.nodes_mm, quadratic_.nodes_mm[:, : linear.nodes_mm.shape[1]])


def testlargest_eigenvalue_of_one_bad_element_is_found() -> None:
    """Three stiffly tied unknowns in a long chain: 1 + 2 * 0.8 = 2.6 with the chain's own 2 almost nothing.

    A smoother scaled by less than the largest eigenvalue diverges.
    """
    count = 100_000
    chain = sp.diags([-np.ones(count - 1), 2 * np.ones(count), -np.ones(count - 1)], [-1, 0, 1])
    tied = sp.lil_matrix((count, count))
    tied[5000:5003, 5000:5003] = 1e6 * (0.2 * np.eye(3) + 0.8)
    matrix = (chain + tied).tocsr()
    found = largest_eigenvalue(matrix, 1 / matrix.diagonal()[:, None])
    assert found == pytest.approx(2.6, rel=1e-3)
