"""A mesh of a body that follows the parameters of its faces, its elements and nodes staying the same.

Nodes on the faces stay on them and slide along them, edges stay edges; parts of the surface may stand still.
The move is spread over the surface, then through the body, as in a net of springs that are the stiffer the
shorter they are.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Index, all_but
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.numerics.tetrahedra.mesh import TetMesh, edge_ends, least_jacobian_ratio
from cranktopo.numerics.tetrahedra.moving_faces import Contact, LeadingFace, MovingFace
from cranktopo.numerics.tetrahedra.numbered_mesh import numbered_mesh
from cranktopo.numerics.tetrahedra.spring_net import MotionRules, SpringNet
from cranktopo.numerics.tetrahedra.stress import boundary_faces

_ON_FACE_MM = 1e-3
"""Nodes of a mesh lie on the exact surface to the accuracy of the CAD kernel's edges."""
_SETTLED_MM = 1e-9
_ROUNDS = 12


Stands = Callable[[Array], NDArray[np.bool_]]
"""Mask (f,) of the faces of elements that stand still, from their nodes (3, 6, f), corners first."""


class MovedMesh:
    """A mesh of a body, numbered as scikit-fem does, and how it moves with the parameters of its faces."""

    def __init__(
        self, mesh: TetMesh, faces: Sequence[MovingFace], values: Array, stands: Stands, body: str
    ) -> None:
        """Find the nodes of each face.

        Args:
            values: of the parameters, with which the mesh was made.
            body: what the faces are of, for messages.

        Raises:
            CranktopoError: part of the surface that moves belongs to no face.
        """
        self.mesh, self.values = _numbered(mesh), np.asarray(values, dtype=np.float64)
        self._faces, self._body_name = list(faces), body
        self._surface, self._triangles, self._on, self._still = _surface_nodes(
            self.mesh, self._faces, self.values, stands, body
        )
        self._corners = int(self.mesh.cells[:4].max()) + 1
        self._ends = edge_ends(self.mesh.cells)[:, self._corners :]
        corners = self.mesh.points_mm[:, : self._corners]
        self._skin = SpringNet(corners, self._triangles)
        self._body = SpringNet(corners, self.mesh.cells[:4])

    def distances_mm(self, points_mm: Array, values: Array) -> Array:
        """Return the largest distance of the surface nodes from each of their faces, mm, (faces,)."""
        found = [contact.distance_mm for _, _, contact in self._contacts(points_mm, values)]
        return np.array([np.abs(d).max() if len(d) else 0.0 for d in found])

    def at(self, values: Array) -> TetMesh:
        """Return the mesh of the body with other values; with its own it is as it was made.

        There the nodes are off the faces by what the CAD kernel's edges are, and a flat element may fold when
        they are put right.

        Raises:
            CranktopoError: the move is too large for this mesh.
        """
        if np.array_equal(values, self.values):
            return self.mesh
        start, moved = self.mesh.points_mm, np.zeros_like(self.mesh.points_mm)
        for _ in range(_ROUNDS):
            contacts = self._contacts(start + moved, values)
            if max(np.abs(c.distance_mm).max(initial=0.0) for _, _, c in contacts) < _SETTLED_MM:
                break
            here = moved[:, self._surface].T
            normal_motions = [
                (c.normal * here[nodes]).sum(axis=1)[:, None] - c.distance_mm[:, None] / c.steepness
                for nodes, _, c in contacts
            ]
            led = [way[:, :, None] for way in self._led(values)]
            moved = self._spread(self._rules(contacts, normal_motions, led))[:, :, 0]
        mesh = replace(self.mesh, points_mm=start + moved)
        if self.quality(mesh) <= 0:
            raise CranktopoError(
                f"mesh: an element folds while the {self._body_name}'s dimensions change.",
                hint="Make a new mesh, or smaller steps.",
                code=ExitCode.SOLVER,
            )
        return mesh

    def quality(self, mesh: TetMesh) -> float:
        """Return the minimum Jacobian of the elements over what it was at first; 0 or less is folded."""
        return least_jacobian_ratio(mesh.points_mm, self.mesh.points_mm, self.mesh.cells)

    def velocities(self, mesh: TetMesh, values: Array) -> Array:
        """Return the motion of the nodes per mm or degree of each parameter, (3, nodes, parameters)."""
        contacts, at = self._contacts(mesh.points_mm, values), mesh.points_mm[:, self._surface]
        normal_motions = [-face.gradients(at[:, nodes], values) / c.steepness for nodes, face, c in contacts]
        led = [face.velocities(start, self.values, values) for face, start in self._leading()]
        return self._spread(self._rules(contacts, normal_motions, led))

    def _contacts(self, points_mm: Array, values: Array) -> list[tuple[Index, MovingFace, Contact]]:
        """Return each face with its nodes as positions among the surface nodes."""
        at = points_mm[:, self._surface]
        pairs = [(np.flatnonzero(on), face) for on, face in zip(self._on, self._faces, strict=True)]
        return [(nodes, face, face.contact(at[:, nodes], values)) for nodes, face in pairs]

    def _led(self, values: Array) -> list[Array]:
        """Return the motion of the nodes of leading faces from the first mesh, (n, 3)."""
        return [(face.moved(start, self.values, values) - start).T for face, start in self._leading()]

    def _leading(self) -> Iterator[tuple[LeadingFace, Array]]:
        """Yield the leading faces and the places of their nodes in the first mesh, (3, n)."""
        for on, face in zip(self._on, self._faces, strict=True):
            if isinstance(face, LeadingFace):
                yield face, self.mesh.points_mm[:, self._surface[on]]

    def _rules(
        self, contacts: list[tuple[Index, MovingFace, Contact]], normal_motions: list[Array], led: list[Array]
    ) -> MotionRules:
        """Return the rules of motions along each face's normal, (n, k), and of leading faces, (n, 3, k)."""
        count = len(self._surface)
        matrix, motions = np.zeros((count, 3, 3)), np.zeros((count, 3, normal_motions[0].shape[1]))
        for (nodes, _, contact), motion in zip(contacts, normal_motions, strict=True):
            matrix[nodes] += contact.normal[:, :, None] * contact.normal[:, None, :]
            motions[nodes] += contact.normal[:, :, None] * motion[:, None, :]
        matrix[self._still], motions[self._still] = np.eye(3), 0.0
        leading = [nodes for nodes, face, _ in contacts if isinstance(face, LeadingFace)]
        for nodes, way in zip(leading, led, strict=True):
            matrix[nodes], motions[nodes] = np.eye(3), way
        return MotionRules(matrix, motions)

    def _spread(self, rules: MotionRules) -> Array:
        """Return the motion of all nodes, (3, nodes, k), from what holds the surface nodes."""
        count = rules.prescribed.shape[2]
        motion = np.zeros((self.mesh.points_mm.shape[1], 3, count))
        corner = self._surface < self._corners
        corners = self._surface[corner]
        own = MotionRules(rules.matrix[corner], rules.prescribed[corner])
        motion[corners] = self._skin.slide(corners, own)
        inner = all_but(self._corners, corners)
        motion[: self._corners] = self._body.fill(motion[: self._corners], inner)
        motion[self._corners :] = motion[self._ends].mean(axis=0)
        middle = self._surface[~corner]
        rest = MotionRules(rules.matrix[~corner], rules.prescribed[~corner])
        motion[middle] = rest.minimum_motion(motion[middle])
        return motion.transpose(1, 0, 2)


