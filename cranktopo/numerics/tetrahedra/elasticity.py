"""Linear elasticity on curved tetrahedra: stiffness matrix and loads, through scikit-fem."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Index
from cranktopo.base.errors import solver_error
from cranktopo.base.notes import at_work
from cranktopo.base.side_by_side import side_by_side
from cranktopo.numerics.tetrahedra.connections import connections
from cranktopo.numerics.tetrahedra.earlier_bodies import EarlierBodies
from cranktopo.numerics.tetrahedra.mesh import TRIANGLE_EDGES, TetMesh, shape_gradients, shape_values
from cranktopo.numerics.tetrahedra.solver import Equations
from cranktopo.numerics.tetrahedra.symmetric_blocks import BlockSum, SymmetricBlocks

Order = Literal[1, 2]
"""Degree of the displacements in an element; its shape is quadratic in either case."""

_CHUNK = 4000
_CORNER_SLOPES = np.vstack([-np.ones(3), np.eye(3)])
"""Gradients of the linear shape functions."""
STIFFNESS_ORDER = 2
"""Quadrature order of the stiffness: four points, exact on straight elements, as C3D10 elsewhere."""
LOAD_ORDER = 6
_PLANE_MM = 1e-9
"""Quadrature points on an element's face that lies in a plane count as inside, whatever their rounding."""


@dataclass(frozen=True)
class Elasticity:
    """An assembled elastic body.

    Attributes:
        nodes_mm: shape (3, nodes), corners first; the corners alone if `order`, of displacements, is 1.
        equations: stiffness over unknowns 3 node + axis, N/mm, and its solver.
    """

    nodes_mm: Array
    equations: Equations
    mesh: Any
    volume_mm3: float
    order: Order = 2

    @property
    def stiffness(self) -> SymmetricBlocks:
        """Matrix over unknowns 3 node + axis, N/mm."""
        return self.equations.stiffness

    def volume_error(self, copies: int, volume_mm3: float) -> float:
        """Return the volume of so many such bodies over the exact one, less one."""
        return copies * self.volume_mm3 / volume_mm3 - 1


@at_work("stiffness matrix")
def assemble(
    mesh: TetMesh,
    youngs_MPa: float,
    poisson: float,
    order: Order = 2,
    earlier: EarlierBodies | None = None,
) -> Elasticity:
    """Assemble the isotropic stiffness matrix; order 1 is only for comparison with quadratic elements.

    Args:
        earlier: what was solved on the same elements before they moved; solves begin there and are added.
    """
    known = earlier.connections if earlier else None
    connected = known or connections(mesh)
    if earlier:
        earlier.connections = connected
    body = connected.moved(mesh) if known else connected.body
    patterns = [connected.linear, connected.quadratic] if order == 2 else [connected.linear]
    sums = [BlockSum(pattern) for pattern in patterns]
    lame = lame_constants_MPa(youngs_MPa, poisson)
    first, second, between = connected.apart
    volumes = side_by_side(
        lambda: _add_elements(body, first, sums, lame), lambda: _add_elements(body, second, sums, lame)
    )
    volume = sum(volumes) + _add_elements(body, between, sums, lame)
    matrices = [part.matrix() for part in sums]
    linear = matrices[0].tocsr() if order == 2 else None
    equations = Equations(matrices[-1], linear, connected.prolongation, earlier)
    nodes = body.doflocs if order == 2 else body.doflocs[:, : body.nvertices]
    return Elasticity(nodes, equations, body, volume, order)


def _add_elements(body: Any, elements: Index, parts: Sequence[BlockSum], lame: tuple[float, float]) -> float:
    """Add elements to the matrices of linear and of quadratic displacements; return their volume."""
    reference = shape_gradients(quadrature(STIFFNESS_ORDER)[0])  # (points, 10, 3)
    kinds = np.broadcast_to(_CORNER_SLOPES, (len(reference), 4, 3)), reference
    volume = 0.0
    for which, inverse, dx in inverse_jacobians(body, elements):
        volume += float(dx.sum())
        for part, kind in zip(parts, kinds, strict=False):
            part.add(elements[which], np.einsum("qnj,ijeq->eniq", kind, inverse), dx, lame)
    return volume


