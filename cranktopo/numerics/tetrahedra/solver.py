"""Solvers of an elastic body: a sparse Cholesky factorisation, alone or as the coarse level of two.

The factorisation (CHOLMOD, through CVXOPT) is the quicker one for small bodies; beyond, conjugate gradients
with linear tetrahedra as the coarse level grow about linearly ("Solvers of the evaluation",
docs/pages/benchmarks.md).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property
from importlib import import_module
from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sla
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Single, all_but, mask_of
from cranktopo.base.errors import solver_error
from cranktopo.base.machine import addresses_of_threads_MiB, check_addresses
from cranktopo.base.notes import at_work
from cranktopo.base.reproducible import SEED
from cranktopo.base.side_by_side import LazyFuture
from cranktopo.numerics.tetrahedra.block_code import assembly, product
from cranktopo.numerics.tetrahedra.earlier_bodies import EarlierBodies
from cranktopo.numerics.tetrahedra.symmetric_blocks import SymmetricBlocks

DIRECT_LIMIT = 12_000
"""Most unknowns for the direct solver."""
_BLAS_ADDRESSES_MIB = 300.0
"""Buffers of OpenBLAS (200 measured); where they cannot be had, it ends the process."""
RESIDUAL_LIMIT = 1e-6
"""Largest accepted relative residual: the relative error of a stiffness is its square, that of the fatigue
safety stays below it (5e-8 on `mikron-iiic`)."""
_AIM = 1e-2
"""Part of the accepted residual at which conjugate gradients end."""
_CG_CYCLES = 400
_SOLVED = 0.1
"""Part of the residual aimed at from which a right-hand side waits for the others: stresses that are sums of
all would else be the worse for it (1.8e-6 of a safety in place of 1e-6)."""
_EIGENVALUE_TOLERANCE = 5e-2
_SMOOTHING = 3
_BAND = 14.0
"""Chebyshev smoothing acts on the upper part of the spectrum, lambda_max / band and above."""


@cache
def get_ready() -> None:
    """Begin to load and compile what solves need, in a thread beside the making of a mesh."""
    LazyFuture(_load).begin()


def _load() -> None:
    for module in ("cvxopt.cholmod", "skfem"):
        import_module(module)
    assembly()
    for width in (1, 2):
        product(width)


def solve_directly(matrix: sp.spmatrix, loads: Array) -> Array:
    """Solve a symmetric positive definite system for right-hand sides (n, k), without iteration."""
    return direct_solver(matrix)(loads)


def direct_solver(matrix: sp.spmatrix) -> Callable[[Array], Array]:
    """Return the solver of a symmetric positive definite matrix, which checks its residuals."""
    solved = cholesky(matrix)

    def solve(loads: Array) -> Array:
        solution = solved(loads)
        _check_residual(loads, loads - matrix @ solution, RESIDUAL_LIMIT)
        return solution

    return solve


def cholesky(matrix: sp.spmatrix) -> Callable[[Array], Array]:
    """Return the solver of a symmetric positive definite matrix, of which one triangle is enough."""
    from cvxopt import cholmod, spmatrix
    from cvxopt import matrix as dense

    check_addresses("the factorisation", _BLAS_ADDRESSES_MIB + addresses_of_threads_MiB())
    upper = sp.triu(matrix).tocoo()
    numbers = [dense(np.asarray(part, dtype=np.int64)) for part in (upper.col, upper.row)]
    lower = spmatrix(dense(upper.data), *numbers, matrix.shape)
    try:
        factor = cholmod.symbolic(lower)
        cholmod.numeric(lower, factor)
    except (ArithmeticError, MemoryError) as error:
        raise solver_error(
            f"solver: factorisation of {matrix.shape[0]} unknowns failed: {error}.",
            "Choose a larger element size.",
        ) from None

    def solve(loads: Array) -> Array:
        solution = dense(loads)
        cholmod.solve(factor, solution)
        return np.array(solution).reshape(loads.shape)

    return solve


def _check_residual(loads: Array, residual: Array, limit: float) -> None:
    scale = np.linalg.norm(loads, axis=0)
    found = np.linalg.norm(residual, axis=0) / np.where(scale > 0, scale, 1.0)
    if not (found <= limit).all():
        raise solver_error(
            f"solver: relative residual {found.max():.1e} is above {limit:.0e}.",
            "Choose a smaller element size: badly shaped elements spoil the matrix.",
        )


@dataclass(frozen=True)
class Equations:
    """Equilibrium of an elastic body, for whatever unknowns are held at zero.

    Attributes:
        linear: stiffness of linear elements over the unknowns of the corners, one triangle; None: there are
            no other elements.
        prolongation: from corners to all nodes, (nodes, corners).
        earlier: fields of similar bodies on the same elements, where there are any.
    """

    stiffness: SymmetricBlocks
    linear: sp.csr_matrix | None
    prolongation: sp.csr_matrix
    earlier: EarlierBodies | None = None

    @cached_property
    def largest_eigenvalue(self) -> float:
        """That of the scaled stiffness, which that of one with held unknowns stays below."""
        return largest_eigenvalue(_Scaled(self.stiffness), np.ones((self.stiffness.shape[0], 1)))

    def solver(self, held: NDArray[np.intp], residual: float = RESIDUAL_LIMIT) -> Callable[[Array], Array]:
        """Return the solver for nodal forces (unknowns, k), of which those on held unknowns do not count.

        Raises:
            CranktopoError: a singular matrix, or, of the solver, a relative residual above the limit.
        """
        matrix = self.stiffness
        fixed = mask_of(matrix.shape[0], held)[matrix.unknowns]
        direct = self.linear is None or matrix.shape[0] <= DIRECT_LIMIT
        with at_work(f"factorising, {matrix.shape[0]:,} unknowns"):
            inner: Callable[[Array], NDArray[Any]] = (
                _direct(matrix, ~fixed) if direct else self.two_level_cycle(held)
            )

        @at_work(f"solving, {matrix.shape[0]:,} unknowns")
        def solve(forces: Array) -> Array:
            loads = forces[matrix.unknowns] / matrix.root
            loads[fixed] = 0.0
            if direct:
                found = inner(loads)
            else:
                start = self.earlier.start(matrix, held, loads) if self.earlier else None
                found, cycles = _conjugate_gradients(matrix, fixed, loads, inner, _AIM * residual, start)
                if self.earlier:
                    self.earlier.judge_coarse_level(held, cycles)
            left = loads.copy()
            matrix.add_product(found, left, -1.0)
            left[fixed] = 0.0
            _check_residual(matrix.root * loads, matrix.root * left, residual)
            result = np.empty_like(found)
            result[matrix.unknowns] = found / matrix.root
            if self.earlier:
                self.earlier.keep(held, result)
            return result

        return solve

    def two_level_cycle(self, held: NDArray[np.intp]) -> Callable[[Array], Single]:
        """Return a symmetric V-cycle over quadratic and linear elements; the linear level is solved directly.

        It takes residuals of the scaled system in the order of its rows, zero where unknowns are held, and
        answers in single precision, all but the factorisation.
        """
        matrix, linear = self.stiffness.single, self.linear
        assert linear is not None
        fixed = np.flatnonzero(mask_of(matrix.shape[0], held)[matrix.unknowns])
        free = all_but(linear.shape[0], held[held < linear.shape[0]])

        def factorised() -> Callable[[Array], Array]:
            return cholesky(linear[free][:, free])

        # A fifth of a solve, and no other thread works meanwhile; that of a body before is near enough.
        coarse = self.earlier.coarse_level(held, factorised) if self.earlier else factorised()
        down = self.prolongation[matrix.order].astype(np.float32)
        up = down.T.tocsr()
        smooth = _Chebyshev(matrix, fixed, self.largest_eigenvalue)

        def corrected(left: Single) -> Single:
            count = left.shape[1]
            load = (up @ (matrix.root * left).reshape(-1, 3 * count)).reshape(-1, count)
            field = np.zeros_like(load)
            field[free] = coarse(load[free].astype(np.float64))
            found = matrix.root * (down @ field.reshape(-1, 3 * count)).reshape(-1, count)
            found[fixed] = 0.0
            return np.asarray(found)

        def cycle(residual: Array) -> Single:
            left = residual.astype(np.float32)
            x = smooth(left)
            move = corrected(left)
            x += move
            smooth.take(move, left)
            x += smooth(left, last=True)
            return x

        return cycle


class _Chebyshev:
    """Chebyshev iteration on a scaled matrix (Saad, Iterative Methods, 12.1), some unknowns held at zero."""

    def __init__(self, matrix: SymmetricBlocks, fixed: NDArray[np.intp], largest_eigenvalue: float) -> None:
        """Act on the upper part of the spectrum."""
        upper = 1.1 * largest_eigenvalue
        lower = upper / _BAND
        self._matrix, self._fixed = matrix, fixed
        self._centre, self._half = (upper + lower) / 2, (upper - lower) / 2

    def __call__(self, left: Single, *, last: bool = False) -> Single:
        """Return the correction for a residual, which becomes what is left of it, unless it is the last."""
        ratio = self._centre / self._half
        rho = 1 / ratio
        step = left / self._centre
        x = step.copy()
        for _ in range(_SMOOTHING - 1):
            self.take(step, left)
            following = 1.0 / (2 * ratio - rho)
            step *= following * rho
            step += 2 * following / self._half * left
            rho = following
            x += step
        if not last:
            self.take(step, left)
        return x

    def take(self, step: Single, left: Single) -> None:
        """Take what a step of the displacements answers off a residual."""
        self._matrix.add_product(step, left, -1.0)
        left[self._fixed] = 0.0


def _direct(matrix: SymmetricBlocks, free: NDArray[np.bool_]) -> Callable[[Array], Array]:
    factor = cholesky(matrix.upper()[free][:, free])

    def solve(loads: Array) -> Array:
        found = np.zeros_like(loads)
        found[free] = factor(loads[free])
        return found

    return solve


class _Scaled:
    """The scaled matrix in its own order, as a factor."""

    def __init__(self, matrix: SymmetricBlocks) -> None:
        self._matrix, self.shape = matrix, matrix.shape

    def __matmul__(self, field: Array) -> Array:
        found = np.zeros((len(field), 1))
        self._matrix.add_product(field.reshape(-1, 1), found)
        return found.ravel()


def largest_eigenvalue(matrix: Any, inverse: Array) -> float:
    """Return that of the Jacobi-scaled matrix, by Lanczos: power iteration is slow with a bad element."""
    root = np.sqrt(inverse[:, 0])
    scaled = sla.LinearOperator(matrix.shape, lambda x: root * (matrix @ (root * x.ravel())), dtype=float)
    start = np.random.default_rng(SEED).standard_normal(matrix.shape[0])
    found = sla.eigsh(scaled, k=1, v0=start, ncv=10, tol=_EIGENVALUE_TOLERANCE, return_eigenvectors=False)
    return float(found[0])


def _conjugate_gradients(
    matrix: SymmetricBlocks,
    fixed: NDArray[np.bool_],
    loads: Array,
    cycle: Callable[[Array], NDArray[Any]],
    tolerance: float,
    start: Array | None = None,
) -> tuple[Array, int]:
    """Preconditioned CG from zero or from fields near the solution; return fields and the number of cycles.

    All right-hand sides go in step, each until it is solved well.
    """
    solution, residual = np.zeros_like(loads), loads.copy()
    goal = tolerance * np.linalg.norm(loads, axis=0)
    held = np.flatnonzero(fixed)
    if start is not None:
        solution = start
        matrix.add_product(start, residual, -1.0)
        residual[held] = 0.0
    direction, energy = np.zeros_like(loads), np.zeros(loads.shape[1])
    at_work_on = np.arange(loads.shape[1])
    for cycles in range(_CG_CYCLES):
        off = np.linalg.norm(residual, axis=0)
        if (off <= goal[at_work_on]).all():
            return solution, cycles
        left = off > _SOLVED * goal[at_work_on]
        if not left.all():
            at_work_on, energy = at_work_on[left], energy[left]
            residual, direction = (np.ascontiguousarray(field[:, left]) for field in (residual, direction))
        z = cycle(residual)
        following = _products(residual, z)
        direction *= following / np.where(energy > 0, energy, 1.0)
        direction += z
        image, energy = np.zeros_like(direction), following
        matrix.add_product(direction, image)
        image[held] = 0.0
        curvature = _products(direction, image)
        step = energy / np.where(curvature > 0, curvature, 1.0)
        solution[:, at_work_on] += step * direction
        residual -= step * image
    return solution, _CG_CYCLES


def _products(one: Array, other: NDArray[Any]) -> Array:
    return np.asarray(np.einsum("nk,nk->k", one, other))