def _numbered(mesh: TetMesh) -> TetMesh:
    """Return the mesh with its nodes numbered as scikit-fem numbers them, corners first."""
    body = numbered_mesh(mesh.points_mm, mesh.cells)
    return TetMesh(body.doflocs, body.dofs.element_dofs, mesh.mirrored)


def _surface_nodes(
    mesh: TetMesh, faces: list[MovingFace], values: Array, stands: Stands, body: str
) -> tuple[Index, Index, NDArray[np.bool_], NDArray[np.bool_]]:
    """Return surface nodes, corners of the triangles (3, f), which node is on which face, which stand still.

    Raises:
        CranktopoError: part of the surface that moves belongs to none of the faces.
    """
    local, owners = boundary_faces(mesh.cells)
    numbers = mesh.cells[local, owners]
    points = mesh.points_mm[:, numbers]  # (3, 6, f)
    away = stands(points)
    face = _face_of(points, faces, values)
    lost = ~away & (face < 0)
    if lost.any():
        x, y, z = points[:, :3, lost][:, :, 0].mean(axis=1)
        raise CranktopoError(
            f"mesh: the surface at x {x:.2f}, y {y:.2f}, z {z:.2f} mm belongs to no face of the {body}.",
            hint="Report this design.",
            code=ExitCode.INTERNAL,
        )
    surface = np.unique(numbers)
    place = np.zeros(mesh.points_mm.shape[1], dtype=np.intp)
    place[surface] = np.arange(len(surface))
    on, last = np.zeros((len(faces), len(surface)), dtype=bool), 0
    for k, one in enumerate(faces):
        last = last if one.seam else k
        own = np.unique(place[numbers[:, ~away & (face == k)]])
        nodes = np.flatnonzero(on[last]) if one.seam else own
        near = one.contact(mesh.points_mm[:, surface[nodes]], values).distance_mm
        on[k, nodes[np.abs(near) < _ON_FACE_MM]] = True  # edge nodes of straightened elements are off it
    still = np.zeros(len(surface), dtype=bool)
    still[np.unique(place[numbers[:, away]])] = True
    on[:, still] = False  # a node that stands still leaves faces that move away from it
    return surface, numbers[:3], on, still


def _face_of(points: Array, faces: list[MovingFace], values: Array) -> Index:
    """Return the face of each triangle, (f,), the most parallel one through its corners; -1 for none."""
    corners = points[:, :3]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], axis=0)
    across /= np.linalg.norm(across, axis=0)
    best, found = np.zeros(points.shape[2]), np.full(points.shape[2], -1)
    for k, face in enumerate(faces):
        if face.seam:
            continue
        contact = face.contact(corners.reshape(3, -1), values)
        near = (np.abs(contact.distance_mm).reshape(3, -1) < _ON_FACE_MM).all(axis=0)
        gradient = contact.gradient.reshape(3, -1, 3).mean(axis=0).T
        parallel = np.where(near, np.abs((gradient * across).sum(axis=0)), 0.0)
        found[parallel > best] = k
        best = np.maximum(best, parallel)
    return found