def inverse_jacobians(
    body: Any, elements: Index, order: int = STIFFNESS_ORDER
) -> Iterator[tuple[slice, Array, Array]]:
    """Yield some thousand of the elements, inverse Jacobian matrices of their points and volumes of these.

    The points are those of a quadrature, by default of the stiffness; inverses (place, reference, elements,
    points), volumes (elements, points). Each part is a slice of the elements.

    Raises:
        CranktopoError: an element is inverted.
    """
    points, weights = quadrature(order)
    reference = shape_gradients(points)
    for start in range(0, len(elements), _CHUNK):
        which = slice(start, start + _CHUNK)
        rows = _jacobians(body, elements[which], reference)
        inverse = np.stack([_crossed(*pair) for pair in ((rows[1], rows[2]), (rows[2], rows[0]), rows[:2])])
        determinant = _product(rows[0], inverse[0])
        if determinant.min() <= 0:
            raise solver_error("mesh: an element is inverted.", "Choose another element size.")
        inverse /= determinant
        yield which, inverse, determinant * weights


def quadrature(order: int) -> tuple[Array, Array]:
    """Return barycentric points of a tetrahedron, (points, 4), and their weights."""
    from skfem.quadrature import get_quadrature
    from skfem.refdom import RefTet

    points, weights = get_quadrature(RefTet, order)
    return np.vstack([1 - points.sum(axis=0), points]).T, weights


def triangle_quadrature(order: int) -> tuple[Array, Array, Array]:
    """Return shape functions of six-node triangles at points (points, 6), their slopes, and weights."""
    from skfem.quadrature import get_quadrature
    from skfem.refdom import RefTri

    (u, v), weights = get_quadrature(RefTri, order)
    points = np.stack([1 - u - v, u, v], axis=1)
    return shape_values(points, TRIANGLE_EDGES), shape_gradients(points, TRIANGLE_EDGES), weights


def _jacobians(body: Any, which: Index, reference: Array) -> Array:
    """Return Jacobian matrices, (place, reference, elements, points): whole arrays are crossed at once."""
    nodes = body.doflocs[:, body.dofs.element_dofs[:, which]]
    return np.asarray(np.einsum("ine,qnj->ijeq", nodes, reference, optimize=True))


def _crossed(one: Array, other: Array) -> Array:
    """Return cross products of vectors along the first axis."""
    (a, b, c), (d, e, f) = one, other
    return np.stack([b * f - c * e, c * d - a * f, a * e - b * d])


def _product(one: Array, other: Array) -> Array:
    """Return scalar products of vectors along the first axis."""
    return np.asarray(one[0] * other[0] + one[1] * other[1] + one[2] * other[2])


def _element(order: Order) -> Any:
    from skfem import ElementTetP1, ElementTetP2

    return ElementTetP2() if order == 2 else ElementTetP1()


def mean_displacement(model: Elasticity, axis: int, z_from_mm: float, z_to_mm: float = math.inf) -> Array:
    """Return m with m.u = mean of one displacement component over material between two z, (unknowns,).

    The same vector, times a force, is the load of that force spread evenly over that material. Elements that
    straddle z are integrated over their inside quadrature points.
    """
    elements, inside = _between(model, z_from_mm, z_to_mm)
    mean = np.zeros(model.nodes_mm.shape)
    mean[axis] = gathered(model, elements, inside) / inside.sum()
    return mean.T.ravel()


def _between(model: Elasticity, z_from_mm: float, z_to_mm: float) -> tuple[NDArray[np.intp], Array]:
    """Return the elements that reach between two z, and the weights of their points there, mm3."""
    heights = model.mesh.p[2][model.mesh.t]
    reach = (heights.max(axis=0) > z_from_mm + _PLANE_MM) & (heights.min(axis=0) < z_to_mm - _PLANE_MM)
    elements = np.nonzero(reach)[0]
    (_, _, z), dx = load_points(model, elements)
    return elements, dx * ((z > z_from_mm - _PLANE_MM) & (z < z_to_mm + _PLANE_MM))


