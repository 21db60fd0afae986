"""A mesh of ten-node tetrahedra."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


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
