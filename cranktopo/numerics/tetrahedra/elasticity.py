"""Linear elasticity on curved tetrahedra: stiffness matrix and loads, through scikit-fem, and sparse solves.

SuperLU is the quickest to about 12 000 unknowns and then grows fast in time and memory; conjugate gradients
with linear tetrahedra as the coarse level grow about linearly ("Solvers of the evaluation",
docs/pages/benchmarks.md). Both need nothing but SciPy.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sla

from cranktopo.base.arrays import Array
from cranktopo.base.errors import solver_error
from cranktopo.base.notes import at_work
from cranktopo.base.reproducible import SEED
from cranktopo.base.side_by_side import side_by_side
from cranktopo.numerics.tetrahedra.mesh import TetMesh

DIRECT_LIMIT = 12_000
"""Most unknowns for the direct solver."""
RESIDUAL_LIMIT = 1e-6
"""Largest accepted relative residual: the relative error of a stiffness is its square, that of the fatigue
safety stays below it (5e-8 on `mikron-iiic`)."""
_AIM = 1e-2
"""Part of the accepted residual at which conjugate gradients end."""
_CG_CYCLES = 400
_EIGENVALUE_TOLERANCE = 1e-2
_SMOOTHING = 3
_BAND = 10.0
"""Chebyshev smoothing acts on the upper part of the spectrum, lambda_max / band and above."""


def solve_symmetric(
    matrix: sp.csr_matrix, loads: Array, prolongation: sp.csr_matrix, method: str = "auto"
) -> Array:
    """Solve a symmetric positive definite system for right-hand sides (n, k), as `symmetric_solver`."""
    return symmetric_solver(matrix, prolongation, method)(loads)


def symmetric_solver(
    matrix: sp.csr_matrix, prolongation: sp.csr_matrix, method: str = "auto", residual: float = RESIDUAL_LIMIT
) -> Callable[[Array], Array]:
    """Return the solver of a symmetric positive definite system for loads (n, k), factorised once.

    The prolongation is the interpolation from linear elements, the method "direct", "multigrid", or "auto" by
    size. Raises CranktopoError: a singular matrix, or, of the solver, a relative residual above the limit.
    """
    unknowns = matrix.shape[0]
    direct = method == "direct" or (method == "auto" and unknowns <= DIRECT_LIMIT)
    with at_work(f"factorising, {unknowns:,} unknowns"):
        factor = _factorise(matrix) if direct else two_level_cycle(matrix, prolongation)

    def solve(loads: Array) -> Array:
        with at_work(f"solving {loads.shape[1]} columns, {unknowns:,} unknowns"):
            solution = (
                factor(loads) if direct else _conjugate_gradients(matrix, loads, factor, _AIM * residual)
            )
            _check_residual(matrix, loads, solution, residual)
        return solution

    return solve


def _factorise(matrix: sp.csr_matrix) -> Callable[[Array], Array]:
    options = {"SymmetricMode": True}
    try:
        factor = sla.splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
    except (RuntimeError, MemoryError) as error:
        raise solver_error(
            f"solver: factorisation of {matrix.shape[0]} unknowns failed: {error}.",
            "Choose a larger element size.",
        ) from None
    solver: Callable[[Array], Array] = factor.solve
    return solver


def _check_residual(matrix: sp.csr_matrix, loads: Array, solution: Array, limit: float) -> None:
    scale = np.linalg.norm(loads, axis=0)
    residual = np.linalg.norm(matrix @ solution - loads, axis=0) / np.where(scale > 0, scale, 1.0)
    if not (residual <= limit).all():
        raise solver_error(
            f"solver: relative residual {residual.max():.1e} is above {limit:.0e}.",
            "Choose a smaller element size: badly shaped elements spoil the matrix.",
        )


def two_level_cycle(matrix: sp.csr_matrix, prolongation: sp.csr_matrix) -> Callable[[Array], Array]:
    """Return a symmetric V-cycle over quadratic and linear elements; the linear level is solved directly."""
    restriction = prolongation.T.tocsr()
    coarse = _factorise((restriction @ matrix @ prolongation).tocsc())
    smooth = _chebyshev(matrix)

    def cycle(residual: Array) -> Array:
        x = smooth(residual)
        x += prolongation @ coarse(restriction @ (residual - matrix @ x))
        return x + smooth(residual - matrix @ x)

    return cycle


def _chebyshev(matrix: sp.csr_matrix) -> Callable[[Array], Array]:
    """Correction for a residual by Chebyshev iteration, Jacobi-scaled (Saad, Iterative Methods, 12.1)."""
    inverse = 1.0 / matrix.diagonal()[:, None]
    upper = 1.1 * largest_eigenvalue(matrix, inverse)
    lower = upper / _BAND
    centre, half = (upper + lower) / 2, (upper - lower) / 2

    def smooth(residual: Array) -> Array:
        rho = half / centre
        step = inverse * residual / centre
        x = step
        for _ in range(_SMOOTHING - 1):
            residual = residual - matrix @ step
            following = 1.0 / (2 * centre / half - rho)
            step = following * rho * step + 2 * following / half * (inverse * residual)
            rho = following
            x = x + step
        return x

    return smooth


def largest_eigenvalue(matrix: sp.csr_matrix, inverse: Array) -> float:
    """Return that of the Jacobi-scaled matrix, by Lanczos: power iteration is slow with a bad element."""
    root = np.sqrt(inverse[:, 0])
    scaled = sla.LinearOperator(matrix.shape, lambda x: root * (matrix @ (root * x.ravel())), dtype=float)
    start = np.random.default_rng(SEED).standard_normal(matrix.shape[0])
    found = sla.eigsh(scaled, k=1, v0=start, tol=_EIGENVALUE_TOLERANCE, return_eigenvectors=False)
    return float(found[0])


def _conjugate_gradients(
    matrix: sp.csr_matrix, loads: Array, cycle: Callable[[Array], Array], tolerance: float
) -> Array:
    """Preconditioned CG, all right-hand sides in step; those that are solved leave."""
    solution = np.zeros_like(loads)
    goal = tolerance * np.linalg.norm(loads, axis=0)
    columns = np.flatnonzero(goal > 0)
    x, residual = solution[:, columns], loads[:, columns]
    direction, energy = np.zeros_like(x), np.zeros(len(columns))
    for _ in range(_CG_CYCLES if len(columns) else 0):
        z = cycle(residual)
        following = (residual * z).sum(axis=0)
        direction = z + following / np.where(energy > 0, energy, 1.0) * direction
        image, energy = matrix @ direction, following
        curvature = (direction * image).sum(axis=0)
        step = energy / np.where(curvature > 0, curvature, 1.0)
        x += step * direction
        residual -= step * image
        open_ = np.linalg.norm(residual, axis=0) > goal[columns]
        if not open_.all():
            solution[:, columns] = x
            columns, energy = columns[open_], energy[open_]
            x, residual, direction = x[:, open_], residual[:, open_], direction[:, open_]
        if not len(columns):
            break
    solution[:, columns] = x
    return solution


Order = Literal[1, 2]
"""Degree of the displacements in an element; its shape is quadratic in either case."""

_CHUNK = 4000
STIFFNESS_ORDER = 2
"""Quadrature order of the stiffness: four points, exact on straight elements, as C3D10 elsewhere."""
LOAD_ORDER = 6
_PLANE_MM = 1e-9
"""Quadrature points on an element's face that lies in a plane count as inside, whatever their rounding."""


