"""A mesh that follows a body of the CAD kernel to other dimensions, its elements and nodes staying the same.

Corners stay corners, nodes on edges keep their share of the edge, nodes on faces slide along them. For any
body that is built anew with the same points, edges and faces; `moved_mesh` knows the faces as formulae and
has gradients.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from cranktopo.base.arrays import Array, Index, Mask
from cranktopo.base.errors import CranktopoError
from cranktopo.numerics.tetrahedra.cad_mesh import TET10
from cranktopo.numerics.tetrahedra.mesh import TetMesh, edge_ends, straighten_folded, volume_ratios
from cranktopo.numerics.tetrahedra.spring_net import SpringNet
from cranktopo.numerics.tetrahedra.stress import boundary_faces

_SPLINES = ("BSpline surface", "Bezier surface")
"""Faces on which the kernel takes 250 us for the nearest point, on others 1: nodes keep their parameters."""
_Structure = tuple[tuple[int, int, str, tuple[int, ...]], ...]
_RATIOS = 0.2, 3.0
"""Volume of a moved element over what it was: beyond, a new mesh is the better one."""


@dataclass(frozen=True)
class _Entity:
    """An edge or a face, with its nodes in a mesh and their shares of its parameters, (n, dimension)."""

    dimension: int
    number: int
    nodes: Index
    shares: Array

    def placed(self, gmsh: Any) -> Array:
        """Return the points of the open session's body at the shares, (3, n)."""
        low, high = _bounds(gmsh, self.dimension, self.number)
        at = (low + self.shares * (high - low)).ravel()
        return _points(gmsh.model.getValue(self.dimension, self.number, at))

    def nearest(self, gmsh: Any, points_mm: Array, own: Mask) -> Array:
        """Return points of a face for some of its nodes: nearest to (3, n), on splines at their shares."""
        if gmsh.model.getType(self.dimension, self.number) in _SPLINES:
            return replace(self, shares=self.shares[own]).placed(gmsh)
        found, _ = gmsh.model.getClosestPoint(self.dimension, self.number, points_mm.T.ravel())
        return _points(found)


class _NodeKinds(NamedTuple):
    """Nodes that move alike, as masks (nodes,): corners of elements, and middles of their edges."""

    corners_on_faces: Mask
    middles_on_faces: Mask
    inner_corners: Mask
    inner_middles: Mask


