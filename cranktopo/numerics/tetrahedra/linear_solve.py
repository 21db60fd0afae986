"""Sparse symmetric solves: direct for small systems, two-level p-multigrid CG for large ones.

SuperLU is the quickest to about 12 000 unknowns and then grows fast in time and memory; conjugate gradients
with linear tetrahedra as the coarse level grow about linearly ("Solvers of the evaluation",
docs/pages/benchmarks.md). Both need nothing but SciPy.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sla

from cranktopo.base.arrays import Array
from cranktopo.base.errors import solver_error
from cranktopo.base.reproducible import SEED

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
    direct = method == "direct" or (method == "auto" and matrix.shape[0] <= DIRECT_LIMIT)
    factor = _factorise(matrix) if direct else two_level_cycle(matrix, prolongation)

    def solve(loads: Array) -> Array:
        solution = factor(loads) if direct else _conjugate_gradients(matrix, loads, factor, _AIM * residual)
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