def load_points(model: Elasticity, elements: NDArray[np.intp]) -> tuple[Array, Array]:
    """Return the quadrature points of loads, (3, elements, points), and the weights of each, mm3."""
    points, weights = quadrature(LOAD_ORDER)
    reference, values = shape_gradients(points), shape_values(points)
    nodes = model.mesh.doflocs[:, model.mesh.dofs.element_dofs[:, elements]]
    places = np.einsum("ine,qn->ieq", nodes, values, optimize=True)
    starts = range(0, len(elements), _CHUNK)
    parts = (_jacobians(model.mesh, elements[start : start + _CHUNK], reference) for start in starts)
    return places, np.concatenate([_product(a, _crossed(b, c)) for a, b, c in parts]) * weights


def gathered(model: Elasticity, elements: NDArray[np.intp], weights: Array) -> Array:
    """Return what weights at the points of loads give the nodes by the shape functions, (nodes,)."""
    points, _ = quadrature(LOAD_ORDER)
    values = shape_values(points) if model.order == 2 else points
    dofs = model.mesh.dofs.element_dofs if model.order == 2 else model.mesh.t
    shares = values.T @ weights.T
    total = np.bincount(dofs[:, elements].ravel(), shares.ravel(), minlength=model.nodes_mm.shape[1])
    return np.asarray(total, dtype=np.float64)


def basis_above_plane(model: Elasticity, z_from_mm: float, z_to_mm: float = math.inf) -> tuple[Any, Array]:
    """Return the basis of the elements that reach beyond z, and the weights of its points there, mm3."""
    from skfem import Basis

    elements, inside = _between(model, z_from_mm, z_to_mm)
    return Basis(model.mesh, _element(model.order), intorder=LOAD_ORDER, elements=elements), inside


def centrifugal_force(model: Elasticity, density_tonne_per_mm3: float) -> Array:
    """Return the nodal forces of rotation about the z axis at 1 rad/s, shape (unknowns,), N."""
    elements = np.arange(model.mesh.nelements)
    places, dx = load_points(model, elements)
    force = np.zeros(model.nodes_mm.shape)
    for axis in (0, 1):
        force[axis] = gathered(model, elements, density_tonne_per_mm3 * places[axis] * dx)
    return force.T.ravel()


def swing_force(model: Elasticity) -> Array:
    """Return the nodal forces by which the mass resists an angular acceleration about the z axis.

    Every part pushes across its radius, by mass and radius; about -z all push with 1 N mm. (unknowns,), N.
    """
    outward = centrifugal_force(model, 1.0).reshape(-1, 3)
    inertia = float((outward[:, :2] * model.nodes_mm[:2].T).sum())
    across = np.stack([outward[:, 1], -outward[:, 0], np.zeros(len(outward))], axis=1)
    return np.asarray(across.ravel() / inertia)


@at_work("mass matrix")
def mass_matrix(
    model: Elasticity, density_tonne_per_mm3: float, elements: NDArray[np.intp] | None = None
) -> sp.csr_matrix:
    """Return the consistent mass of the nodes, (nodes, nodes), tonne, the same along each axis.

    Args:
        elements: those that have any; all by default.
    """
    chosen = np.arange(model.mesh.nelements) if elements is None else elements
    points, _ = quadrature(LOAD_ORDER)
    values = shape_values(points) if model.order == 2 else points
    pairs = (values[:, :, None] * values[:, None, :]).reshape(len(values), -1)
    dofs = (model.mesh.dofs.element_dofs if model.order == 2 else model.mesh.t)[:, chosen]
    _, dx = load_points(model, chosen)
    rows = np.broadcast_to(dofs[:, None, :], (len(dofs), *dofs.shape))
    mass = density_tonne_per_mm3 * (dx @ pairs).T.reshape(rows.shape)
    size = (model.nodes_mm.shape[1],) * 2
    return sp.coo_matrix((mass.ravel(), (rows.ravel(), np.swapaxes(rows, 0, 1).ravel())), size).tocsr()


def lame_constants_MPa(youngs_MPa: float, poisson: float) -> tuple[float, float]:
    """Return Lame's first constant and the shear modulus."""
    return youngs_MPa * poisson / ((1 + poisson) * (1 - 2 * poisson)), youngs_MPa / (2 * (1 + poisson))
