"""Meshes of ten-node tetrahedra; where bending an element to the surface folds it, it is unbent."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, ExitCode

EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
"""Corners of the edges of a ten-node tetrahedron, VTK order."""
_LEAST_RATIO = 0.1
"""Least Jacobian of a curved element over that of its straight counterpart."""
_ROUNDS = 20


def straighten_folded(points_mm: Array, cells: NDArray[np.int64]) -> tuple[Array, int]:
    """Put edge nodes of nearly folded elements back on their straight edges; count these elements.

    Moving an edge node touches the neighbours too, so this repeats until every element is sound. Raises
    CranktopoError where an element is inverted even with straight edges. Nodes (3, nodes), cells (10,
    elements).
    """
    points = points_mm.copy()
    volume = _jacobians(_straight(points, cells)).min(axis=0)
    if volume.min() <= 0:
        raise CranktopoError(
            "mesh: an element is flat or inverted.", hint="Choose another element size.", code=ExitCode.SOLVER
        )
    straightened = np.zeros(cells.shape[1], dtype=bool)
    for _ in range(_ROUNDS):
        bad = _jacobians(points[:, cells]).min(axis=0) < _LEAST_RATIO * volume
        if not bad.any():
            break
        straightened |= bad
        chosen = cells[:, bad]
        points[:, chosen[4:]] = _straight(points, chosen)[:, 4:]
    return points, int(straightened.sum())


def least_jacobian_ratio(points_mm: Array, before_mm: Array, cells: NDArray[np.int64]) -> float:
    """Return the minimum Jacobian of moved elements over that of the same one before, the worst of all."""
    now, was = (_jacobians(points[:, cells]).min(axis=0) for points in (points_mm, before_mm))
    return float((now / was).min())


def _straight(points: Array, cells: NDArray[np.int64]) -> Array:
    nodes = points[:, cells]
    for k, (a, b) in enumerate(EDGES):
        nodes[:, 4 + k] = (nodes[:, a] + nodes[:, b]) / 2
    return nodes


def _jacobians(nodes: Array) -> Array:
    """Jacobian determinant at 15 points of each element, shape (15, elements); nodes as `_straight`."""
    gradients = shape_gradients(_check_points())
    matrix = np.einsum("ine,pnj->ijpe", nodes, gradients)
    return np.asarray(np.einsum("ipe,ipe->pe", matrix[:, 0], np.cross(matrix[:, 1], matrix[:, 2], axis=0)))


def _check_points() -> Array:
    """Barycentric points: corners, edge middles, four quadrature points, centre; shape (15, 4)."""
    corners = np.eye(4)
    middles = np.array([(corners[a] + corners[b]) / 2 for a, b in combinations(range(4), 2)])
    a, b = 0.5854101966249685, 0.1381966011250105
    inner = b + (a - b) * corners
    return np.vstack([corners, middles, inner, np.full((1, 4), 0.25)])


def shape_gradients(barycentric: Array) -> Array:
    """Return the gradients of the ten quadratic shape functions in (xi, eta, zeta), shape (points, 10, 3)."""
    slope = np.array([[-1.0, -1, -1], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    corner = (4 * barycentric - 1)[:, :, None] * slope
    edge = [4 * (barycentric[:, a, None] * slope[b] + barycentric[:, b, None] * slope[a]) for a, b in EDGES]
    return np.concatenate([corner, np.stack(edge, axis=1)], axis=1)


@dataclass(frozen=True)
class TetMesh:
    """A mesh of ten-node tetrahedra.

    Attributes:
        points_mm: nodes, shape (3, nodes).
        cells: node numbers, shape (10, elements), VTK order (corners, then edges 01 12 02 03 13 23).
        mirrored: the mesh is the half x >= 0 of a body symmetric in x.
        off_surface_mm: from each node to where the surface would have it, but for elements that would fold,
            shape (3, nodes); None: all nodes are there.
    """

    points_mm: NDArray[np.float64]
    cells: NDArray[np.int64]
    mirrored: bool
    off_surface_mm: NDArray[np.float64] | None = None
