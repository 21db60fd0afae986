"""Cubes of quadratic tetrahedra."""

from __future__ import annotations

import numpy as np
from skfem import MeshTet

from cranktopo.numerics.tetrahedra.mesh import TetMesh, quadratic


def cube_mesh(parts: int) -> TetMesh:
    """The unit cube, its edges in so many parts."""
    cube = MeshTet.init_tensor(*[np.linspace(0.0, 1.0, parts + 1)] * 3)
    corners = cube.t.T.astype(np.int64)
    at = cube.p.T[corners]
    volume = np.einsum("ij,ij->i", np.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0]), at[:, 3] - at[:, 0])
    corners[volume < 0] = corners[volume < 0][:, [1, 0, 2, 3]]
    points, cells = quadratic(cube.p.T, corners)
    return TetMesh(points, cells, False)
