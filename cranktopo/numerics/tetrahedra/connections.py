"""Connections of the elements of a mesh, wherever its nodes lie: found once for a mesh that moves."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp

from cranktopo.base.arrays import Index
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.numerics.tetrahedra.numbered_mesh import numbered_mesh
from cranktopo.numerics.tetrahedra.symmetric_blocks import Pattern, neighbourly


@dataclass(frozen=True)
class Connections:
    """Numbers of the nodes of a mesh and the blocks of its matrices.

    Attributes:
        body: scikit-fem's mesh, its nodes where they were first.
        node: the node of the mesh of each node of that one.
        prolongation: from corners to all nodes, (nodes, corners).
        linear, quadratic: blocks that linear and quadratic displacements fill.
    """

    body: Any
    node: Index
    prolongation: sp.csr_matrix
    linear: Pattern
    quadratic: Pattern

    def moved(self, mesh: TetMesh) -> Any:
        """Return the same elements with their nodes where a mesh with the same cells has them."""
        body = copy(self.body)
        body.doflocs = np.ascontiguousarray(mesh.points_mm[:, self.node], dtype=np.float64)
        return body


def connections(mesh: TetMesh) -> Connections:
    """Return what the elements of a mesh connect."""
    body = numbered_mesh(mesh.points_mm, mesh.cells)
    cells = body.dofs.element_dofs
    node = np.empty(body.doflocs.shape[1], dtype=np.intp)
    node[cells.ravel()] = mesh.cells.ravel()
    rank, prolongation = neighbourly(body.t, body.nvertices), _prolongation(body)
    return Connections(
        body, node, prolongation, Pattern.of(body.t, rank), Pattern.of(cells, prolongation @ rank)
    )


def _prolongation(body: Any) -> sp.csr_matrix:
    """Corner nodes keep their value, edge nodes take the mean of their two corners."""
    corners, edges = body.nvertices, body.edges
    count = edges.shape[1]
    half = sp.csr_matrix(
        (np.full(2 * count, 0.5), edges.T.ravel(), np.arange(0, 2 * count + 1, 2)), shape=(count, corners)
    )
    return sp.vstack([sp.eye(corners), half]).tocsr()
