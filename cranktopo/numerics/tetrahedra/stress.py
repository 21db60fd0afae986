"""Stresses of displacement fields on ten-node tetrahedra: at nodes, and on the surface with gradients."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Index
from cranktopo.base.notes import at_work
from cranktopo.base.side_by_side import in_halves, side_by_side
from cranktopo.numerics.tetrahedra.elasticity import (
    STIFFNESS_ORDER,
    Elasticity,
    inverse_jacobians,
    quadrature,
)
from cranktopo.numerics.tetrahedra.mesh import EDGES, TRIANGLE_EDGES, node_points, shape_gradients
from cranktopo.numerics.tetrahedra.numbered_mesh import row_keys

DEVIATOR = np.zeros((6, 6))
DEVIATOR[:3, :3] = 1.5 * np.eye(3) - 0.5
DEVIATOR[3:, 3:] = 3 * np.eye(3)
"""Quadratic form of the squared von Mises stress in the six components."""


def von_mises(stress: Array) -> Array:
    """Return the von Mises stress; last axis holds the six components."""
    squared: Array = np.einsum("...i,ij,...j->...", stress, DEVIATOR, stress)
    return np.sqrt(np.maximum(squared, 0.0))


def strain_energy_density(stress: Array, youngs_MPa: float, poisson: float) -> Array:
    """Return the elastic energy per volume, MPa, of an isotropic body; last axis holds the six components."""
    trace_squared = stress[..., :3].sum(axis=-1) ** 2
    squares = (stress[..., :3] ** 2).sum(axis=-1) + 2 * (stress[..., 3:] ** 2).sum(axis=-1)
    energy: Array = ((1 + poisson) * squares - poisson * trace_squared) / (2 * youngs_MPa)
    return energy


def principal_stresses(stress: Array) -> Array:
    """Return principal stresses, falling, in the last axis; that of the argument holds the six components."""
    tensor = stress[..., [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(*stress.shape[:-1], 3, 3)
    return np.asarray(np.linalg.eigvalsh(tensor)[..., ::-1], dtype=np.float64)


@dataclass(frozen=True)
class NodalStress:
    """Stresses brought from quadrature points to the nodes.

    Attributes:
        elements: nodes of each element, shape (10, elements).
        element_MPa: linear extrapolation inside each element, shape (fields, elements, 10, 6).
        nodal_MPa: mean over the elements around each node, by volume, shape (fields, nodes, 6).
    """

    elements: NDArray[np.intp]
    element_MPa: Array
    nodal_MPa: Array


@at_work("stresses at all nodes")
def nodal_stress(model: Elasticity, displacement_mm: Array, youngs_MPa: float, poisson: float) -> NodalStress:
    """Return the stresses of displacement fields (fields, unknowns) at all nodes.

    The four points of the stiffness are where stresses of quadratic elements converge fastest; a linear field
    through them gives the corners, and the means of corners the edge nodes (Barlow, Int. J. Num. Meth. Eng.,
    1976).
    """
    cells, spread = model.mesh.dofs.element_dofs, nodes_from_points(quadrature(STIFFNESS_ORDER)[0][:, 1:].T)
    element, volume = np.empty((len(displacement_mm), cells.shape[1], 10, 6)), np.empty(cells.shape[1])

    def bring(which: slice, stress: Array, dx: Array) -> None:
        element[:, which] = np.einsum("nq,feqc->fenc", spread, stress, optimize=True)
        volume[which] = dx.sum(axis=1)

    _by_chunks(model, np.arange(cells.shape[1]), displacement_mm, (youngs_MPa, poisson), bring)
    return _averaged(cells, volume, element)


def point_stresses(
    model: Elasticity, elements: Index, displacement_mm: Array, youngs_MPa: float, poisson: float
) -> Array:
    """Return the stresses of displacement fields (fields, unknowns) at the points of the stiffness, MPa.

    Of some elements, shape (fields, elements, points, 6).
    """
    found = np.empty((len(displacement_mm), len(elements), len(quadrature(STIFFNESS_ORDER)[1]), 6))

    def keep(which: slice, stress: Array, _: Array) -> None:
        found[:, which] = stress

    _by_chunks(model, elements, displacement_mm, (youngs_MPa, poisson), keep)
    return found


def _by_chunks(
    model: Elasticity,
    elements: Index,
    displacement_mm: Array,
    elastic: tuple[float, float],
    take: Callable[[slice, Array, Array], None],
) -> None:
    """Hand on some elements at a time, by two threads.

    Args:
        take: called with a slice of the elements, the stresses at their points (fields, elements, points, 6),
            and the volumes of these.
    """
    cells = model.mesh.dofs.element_dofs[:, elements]
    reference = shape_gradients(quadrature(STIFFNESS_ORDER)[0])
    fields = displacement_mm.reshape(len(displacement_mm), -1, 3)

    def half(some: slice) -> None:
        own = cells[:, some]
        for which, inverse, dx in inverse_jacobians(model.mesh, elements[some]):
            shapes = np.einsum("qnj,ijeq->qien", reference, inverse, optimize=True)
            slopes = np.einsum("qien,fnea->feqai", shapes, fields[:, own[:, which]], optimize=True)
            first = some.start + which.start
            take(slice(first, first + len(dx)), hooke(tensor_strain(slopes), *elastic), dx)

    in_halves(len(elements), half)


def _averaged(elements: NDArray[np.intp], volume: Array, element: Array) -> NodalStress:
    count = int(elements.max()) + 1
    flat = elements.T.ravel()
    matrix = sp.csr_matrix((np.repeat(volume, 10), (flat, np.arange(flat.size))), (count, flat.size))
    total = np.asarray(matrix.sum(axis=1))
    nodal = np.empty((len(element), count, 6))

    def average(some: slice) -> None:
        for mean, field in zip(nodal[some], element[some], strict=True):
            np.divide(matrix @ field.reshape(-1, 6), total, out=mean)

    in_halves(len(element), average)
    return NodalStress(elements, element, nodal)


def nodes_from_points(points: Array) -> Array:
    """Return values at the ten nodes from those at four points of the reference element, shape (10, 4)."""
    barycentric = np.vstack([1 - points.sum(axis=0), points])
    corners = np.linalg.inv(barycentric.T)
    middles = [(corners[a] + corners[b]) / 2 for a, b in EDGES]
    return np.vstack([corners, middles])


def tensor_strain(slopes: Array) -> Array:
    """Return tensor strains (..., 6), xx, yy, zz, xy, yz, zx, of displacement gradients (..., 3, 3)."""
    strain = (slopes + slopes.swapaxes(-1, -2)) / 2
    return np.asarray(strain[..., (0, 1, 2, 0, 1, 2), (0, 1, 2, 1, 2, 0)])


def hooke(strain: Array, youngs_MPa: float, poisson: float) -> Array:
    """Return the stresses of tensor strains (..., 6), MPa, of the same shape."""
    shear = youngs_MPa / (2 * (1 + poisson))
    lame = 2 * shear * poisson / (1 - 2 * poisson)
    stress = 2 * shear * strain
    stress[..., :3] += lame * strain[..., :3].sum(axis=-1, keepdims=True)
    return np.asarray(stress)


_CORNERS = ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3))
_PLANE_MM = 1e-6


@dataclass(frozen=True)
class Surface:
    """Outer surface of the model, without its planes of symmetry and its end section.

    Attributes:
        nodes: their numbers in the mesh, shape (n,).
        points_mm: shape (3, n).
        normals: outward unit normals, shape (n, 3).
        faces: six nodes of each face (corners, edge nodes 01 12 20) as positions in `nodes`, shape (6, f).
        owners: element of each face, shape (f,).
        local: the face's six nodes as numbers 0 to 9 inside that element, shape (6, f).
    """

    nodes: Index
    points_mm: Array
    normals: Array
    faces: Index
    owners: Index
    local: Index


@dataclass(frozen=True)
class SurfaceStress:
    """Stresses (fields, n, 6), and derivatives into the depth, at the nodes of a surface.

    The jump (fields, n) is the largest departure of an element's von Mises stress from that of the nodal
    mean.
    """

    stress_MPa: Array
    depth_MPa_per_mm: Array
    jump_MPa: Array

    def at(self, nodes: Index) -> SurfaceStress:
        """Return that of some nodes, in one piece of memory."""
        fields = self.stress_MPa, self.depth_MPa_per_mm, self.jump_MPa
        return SurfaceStress(*(np.ascontiguousarray(field[:, nodes]) for field in fields))


def joined(parts: Sequence[SurfaceStress]) -> SurfaceStress:
    """Return the fields of several at the same nodes as one."""
    return SurfaceStress(
        np.concatenate([part.stress_MPa for part in parts]),
        np.concatenate([part.depth_MPa_per_mm for part in parts]),
        np.concatenate([part.jump_MPa for part in parts]),
    )


def outer_surface(model: Elasticity, elements: Index, planes: tuple[tuple[int, float], ...]) -> Surface:
    """Return faces of one element only that lie in none of the planes (axis, mm) of symmetry or ends."""
    local, owners = boundary_faces(elements)
    numbers = elements[local, owners]
    points = model.nodes_mm[:, numbers]  # (3, 6, faces)
    inner = np.ones(len(owners), dtype=bool)
    for axis, position in planes:
        inner &= ~(np.abs(points[axis, :3] - position) < _PLANE_MM).all(axis=0)
    local, owners, numbers = local[:, inner], owners[inner], numbers[:, inner]
    nodes, faces = np.unique(numbers, return_inverse=True)
    faces = faces.reshape(numbers.shape)
    normals = _normals(model, elements, numbers, owners, faces, len(nodes))
    return Surface(nodes, model.nodes_mm[:, nodes], normals, faces, owners, local)


def surface_stress(model: Elasticity, surface: Surface, nodal_stress: NodalStress) -> SurfaceStress:
    """Return nodal stresses on the surface, their derivative into the depth, and the jumps between elements.

    The derivative is that of the nodal stresses interpolated by the element's shape functions, averaged over
    the faces that meet at a node.
    """
    depth, jumps = side_by_side(
        lambda: _depth(model, surface, nodal_stress), lambda: _jumps(surface, nodal_stress)
    )
    return SurfaceStress(nodal_stress.nodal_MPa[:, surface.nodes], depth, jumps)


def outward_faces(surface: Surface) -> Index:
    """Return the faces (f, 6), their corners counter-clockwise as seen from outside."""
    faces = surface.faces.T
    a, b, c = (surface.points_mm[:, faces[:, i]] for i in range(3))
    normal = np.cross((b - a).T, (c - a).T)
    inward = (normal * surface.normals[faces[:, :3]].mean(axis=1)).sum(axis=1) < 0
    return np.where(inward[:, None], turned_faces(faces), faces)


def turned_faces(faces: Index) -> Index:
    """Return six-node faces (f, 6) seen from their other side."""
    return faces[:, [0, 2, 1, 5, 4, 3]]


def boundary_faces(elements: Index) -> tuple[Index, Index]:
    """Return local node numbers (6, f) and owners (f,) of the faces that occur once in elements (10, n)."""
    count = elements.shape[1]
    corners = np.sort(np.stack([elements[list(face)] for face in _CORNERS]), axis=1)  # (4, 3, elements)
    keys = row_keys(corners.transpose(1, 0, 2).reshape(3, -1))
    _, first, times = np.unique(keys, return_index=True, return_counts=True)
    alone = first[times == 1]
    side, owners = alone // count, alone % count
    edge = {tuple(sorted(pair)): 4 + i for i, pair in enumerate(EDGES)}
    full = np.array([[a, b, c, edge[a, b], edge[b, c], edge[a, c]] for a, b, c in _CORNERS], dtype=np.intp)
    return full[side].T, owners


def _normals(
    model: Elasticity, elements: Index, numbers: Index, owners: Index, faces: Index, count: int
) -> Array:
    at = model.nodes_mm[:, numbers]
    normal = face_normals(at)
    inside = model.nodes_mm[:, elements[:4, owners]].mean(axis=1) - at[:, :3].mean(axis=1)
    normal *= -np.sign((normal.mean(axis=1) * inside).sum(axis=0))
    total = np.zeros((count, 3))
    np.add.at(total, faces, normal.transpose(1, 2, 0))
    return np.asarray(total / np.linalg.norm(total, axis=1, keepdims=True))


def face_normals(at: Array) -> Array:
    """Return normals (3, 6, faces) at the nodes `at` of curved faces, of either sign and no unit length."""
    tangents = np.einsum("inf,pnk->ikpf", at, triangle_gradients())
    return np.cross(tangents[:, 0], tangents[:, 1], axis=0)


def triangle_gradients() -> Array:
    """Return gradients of the six-node triangle's shape functions at its nodes, shape (6 points, 6, 2)."""
    points = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [0.5, 0.5, 0], [0, 0.5, 0.5], [0.5, 0, 0.5]])
    return shape_gradients(points, TRIANGLE_EDGES)


