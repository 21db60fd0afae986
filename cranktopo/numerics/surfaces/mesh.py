"""Triangle mesh of a closed surface, its shells, its checks, its passage to and from the boolean engine.

Before it is written a mesh must be a closed 2-manifold that does not pass through itself.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from manifold3d import Manifold, Mesh64
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Int32, Int64
from cranktopo.base.errors import CranktopoError, ExitCode

_DEGENERATE_MM2 = 1e-12
_NOTHING_MM = 1e-9
_REPAIRS = 3


@dataclass(frozen=True, eq=False)
class SurfaceMesh:
    """Closed triangle mesh; equal only to itself, so that what is found out about one can be kept.

    Vertices (n, 3), mm, in the frame of `cranktopo.base.frames`; faces (m, 3) counter-clockwise from outside.
    """

    vertices_mm: Array
    faces: Int64

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
    def tetrahedra_mm3(self) -> Array:
        """Volume between each face and the origin, (m,), mm3; negative where the face points to it."""
        a, b, c = np.moveaxis(self.corners_mm, 1, 0)
        return np.asarray(np.einsum("ij,ij->i", a, np.cross(b, c)) / 6)

    @property
    def volume_mm3(self) -> float:
        """Enclosed volume by the divergence theorem, mm3; negative when the faces point inward."""
        return float(self.tetrahedra_mm3.sum())

    @property
    def first_moments_mm4(self) -> Array:
        """Integrals of x, y and z over the enclosed volume, (3,), mm4."""
        return np.asarray(self.tetrahedra_mm3 @ self.corners_mm.sum(axis=1) / 4)

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


def unrounded_mesh_of(solid: Manifold) -> SurfaceMesh:
    """Return the mesh of a solid as the boolean engine holds it."""
    mesh = solid.to_mesh64()
    return SurfaceMesh(np.array(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts).astype(np.int64))


def mesh_of(solid: Manifold) -> SurfaceMesh:
    """Return the mesh of a solid, rounded to what a binary STL can hold and welded.

    Rounding here and not in the writer means that every check sees the coordinates that are written.
    """
    mesh = unrounded_mesh_of(solid)
    points = mesh.vertices_mm.copy()
    points[np.abs(points) < _NOTHING_MM] = 0.0  # rounding left of 0, on either side, or -0
    rounded = points.astype(np.float32)
    vertices, number = np.unique(rounded, axis=0, return_inverse=True)
    faces = number.reshape(-1)[mesh.faces]
    collapsed = (faces == np.roll(faces, 1, axis=1)).any(axis=1)
    return SurfaceMesh(vertices.astype(np.float64), faces[~collapsed])


def snapped(points_mm: Array, axis: int, place_mm: float, within_mm: float) -> Array:
    """Put points (n, 3) near a plane across an axis on it, in place: what is cut there leaves no slivers."""
    points_mm[np.abs(points_mm[:, axis] - place_mm) < within_mm, axis] = place_mm
    return points_mm


def sound_mesh_of(solid: Manifold, tolerance_mm: float) -> SurfaceMesh:
    """Return the mesh of a solid without faces that rounding made flat; vertices near them may move."""
    mesh = mesh_of(solid)
    for _ in range(_REPAIRS):
        if mesh.areas_mm2.min(initial=np.inf) > _DEGENERATE_MM2:
            break
        mesh = mesh_of(solid_of(mesh).simplify(tolerance_mm))
    return mesh


def shell_volumes_mm3(mesh: SurfaceMesh) -> NDArray[np.float64]:
    """Return the signed volume enclosed by each connected shell, mm3; negative for a hollow."""
    return np.bincount(_shell_of_face(mesh), mesh.tetrahedra_mm3).astype(np.float64)


def shells(mesh: SurfaceMesh) -> list[SurfaceMesh]:
    """Return the shells, each with its own vertices: the largest first, then others and hollows."""
    number = _shell_of_face(mesh)
    parts = [_part(mesh, number == shell) for shell in range(number.max(initial=-1) + 1)]
    return sorted(parts, key=lambda part: -part.volume_mm3)


def largest_shell(mesh: SurfaceMesh) -> SurfaceMesh:
    """Return the shell that encloses most, with its own vertices."""
    number = _shell_of_face(mesh)
    return _part(mesh, number == np.bincount(number, mesh.tetrahedra_mm3).argmax())


def connected(nodes: int, links: NDArray[np.int64]) -> Int32:
    """Return the number of the connected component of each node, (nodes,), for links (n, 2) between them."""
    from scipy import sparse
    from scipy.sparse.csgraph import connected_components

    graph = sparse.coo_matrix((np.ones(len(links), bool), links.T), shape=(nodes, nodes))
    labels: Int32 = connected_components(graph, directed=False)[1]
    return labels


def outward(mesh: SurfaceMesh) -> SurfaceMesh:
    """Return a mesh whose faces run around as their neighbours do, the volume inside positive.

    Of every connected part the fewer faces are turned. Each face is a node twice, as it is and turned; nodes
    of neighbours that agree are joined, so that a part falls into a sheet and the same sheet turned.
    """
    count = len(mesh.faces)
    ends = np.stack([mesh.faces, np.roll(mesh.faces, -1, axis=1)], axis=2).reshape(-1, 2)
    edge = np.unique(np.sort(ends, axis=1), axis=0, return_inverse=True)[1].reshape(-1)
    order = np.argsort(edge, kind="stable")
    paired = np.flatnonzero(np.bincount(edge)[edge[order]] == 2)
    one, other = order[paired[::2]], order[paired[1::2]]
    alike = (ends[one, 0] < ends[one, 1]) == (ends[other, 0] < ends[other, 1])  # the edge in the same sense
    a, b = one // 3, other // 3 + count * alike
    twins = np.stack([a + count, (b + count) % (2 * count)], axis=1)
    label = connected(2 * count, np.concatenate([np.stack([a, b], axis=1), twins]))
    turned, part = label[:count] > label[count:], np.minimum(label[:count], label[count:])
    turned ^= (np.bincount(part, turned) > np.bincount(part) / 2)[part]
    found = SurfaceMesh(mesh.vertices_mm, np.where(turned[:, None], mesh.faces[:, ::-1], mesh.faces))
    return found if found.volume_mm3 >= 0 else SurfaceMesh(found.vertices_mm, found.faces[:, ::-1])


def welded(mesh: SurfaceMesh, within_mm: float) -> SurfaceMesh:
    """Return a mesh with vertices joined that lie within a distance, without triangles that lose a corner."""
    from scipy.spatial import cKDTree

    pairs = cKDTree(mesh.vertices_mm).query_pairs(within_mm, output_type="ndarray")
    number = connected(len(mesh.vertices_mm), pairs).astype(np.int64)
    first = np.unique(number, return_index=True)[1]
    return without_doubles(SurfaceMesh(mesh.vertices_mm[first], number[mesh.faces]))


def without_doubles(mesh: SurfaceMesh) -> SurfaceMesh:
    """Return a mesh without triangles that have a vertex twice: no area, and nothing to close."""
    a, b, c = mesh.faces.T
    whole = (a != b) & (b != c) & (c != a)
    return mesh if whole.all() else SurfaceMesh(mesh.vertices_mm, mesh.faces[whole])


def _shell_of_face(mesh: SurfaceMesh) -> Int32:
    return connected(len(mesh.faces), mesh.as_trimesh().face_adjacency)


def _part(mesh: SurfaceMesh, chosen: NDArray[np.bool_]) -> SurfaceMesh:
    used, faces = np.unique(mesh.faces[chosen], return_inverse=True)
    return SurfaceMesh(mesh.vertices_mm[used], faces.reshape(-1, 3).astype(np.int64))


@lru_cache(maxsize=1)
def self_intersections_mm(mesh: SurfaceMesh) -> Array:
    """Return ends (n, 3), mm, of edges that pierce a face which they do not touch; none for a sound surface.

    Two faces that intersect without sharing a vertex have such an edge. Extraction and its checks ask for the
    same mesh: the last answer is kept.
    """
    return np.array(list(_piercing_edges(mesh)), dtype=np.float64).reshape(-1, 3)


def _piercing_edges(mesh: SurfaceMesh) -> Iterator[list[float]]:
    solid = solid_of(mesh)
    kept = unrounded_mesh_of(solid)
    points, faces = kept.vertices_mm, kept.faces
    pairs = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    edges = pairs[pairs[:, 0] < pairs[:, 1]]  # each edge of a closed oriented mesh once
    places, corners = points.tolist(), faces.tolist()  # lists: a cast ray costs less than an array's index
    for start, end in edges.tolist():
        for hit in solid.ray_cast(tuple(places[start]), tuple(places[end])):
            if start not in (face := corners[hit.face_id]) and end not in face:
                yield places[start]


_REMEDY = "Optimise again on cells of another size, or extract the design of another iteration."


def check_manifold(mesh: SurfaceMesh) -> None:
    """Check that a mesh is a closed, outward 2-manifold without degenerate faces (CRITERION_NOT_MET)."""
    fault = manifold_fault(mesh)
    if fault:
        raise surface_refusal(fault, _REMEDY)


@lru_cache(maxsize=1)
def manifold_fault(mesh: SurfaceMesh) -> str:
    """Tell why a mesh is no closed outward 2-manifold of faces with an area; empty where it is one.

    Extraction and its checks ask for the same mesh: the last answer is kept.
    """
    surface = mesh.as_trimesh()
    if not surface.is_watertight:
        return "not watertight, or more than two faces at an edge"
    if not surface.is_winding_consistent:
        return "its faces are not oriented alike"
    if mesh.volume_mm3 <= 0:
        return f"inside out (volume {mesh.volume_mm3:.3g} mm3)"
    pinched = _pinched_vertices(surface)
    if pinched:
        return f"not a 2-manifold, surfaces touch in {pinched} single vertices"
    degenerate = int((mesh.areas_mm2 <= _DEGENERATE_MM2).sum())
    return f"{degenerate} degenerate faces" if degenerate else ""


def check_self_intersection(mesh: SurfaceMesh) -> None:
    """Check that no edge of a closed mesh pierces a face that it does not touch (CRITERION_NOT_MET)."""
    places = self_intersections_mm(mesh)
    if len(places):
        where = ", ".join(f"{value:.2f}" for value in places[0])
        raise surface_refusal(f"it intersects itself near ({where}) mm", _REMEDY)


def surface_refusal(what: str, remedy: str) -> CranktopoError:
    """Return the error of a surface that fails a check."""
    return CranktopoError(f"surface: {what}.", hint=remedy, code=ExitCode.CRITERION_NOT_MET)


def _pinched_vertices(surface: Any) -> int:
    """Return how many more fans of faces there are than vertices: 0 for a 2-manifold."""
    faces = np.asarray(surface.faces)
    links = []
    for end in (0, 1):
        shared = surface.face_adjacency_edges[:, end]
        # corner number = 3 * face + place of the shared vertex in it
        places = [np.argmax(faces[f] == shared[:, None], axis=1) for f in surface.face_adjacency.T]
        links.append(3 * surface.face_adjacency + np.stack(places, axis=1))
    fans = connected(faces.size, np.concatenate(links)).max() + 1
    return int(fans - len(np.unique(faces)))
