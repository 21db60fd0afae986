"""Symmetric matrices over the displacements of nodes: the upper half of their 3x3 blocks, scaled."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import reverse_cuthill_mckee

from cranktopo.base.arrays import Array, Index, Int32
from cranktopo.numerics.tetrahedra.block_code import assembly, product

_FEW_ROWS = 5_000
"""A product with fewer takes no longer than a thread takes to begin."""


@dataclass(frozen=True)
class SymmetricBlocks:
    """A symmetric positive definite matrix over unknowns 3 node + axis, its diagonal scaled to one.

    Attributes:
        order: the node of each row of blocks, neighbours near each other, so that they stay in the cache.
        start: the first block of each row, its diagonal one, and the end, (rows + 1,).
        column: the row of blocks that a block couples its own with, (blocks,).
        value: scaled blocks, (blocks, 3, 3).
        root: roots of the diagonal of the true matrix, of unknowns in this order, (3 rows, 1).
    """

    order: NDArray[np.intp]
    start: Int32
    column: Int32
    value: NDArray[Any]
    root: NDArray[Any]

    @property
    def shape(self) -> tuple[int, int]:
        """Number of unknowns, twice."""
        return len(self.root), len(self.root)

    @property
    def unknowns(self) -> NDArray[np.intp]:
        """The unknown of each row of the scaled matrix."""
        return (3 * self.order[:, None] + np.arange(3)).ravel()

    def __matmul__(self, field: Array) -> Array:
        """Return the true matrix times fields (unknowns,) or (unknowns, k)."""
        columns = field.reshape(len(field), -1)
        found = np.zeros((len(self.root), columns.shape[1]))
        self.add_product(self.root * columns[self.unknowns], found)
        result = np.empty_like(found)
        result[self.unknowns] = self.root * found
        return result.reshape(field.shape)

    def add_product(self, field: NDArray[Any], total: NDArray[Any], factor: float = 1.0) -> None:
        """Add a factor times the scaled matrix times fields (unknowns, k), in its own order, to a total."""
        values = np.ascontiguousarray(field)
        arrays = (self.start, self.column, self.value, values, total)
        code = product(values.shape[1], "float" if self.value.dtype == np.float32 else "double")
        code(*self._apart, len(self.order), factor, *(array.ctypes.data for array in arrays))

    @cached_property
    def _apart(self) -> tuple[int, int]:
        """Rows of blocks before the first and from the second on share no column: for two threads."""
        count, middle = len(self.order), len(self.order) // 2
        if count < _FEW_ROWS:
            return count, count
        beyond = np.flatnonzero(np.maximum.reduceat(self.column, self.start[:-1])[:middle] >= middle)
        return int(beyond[0]) if len(beyond) else middle, middle

    @cached_property
    def single(self) -> SymmetricBlocks:
        """The same matrix in single precision, for fields of that precision."""
        return replace(self, value=self.value.astype(np.float32), root=self.root.astype(np.float32))

    def upper(self) -> sp.csr_matrix:
        """Return the scaled matrix in its own order, its diagonal blocks and those above."""
        size = len(self.root)
        return sp.bsr_matrix((self.value, self.column, self.start), shape=(size, size)).tocsr()

    def tocsr(self) -> sp.csr_matrix:
        """Return the true matrix over the unknowns as the nodes number them."""
        upper = sp.triu(self.upper())
        scale, place = sp.diags(self.root[:, 0]), np.argsort(self.unknowns)
        return (scale @ (upper + sp.triu(upper, 1).T) @ scale).tocsr()[place][:, place]


def neighbourly(cells: NDArray[np.intp], corners: int) -> Array:
    """Return a rank of corners, (corners,), by which those of an element lie near each other."""
    one, other = (cells[list(ends)].ravel() for ends in ((0, 0, 0, 1, 1, 2), (1, 2, 3, 2, 3, 3)))
    pairs = sp.coo_matrix((np.ones(one.size, np.int8), (one, other)), (corners, corners))
    rank = np.empty(corners)
    rank[reverse_cuthill_mckee((pairs + pairs.T).tocsr(), symmetric_mode=True)] = np.arange(corners)
    return rank


@dataclass(frozen=True)
class Pattern:
    """Blocks that the elements of a mesh fill.

    Attributes:
        order, start, column: those of the matrix.
        rows: of each element, (elements, nodes).
    """

    order: NDArray[np.intp]
    start: Int32
    column: Int32
    rows: Int32

    @staticmethod
    def of(cells: NDArray[np.intp], rank: Array) -> Pattern:
        """Order the nodes by rank, which of two as their numbers do where it is the same."""
        order = np.argsort(rank, kind="stable")
        place = np.empty(len(rank), dtype=np.int32)
        place[order] = np.arange(len(rank))
        rows = np.ascontiguousarray(place[cells].T)
        one, other = np.triu_indices(len(cells))
        pairs = np.sort(np.stack([rows[:, one].ravel(), rows[:, other].ravel()]), axis=0)
        filled = sp.coo_matrix((np.ones(pairs.shape[1], np.int8), pairs), (len(rank),) * 2).tocsr()
        return Pattern(order, filled.indptr, filled.indices, rows)


class BlockSum:
    """A stiffness matrix in the making: the sum of the elements of a mesh."""

    def __init__(self, pattern: Pattern) -> None:
        self._pattern, self._value = pattern, np.zeros((len(pattern.column), 3, 3))

    def add(self, elements: Index, slopes: Array, dx: Array, lame: tuple[float, float]) -> None:
        """Add the stiffness of some elements: lambda div u div v + 2 mu eps(u):eps(v).

        Args:
            slopes: of the shape functions, (elements, nodes, 3, points).
            dx: volume of the quadrature points, (elements, points).
            lame: first constant and shear modulus, MPa.
        """
        pattern = self._pattern
        rows, slopes, dx = map(np.ascontiguousarray, (pattern.rows[elements], slopes, dx))
        arrays = rows, slopes, dx, pattern.start, pattern.column, self._value
        at = [array.ctypes.data for array in arrays]
        assembly()(*rows.shape, *at[:3], *lame, *at[3:])

    def matrix(self) -> SymmetricBlocks:
        """Return the sum of all elements; call it once, as their blocks become those of the matrix."""
        value, pattern = self._value, self._pattern
        root = np.sqrt(np.einsum("nii->ni", value[pattern.start[:-1]]))
        rows = np.repeat(np.arange(len(root)), np.diff(pattern.start))
        value /= root[rows][:, :, None]
        value /= root[pattern.column][:, None, :]
        return SymmetricBlocks(pattern.order, pattern.start, pattern.column, value, root.reshape(-1, 1))
