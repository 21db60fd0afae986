"""Springs along the edges of a mesh, which spread the motion of some nodes over the others."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Index, all_but
from cranktopo.numerics.tetrahedra.numbered_mesh import row_keys
from cranktopo.numerics.tetrahedra.solver import direct_solver, solve_directly

_PARALLEL = 1e-3
"""Least eigenvalue of the sum of n n' of a node's unit normals: below, two faces count as one (2.5 deg)."""


@dataclass(frozen=True)
class MotionRules:
    """Constraints of surface nodes: sum of n n', (n, 3, 3), and of n times their normal motion, (n, 3, k)."""

    matrix: Array
    prescribed: Array

    def minimum_motion(self, guess: Array) -> Array:
        """Return the motion nearest to a guess, (n, 3, k), that keeps the rules."""
        return np.asarray(guess + self._inverse @ (self.prescribed - self.matrix @ guess))

    @property
    def free(self) -> tuple[Array, NDArray[np.bool_]]:
        """Directions of each node in columns, (n, 3, 3), and which of them are free, (n, 3)."""
        values, vectors = np.linalg.eigh(self.matrix)
        return vectors, values < _PARALLEL

    @property
    def _inverse(self) -> Array:
        values, vectors = np.linalg.eigh(self.matrix)
        inverse = np.where(values < _PARALLEL, 0.0, 1 / np.maximum(values, _PARALLEL))
        return np.asarray((vectors * inverse[:, None]) @ vectors.swapaxes(1, 2))


class SpringNet:
    """Springs along the edges of triangles or tetrahedra, stiffness one over the square of the length."""

    def __init__(self, points_mm: Array, cells: Index) -> None:
        sides = [cells[list(pair)].T for pair in combinations(range(len(cells)), 2)]
        ends = np.sort(np.concatenate(sides), axis=1).T
        a, b = ends[:, np.unique(row_keys(ends), return_index=True)[1]]
        weight = 1 / ((points_mm[:, a] - points_mm[:, b]) ** 2).sum(axis=0)
        count = points_mm.shape[1]
        off = sp.coo_matrix((weight, (a, b)), shape=(count, count)).tocsr()
        both = off + off.T
        self._matrix = (sp.diags(np.asarray(both.sum(axis=1)).ravel()) - both).tocsr()
        self._last: Filling | None = None

    def slide(self, nodes: Index, rules: MotionRules) -> Array:
        """Return the motion of nodes, (n, 3, k), that keeps the rules and stretches the springs least."""
        first = rules.minimum_motion(np.zeros_like(rules.prescribed))
        directions, free = rules.free
        matrix = sp.kron(self._matrix[nodes][:, nodes], sp.eye(3)).tocsr()
        count = len(nodes)
        blocks = sp.bsr_matrix((directions, np.arange(count), np.arange(count + 1))).tocsc()
        basis = blocks[:, np.flatnonzero(free.ravel())]
        flat = first.reshape(3 * count, -1)
        if basis.shape[1] == 0:
            return first
        loads = -(basis.T @ (matrix @ flat))
        along = solve_directly(basis.T @ matrix @ basis, loads)
        return np.asarray((flat + basis @ along).reshape(first.shape))

    def fill(self, motion: Array, inner: Index) -> Array:
        """Return the motion of all nodes, (n, 3, k), from that of all but the inner ones."""
        result = motion.copy()
        if len(inner):
            filling, flat = self.filling(inner), motion.reshape(len(motion), -1)
            found = filling.solve(-(filling.beside @ flat[filling.held]))
            result[inner] = found.reshape(len(inner), *motion.shape[1:])
        return result

    def filling(self, inner: Index) -> Filling:
        """Return what the motion of inner nodes is found with, factorised where the last ones were others."""
        if self._last is None or not np.array_equal(self._last.inner, inner):
            held, rows = all_but(self._matrix.shape[0], inner), self._matrix[inner]
            self._last = Filling(inner, held, rows[:, held], direct_solver(rows[:, inner]))
        return self._last


class Filling(NamedTuple):
    """Inner nodes and the others, the springs between both, and the solver of those between inner nodes."""

    inner: Index
    held: Index
    beside: sp.csr_matrix
    solve: Callable[[Array], Array]