@dataclass(frozen=True)
class Elasticity:
    """An assembled elastic body.

    Attributes:
        nodes_mm: shape (3, nodes), corners first; the corners alone if `order`, of displacements, is 1.
        stiffness: matrix over unknowns 3 node + axis, N/mm.
        prolongation: linear to quadratic interpolation over unknowns, shape (3 nodes, 3 corners).
    """

    nodes_mm: Array
    stiffness: sp.csr_matrix
    prolongation: sp.csr_matrix
    mesh: Any
    volume_mm3: float
    order: Order = 2


@at_work("stiffness matrix")
def assemble(mesh: TetMesh, youngs_MPa: float, poisson: float, order: Order = 2) -> Elasticity:
    """Assemble the isotropic stiffness matrix; order 1 is only for comparison with quadratic elements."""
    from skfem import MeshTet2

    body = MeshTet2(mesh.points_mm, mesh.cells)
    nodes = body.doflocs if order == 2 else body.doflocs[:, : body.nvertices]
    middle = body.nelements // 2
    matrix = partial(_matrix, body, order, youngs_MPa, poisson)
    (first, one), (second, two) = side_by_side(
        lambda: matrix(0, middle), lambda: matrix(middle, body.nelements)
    )
    coarse = _prolongation(body) if order == 2 else sp.identity(nodes.size, format="csr")
    return Elasticity(nodes, first + second, coarse, body, one + two, order)


def _matrix(
    body: Any, order: Order, youngs_MPa: float, poisson: float, first: int, end: int
) -> tuple[sp.csr_matrix, float]:
    from skfem import Basis

    unknowns = 3 * (body.doflocs.shape[1] if order == 2 else body.nvertices)
    stiffness, volume = sp.csr_matrix((unknowns, unknowns)), 0.0
    for start in range(first, end, _CHUNK):
        elements = np.arange(start, min(start + _CHUNK, end))
        basis = Basis(body, _element(order), intorder=STIFFNESS_ORDER, elements=elements)
        if basis.mapping.detDF(basis.X, tind=elements).min() <= 0:  # basis.dx takes its absolute value
            raise solver_error("mesh: an element is inverted.", "Choose another element size.")
        stiffness = stiffness + _chunk_matrix(basis, youngs_MPa, poisson, unknowns)
        volume += float(basis.dx.sum())
    return stiffness, volume


