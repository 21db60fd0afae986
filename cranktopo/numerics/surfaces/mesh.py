"""Triangle mesh of a closed surface, its connected shells, and its passage to and from the boolean engine."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from manifold3d import Manifold, Mesh64
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, ExitCode

Faces = NDArray[np.int64]
DEGENERATE_MM2 = 1e-12
_NOTHING_MM = 1e-9
_REPAIRS = 3


@dataclass(frozen=True, eq=False)
class SurfaceMesh:
    """Closed triangle mesh; equal only to itself, so that what is found out about one can be kept.

    Vertices (n, 3), mm, in the frame of `cranktopo.base.frames`; faces (m, 3) counter-clockwise from outside.
    """

    vertices_mm: Array
    faces: Faces

    @property
    def corners_mm(self) -> Array:
        """Corner coordinates of the faces, (m, 3 corners, 3), mm."""
        return self.vertices_mm[self.faces]

    @property
    def areas_mm2(self) -> Array:
        """Area of each face, (m,), mm2."""
        a, b, c = np.moveaxis(self.corners_mm, 1, 0)
        return np.asarray(np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2)

    @property
    def volume_mm3(self) -> float:
        """Enclosed volume by the divergence theorem, mm3; negative when the faces point inward."""
        a, b, c = np.moveaxis(self.corners_mm, 1, 0)
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)

    @property
    def extent_mm(self) -> float:
        """Longest edge of its bounding box, mm."""
        return float(np.ptp(self.vertices_mm, axis=0).max())

    def as_trimesh(self) -> Any:
        """Return the same vertices and faces as a `trimesh.Trimesh`."""
        import trimesh

        return trimesh.Trimesh(self.vertices_mm, self.faces, process=False)


def solid_of(mesh: SurfaceMesh, name: str = "surface") -> Manifold:
    """Return a closed oriented 2-manifold as a solid of the boolean engine; errors call it `name`."""
    # Copies, because the engine takes only arrays that it may write to.
    vertices = np.array(mesh.vertices_mm, np.float64, order="C")
    solid = Manifold(Mesh64(vertices, np.array(mesh.faces, np.uint64, order="C")))
    if solid.status().name != "NoError":
        raise CranktopoError(
            f"{name}: not a closed, consistently oriented surface ({solid.status().name}).",
            hint="Repair the mesh (close its holes, orient its faces) and try again.",
            code=ExitCode.INVALID_INPUT,
        )
    return solid


def mesh_of(solid: Manifold) -> SurfaceMesh:
    """Return the mesh of a solid, rounded to what a binary STL can hold and welded.

    Rounding here and not in the writer means that every check sees the coordinates that are written.
    """
    mesh = solid.to_mesh64()
    points = np.array(mesh.vert_properties)[:, :3]
    points[np.abs(points) < _NOTHING_MM] = 0.0  # rounding left of 0, on either side, or -0
    rounded = points.astype(np.float32)
    faces = np.asarray(mesh.tri_verts).astype(np.int64)
    vertices, number = np.unique(rounded, axis=0, return_inverse=True)
    faces = number.reshape(-1)[faces]
    collapsed = (faces == np.roll(faces, 1, axis=1)).any(axis=1)
    return SurfaceMesh(vertices.astype(np.float64), faces[~collapsed])


def sound_mesh_of(solid: Manifold, tolerance_mm: float) -> SurfaceMesh:
    """Return the mesh of a solid without faces that rounding made flat; vertices near them may move."""
    mesh = mesh_of(solid)
    for _ in range(_REPAIRS):
        if mesh.areas_mm2.min(initial=np.inf) > DEGENERATE_MM2:
            break
        mesh = mesh_of(solid_of(mesh).simplify(tolerance_mm))
    return mesh


_Labels = NDArray[np.int32]


def shell_volumes_mm3(mesh: SurfaceMesh) -> NDArray[np.float64]:
    """Return the signed volume enclosed by each connected shell, mm3; negative for a hollow."""
    a, b, c = np.moveaxis(mesh.corners_mm, 1, 0)
    return np.bincount(_shell_of_face(mesh), np.einsum("ij,ij->i", a, np.cross(b, c)) / 6).astype(np.float64)


def shells(mesh: SurfaceMesh) -> list[SurfaceMesh]:
    """Return the shells, each with its own vertices: the largest first, then others and hollows."""
    number = _shell_of_face(mesh)
    parts = [_part(mesh, number == shell) for shell in range(number.max(initial=-1) + 1)]
    return sorted(parts, key=lambda part: -part.volume_mm3)


def connected(nodes: int, links: NDArray[np.int64]) -> _Labels:
    """Return the number of the connected component of each node, (nodes,), for links (n, 2) between them."""
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