@dataclass(frozen=True)
class FollowedMesh:
    """A mesh of a body, and where its nodes lie on the points, edges and faces of that body.

    Attributes:
        structure: dimension, number, kind, and what bounds it, of each point, edge and face of the body.
        corners: number of each point of the body and its node.
        parts: edges, then faces.
    """

    mesh: TetMesh
    structure: _Structure
    corners: tuple[tuple[int, int], ...]
    parts: tuple[_Entity, ...]

    def at(self, gmsh: Any) -> TetMesh | None:
        """Return the mesh on the body of the open session; None where another mesh is needed.

        That is so where the body has other points, edges or faces, and where an element would fold, flatten
        or grow too much.
        """
        if _structure(gmsh) != self.structure:
            return None
        on_surface = self.mesh.points_mm + self._motion(gmsh)
        points = np.where(self._unbent, on_surface[:, self._ends].mean(axis=1), on_surface)
        try:
            straight, _ = straighten_folded(points, self.mesh.cells)
        except CranktopoError:
            return None
        ratios = volume_ratios(straight, self.mesh.points_mm, self.mesh.cells)
        if not _RATIOS[0] < ratios.min() <= ratios.max() < _RATIOS[1]:
            return None
        return replace(self.mesh, points_mm=straight, off_surface_mm=on_surface - straight)

    def get_ready(self) -> None:
        """Find what is the same on all bodies, ahead of the first."""
        kinds = self._kinds
        self._skin.filling(np.flatnonzero(kinds.corners_on_faces))
        self._body.filling(np.flatnonzero(kinds.inner_corners))

    def _motion(self, gmsh: Any) -> Array:
        """Return how far all nodes move, (3, nodes)."""
        motion = np.zeros((self.mesh.points_mm.shape[1], 3))
        edges, faces = ([part for part in self.parts if part.dimension == d] for d in (1, 2))
        for number, node in self.corners:
            self._put(motion, np.array([node]), _points(gmsh.model.getValue(0, number, [])))
        for edge in edges:
            self._put(motion, edge.nodes, edge.placed(gmsh))
        kinds = self._kinds
        self._slide(gmsh, motion, faces, kinds.corners_on_faces, self._skin)
        self._slide(gmsh, motion, faces, kinds.middles_on_faces)
        motion[:] = self._body.fill(motion[:, :, None], np.flatnonzero(kinds.inner_corners))[:, :, 0]
        motion[kinds.inner_middles] = motion[self._ends[:, kinds.inner_middles]].mean(axis=0)
        return motion.T

    def _slide(
        self, gmsh: Any, motion: Array, faces: list[_Entity], chosen: Mask, net: SpringNet | None = None
    ) -> None:
        """Move some nodes of faces along them: by a net, or, of middles of edges, with the ends."""
        if net:
            motion[:] = net.fill(motion[:, :, None], np.flatnonzero(chosen))[:, :, 0]
        else:
            motion[chosen] = motion[self._ends[:, chosen]].mean(axis=0)
        for face in faces:
            own = chosen[face.nodes]
            guess = self.mesh.points_mm[:, face.nodes[own]] + motion[face.nodes[own]].T
            self._put(motion, face.nodes[own], face.nearest(gmsh, guess, own))

    def _put(self, motion: Array, nodes: Index, points_mm: Array) -> None:
        motion[nodes] = (points_mm - self.mesh.points_mm[:, nodes]).T

    @property
    def _unbent(self) -> Mask:
        """Nodes that stay in the middle of a straight edge, as their elements would fold, (nodes,)."""
        off = self.mesh.off_surface_mm
        return np.zeros(len(self._ends.T), bool) if off is None else (off != 0.0).any(axis=0)

    @cached_property
    def _kinds(self) -> _NodeKinds:
        corner, on_faces, skin = np.zeros((3, self.mesh.points_mm.shape[1]), dtype=bool)
        corner[self.mesh.cells[:4]] = True
        for part in self.parts:
            on_faces[part.nodes] |= part.dimension == 2
        skin[self._skin_faces] = True
        return _NodeKinds(on_faces & corner, on_faces & ~corner, corner & ~skin, ~corner & ~skin)

    @cached_property
    def _ends(self) -> Index:
        return edge_ends(self.mesh.cells)

    @cached_property
    def _skin_faces(self) -> Index:
        local, owners = boundary_faces(self.mesh.cells)
        return self.mesh.cells[local, owners]

    @cached_property
    def _skin(self) -> SpringNet:
        return SpringNet(self.mesh.points_mm, self._skin_faces[:3])

    @cached_property
    def _body(self) -> SpringNet:
        return SpringNet(self.mesh.points_mm, self.mesh.cells[:4])


def followed_mesh(gmsh: Any, mesh: TetMesh) -> FollowedMesh:
    """Return a mesh with where its nodes lie on the body, in the session that has just made it."""
    tags, _, _ = gmsh.model.mesh.getNodes()
    _, used = gmsh.model.mesh.getElementsByType(TET10)
    number = np.zeros(int(tags.max()) + 1, dtype=np.intp)
    # As `extract_mesh` numbers them: those of elements, in the order of `getNodes`.
    number[tags[np.isin(tags, used)]] = np.arange(mesh.points_mm.shape[1])
    points = [tag for _, tag in gmsh.model.getEntities(0)]
    corners = [(tag, int(number[gmsh.model.mesh.getNodes(0, tag)[0][0]])) for tag in points]
    parts = tuple(_entity(gmsh, number, *one) for d in (1, 2) for one in gmsh.model.getEntities(d))
    return FollowedMesh(mesh, _structure(gmsh), tuple(corners), parts)


def _entity(gmsh: Any, number: Index, dimension: int, tag: int) -> _Entity:
    nodes, _, at = gmsh.model.mesh.getNodes(dimension, tag, False, True)
    low, high = _bounds(gmsh, dimension, tag)
    return _Entity(dimension, tag, number[nodes], (at.reshape(-1, dimension) - low) / (high - low))


def _bounds(gmsh: Any, dimension: int, tag: int) -> tuple[Array, Array]:
    low, high = gmsh.model.getParametrizationBounds(dimension, tag)
    return np.asarray(low), np.asarray(high)


def _structure(gmsh: Any) -> _Structure:
    entities = (entity for d in range(3) for entity in gmsh.model.getEntities(d))
    return tuple(
        (d, tag, gmsh.model.getType(d, tag), tuple(map(int, gmsh.model.getAdjacencies(d, tag)[1])))
        for d, tag in entities
    )


def _points(flat: Array) -> Array:
    return np.asarray(flat, dtype=np.float64).reshape(-1, 3).T