def _element(order: Order) -> Any:
    from skfem import ElementTetP1, ElementTetP2

    return ElementTetP2() if order == 2 else ElementTetP1()


def mean_displacement(model: Elasticity, axis: int, z_from_mm: float, z_to_mm: float = math.inf) -> Array:
    """Return m with m.u = mean of one displacement component over material between two z, (unknowns,).

    The same vector, times a force, is the load of that force spread evenly over that material. Elements that
    straddle z are integrated over their inside quadrature points.
    """
    basis, inside = basis_above_plane(model, z_from_mm, z_to_mm)
    mean = np.zeros(model.nodes_mm.size)
    _add_load(mean, basis, axis, inside)
    return np.asarray(mean / inside.sum(), dtype=np.float64)


def _add_load(force: Array, basis: Any, axis: int, weights: Array) -> None:
    shares = np.stack([(np.asarray(phi[0]) * weights).sum(axis=1) for phi in basis.basis])
    np.add.at(force, 3 * basis.element_dofs + axis, shares)


def basis_above_plane(model: Elasticity, z_from_mm: float, z_to_mm: float = math.inf) -> tuple[Any, Array]:
    """Return the basis of the elements that reach beyond z, and the weights of its points there, mm3."""
    from skfem import Basis

    heights = model.mesh.p[2][model.mesh.t]
    reach = (heights.max(axis=0) > z_from_mm + _PLANE_MM) & (heights.min(axis=0) < z_to_mm - _PLANE_MM)
    basis = Basis(model.mesh, _element(model.order), intorder=LOAD_ORDER, elements=np.nonzero(reach)[0])
    z = np.asarray(basis.global_coordinates())[2]
    return basis, basis.dx * ((z > z_from_mm - _PLANE_MM) & (z < z_to_mm + _PLANE_MM))


def centrifugal_force(model: Elasticity, density_tonne_per_mm3: float) -> Array:
    """Return the nodal forces of rotation about the crank axis at 1 rad/s, shape (unknowns,), N."""
    from skfem import Basis

    basis = Basis(model.mesh, _element(model.order), intorder=LOAD_ORDER)
    points = np.asarray(basis.global_coordinates())
    force = np.zeros(model.nodes_mm.size)
    for axis in (0, 1):
        _add_load(force, basis, axis, density_tonne_per_mm3 * points[axis] * basis.dx)
    return force


def lame_constants_MPa(youngs_MPa: float, poisson: float) -> tuple[float, float]:
    """Return Lame's first constant and the shear modulus."""
    return youngs_MPa * poisson / ((1 + poisson) * (1 - 2 * poisson)), youngs_MPa / (2 * (1 + poisson))


def _chunk_matrix(basis: Any, youngs: float, poisson: float, unknowns: int) -> sp.csr_matrix:
    """Sum of the element matrices of a chunk: lambda div u div v + 2 mu eps(u):eps(v)."""
    lame, shear = lame_constants_MPa(youngs, poisson)
    gradients = np.ascontiguousarray(np.stack([phi[0].grad for phi in basis.basis]).transpose(2, 3, 0, 1))
    weighted = gradients * basis.dx[:, :, None, None]
    count, points = basis.dx.shape
    nodes = gradients.shape[2]
    flat = gradients.reshape(count, points, 3 * nodes)
    outer = np.matmul(weighted.reshape(count, points, 3 * nodes).transpose(0, 2, 1), flat)
    outer = outer.reshape(count, nodes, 3, nodes, 3)
    matrix = lame * outer + shear * outer.transpose(0, 1, 4, 3, 2)
    trace = shear * np.einsum("eaibi->eab", outer)
    for axis in range(3):
        matrix[:, :, axis, :, axis] += trace
    rows = (3 * basis.element_dofs.T[:, :, None] + np.arange(3)).reshape(count, 3 * nodes).astype(np.int32)
    return sp.coo_matrix(
        (matrix.ravel(), (np.repeat(rows, 3 * nodes, axis=1).ravel(), np.tile(rows, (1, 3 * nodes)).ravel())),
        shape=(unknowns, unknowns),
    ).tocsr()


def _prolongation(body: Any) -> sp.csr_matrix:
    """Corner nodes keep their value, edge nodes take the mean of their two corners."""
    corners, edges = body.nvertices, body.edges
    count = edges.shape[1]
    half = sp.csr_matrix(
        (np.full(2 * count, 0.5), edges.T.ravel(), np.arange(0, 2 * count + 1, 2)), shape=(count, corners)
    )
    return sp.kron(sp.vstack([sp.eye(corners), half]), sp.eye(3)).tocsr()
