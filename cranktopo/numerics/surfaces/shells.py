"""The connected shells of a surface: one per body and one per closed hollow."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cranktopo.numerics.surfaces.mesh import SurfaceMesh

_Labels = NDArray[np.int32]


def shell_volumes_mm3(mesh: SurfaceMesh) -> NDArray[np.float64]:
    """Signed volume enclosed by each connected shell, mm3; negative for a hollow."""
    a, b, c = np.moveaxis(mesh.corners_mm, 1, 0)
    return np.bincount(_shell_of_face(mesh), np.einsum("ij,ij->i", a, np.cross(b, c)) / 6).astype(np.float64)


def shells(mesh: SurfaceMesh) -> list[SurfaceMesh]:
    """The shells, each with its own vertices: the largest body first, then the others and the hollows."""
    number = _shell_of_face(mesh)
    parts = [_part(mesh, number == shell) for shell in range(number.max(initial=-1) + 1)]
    return sorted(parts, key=lambda part: -part.volume_mm3)


def connected(nodes: int, links: NDArray[np.int64]) -> _Labels:
    """Number of the connected component of each node, (nodes,), for links (n, 2) between them."""
    from scipy import sparse
    from scipy.sparse.csgraph import connected_components

    graph = sparse.coo_matrix((np.ones(len(links), bool), links.T), shape=(nodes, nodes))
    labels: _Labels = connected_components(graph, directed=False)[1]
    return labels


def _shell_of_face(mesh: SurfaceMesh) -> _Labels:
    return connected(len(mesh.faces), mesh.as_trimesh().face_adjacency)


def _part(mesh: SurfaceMesh, chosen: NDArray[np.bool_]) -> SurfaceMesh:
    used, faces = np.unique(mesh.faces[chosen], return_inverse=True)
    return SurfaceMesh(mesh.vertices_mm[used], faces.reshape(-1, 3).astype(np.int64))
