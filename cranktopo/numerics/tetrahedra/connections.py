"""Connections of the elements of a mesh, wherever its nodes lie: found once for a mesh that moves."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp

from cranktopo.base.arrays import Array, Index
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.numerics.tetrahedra.numbered_mesh import numbered_mesh
from cranktopo.numerics.tetrahedra.symmetric_blocks import Pattern, neighbourly


@dataclass(frozen=True, eq=False)
class Connections:
    """Numbers of the nodes of a mesh and the blocks of its matrices.

    Attributes:
        body: scikit-fem's mesh, its nodes where they were first.
        cells: the same elements as the mesh numbers its nodes, (10, elements).
    """

    body: Any
    cells: Index

    def moved(self, mesh: TetMesh) -> Any:
        """Return the body with its nodes where a mesh with the same cells has them."""
        body = copy(self.body)
        body.doflocs = np.ascontiguousarray(mesh.points_mm[:, self._node], dtype=np.float64)
        return body

    @cached_property
    def prolongation(self) -> sp.csr_matrix:
        """From corners to all nodes: corners keep their value, edge nodes take the mean of their two."""
        corners, edges = self.body.nvertices, self.body.edges
        count = edges.shape[1]
        half = sp.csr_matrix(
            (np.full(2 * count, 0.5), edges.T.ravel(), np.arange(0, 2 * count + 1, 2)), shape=(count, corners)
        )
        return sp.vstack([sp.eye(corners), half]).tocsr()

    @cached_property
    def linear(self) -> Pattern:
        """Blocks that linear displacements fill."""
        return Pattern.of(self.body.t, self._rank)

    @cached_property
    def quadratic(self) -> Pattern:
        """Blocks that quadratic displacements fill."""
        return Pattern.of(self.body.dofs.element_dofs, self.prolongation @ self._rank)

    @cached_property
    def apart(self) -> tuple[Index, Index, Index]:
        """Elements in three groups, the first two of which share no node: for two threads."""
        rank = self._rank[self.body.t]
        middle = self.body.nvertices / 2
        first, second = rank.max(axis=0) < middle, rank.min(axis=0) >= middle
        one, other, between = map(np.flatnonzero, (first, second, ~(first | second)))
        return one, other, between

    @cached_property
    def _rank(self) -> Array:
        return neighbourly(self.body.t, self.body.nvertices)

    @cached_property
    def _node(self) -> Index:
        """The node of the mesh of each node of the body."""
        node = np.empty(self.body.doflocs.shape[1], dtype=np.intp)
        node[self.body.dofs.element_dofs.ravel()] = self.cells.ravel()
        return node


def connections(mesh: TetMesh) -> Connections:
    """Return what the elements of a mesh connect."""
    return Connections(numbered_mesh(mesh.points_mm, mesh.cells), mesh.cells)