def _depth(model: Elasticity, surface: Surface, nodal_stress: NodalStress) -> Array:
    """Derivative of the nodal stresses along the inward normal, shape (fields, n, 6)."""
    cells = nodal_stress.elements[:, surface.owners]
    nodes = model.nodes_mm[:, cells]  # (3, 10, f)
    reference = shape_gradients(node_points())[surface.local]  # (6, f, 10, 3)
    jacobian = np.einsum("inf,pfnj->pfij", nodes, reference, optimize=True)
    inward = -surface.normals[surface.faces]  # (6, f, 3)
    direction = np.linalg.solve(jacobian, inward[..., None])[..., 0]
    weights = np.einsum("pfnj,pfj->pfn", reference, direction, optimize=True)
    total = np.zeros((len(nodal_stress.nodal_MPa), len(surface.nodes), 6))
    number = np.bincount(surface.faces.ravel(), minlength=len(surface.nodes))
    for field, stress in zip(total, nodal_stress.nodal_MPa, strict=True):
        slope = np.einsum("pfn,nfc->pfc", weights, stress[cells], optimize=True)
        np.add.at(field, surface.faces, slope)
    return total / number[:, None]


def _jumps(surface: Surface, stress: NodalStress) -> Array:
    position = np.full(stress.nodal_MPa.shape[1], -1)
    position[surface.nodes] = np.arange(len(surface.nodes))
    where = position[stress.elements.T]  # (elements, 10)
    touching = where >= 0
    jump = np.zeros((len(stress.nodal_MPa), len(surface.nodes)))
    for field, element, nodal in zip(jump, stress.element_MPa, stress.nodal_MPa, strict=True):
        mean = von_mises(nodal)[stress.elements.T[touching]]
        np.maximum.at(field, where[touching], np.abs(von_mises(element[touching]) - mean))
    return jump
