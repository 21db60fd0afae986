"""Linear elasticity on curved tetrahedra: stiffness matrix and mean displacement, through scikit-fem."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal

import numpy as np
import scipy.sparse as sp

from cranktopo.base.arrays import Array
from cranktopo.base.errors import solver_error
from cranktopo.base.side_by_side import side_by_side
from cranktopo.numerics.tetrahedra.mesh import TetMesh

Order = Literal[1, 2]
"""Degree of the displacements in an element; its shape is quadratic in either case."""

_CHUNK = 4000
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
        stiffness: matrix over unknowns 3 node + axis, N/mm.
        prolongation: linear to quadratic interpolation over unknowns, shape (3 nodes, 3 corners).
    """

    nodes_mm: Array
    stiffness: sp.csr_matrix
    prolongation: sp.csr_matrix
    mesh: Any
    volume_mm3: float
    order: Order = 2


def assemble(mesh: TetMesh, youngs_MPa: float, poisson: float, order: Order = 2) -> Elasticity:
    """Assemble the isotropic stiffness matrix; order 1 is only for comparison with quadratic elements."""
    from skfem import MeshTet2

    body = MeshTet2(mesh.points_mm, mesh.cells)
    nodes = body.doflocs if order == 2 else body.doflocs[:, : body.nvertices]
    middle = body.nelements // 2
    matrix = partial(_matrix, body, order, youngs_MPa, poisson)
    (first, one), (second, two) = side_by_side(
        lambda: matrix(0, middle), lambda: matrix(middle, body.nelements)
    )
    coarse = _prolongation(body) if order == 2 else sp.identity(nodes.size, format="csr")
    return Elasticity(nodes, first + second, coarse, body, one + two, order)


def _matrix(
    body: Any, order: Order, youngs_MPa: float, poisson: float, first: int, end: int
) -> tuple[sp.csr_matrix, float]:
    from skfem import Basis

    unknowns = 3 * (body.doflocs.shape[1] if order == 2 else body.nvertices)
    stiffness, volume = sp.csr_matrix((unknowns, unknowns)), 0.0
    for start in range(first, end, _CHUNK):
        elements = np.arange(start, min(start + _CHUNK, end))
        basis = Basis(body, _element(order), intorder=STIFFNESS_ORDER, elements=elements)
        if basis.mapping.detDF(basis.X, tind=elements).min() <= 0:  # basis.dx takes its absolute value
            raise solver_error("mesh: an element is inverted.", "Choose another element size.")
        stiffness = stiffness + _chunk_matrix(basis, youngs_MPa, poisson, unknowns)
        volume += float(basis.dx.sum())
    return stiffness, volume


def _element(order: Order) -> Any:
    from skfem import ElementTetP1, ElementTetP2

    return ElementTetP2() if order == 2 else ElementTetP1()


def mean_displacement(model: Elasticity, axis: int, z_from_mm: float, z_to_mm: float = math.inf) -> Array:
    """Return m with m.u = mean of one displacement component over material between two z, (unknowns,).

    The same vector, times a force, is the load of that force spread evenly over that material. Elements that
    straddle z are integrated over their inside quadrature points.
    """
    basis, inside = basis_above_plane(model, z_from_mm, z_to_mm)
    mean = np.zeros(model.nodes_mm.size)
    _add_load(mean, basis, axis, inside)
    return np.asarray(mean / inside.sum(), dtype=np.float64)


def _add_load(force: Array, basis: Any, axis: int, weights: Array) -> None:
    shares = np.stack([(np.asarray(phi[0]) * weights).sum(axis=1) for phi in basis.basis])
    np.add.at(force, 3 * basis.element_dofs + axis, shares)


def basis_above_plane(model: Elasticity, z_from_mm: float, z_to_mm: float = math.inf) -> tuple[Any, Array]:
    """Return the basis of the elements that reach beyond z, and the weights of its points there, mm3."""
    from skfem import Basis

    heights = model.mesh.p[2][model.mesh.t]
    reach = (heights.max(axis=0) > z_from_mm + _PLANE_MM) & (heights.min(axis=0) < z_to_mm - _PLANE_MM)
    basis = Basis(model.mesh, _element(model.order), intorder=LOAD_ORDER, elements=np.nonzero(reach)[0])
    z = np.asarray(basis.global_coordinates())[2]
    return basis, basis.dx * ((z > z_from_mm - _PLANE_MM) & (z < z_to_mm + _PLANE_MM))


def centrifugal_force(model: Elasticity, density_tonne_per_mm3: float) -> Array:
    """Return the nodal forces of rotation about the crank axis at 1 rad/s, shape (unknowns,), N."""
    from skfem import Basis

    basis = Basis(model.mesh, _element(model.order), intorder=LOAD_ORDER)
    points = np.asarray(basis.global_coordinates())
    force = np.zeros(model.nodes_mm.size)
    for axis in (0, 1):
        _add_load(force, basis, axis, density_tonne_per_mm3 * points[axis] * basis.dx)
    return force


def lame_constants_MPa(youngs_MPa: float, poisson: float) -> tuple[float, float]:
    """Return Lame's first constant and the shear modulus."""
    return youngs_MPa * poisson / ((1 + poisson) * (1 - 2 * poisson)), youngs_MPa / (2 * (1 + poisson))


def _chunk_matrix(basis: Any, youngs: float, poisson: float, unknowns: int) -> sp.csr_matrix:
    """Sum of the element matrices of a chunk: lambda div u div v + 2 mu eps(u):eps(v)."""
    lame, shear = lame_constants_MPa(youngs, poisson)
    gradients = np.ascontiguousarray(np.stack([phi[0].grad for phi in basis.basis]).transpose(2, 3, 0, 1))
    weighted = gradients * basis.dx[:, :, None, None]
    count, points = basis.dx.shape
    nodes = gradients.shape[2]
    flat = gradients.reshape(count, points, 3 * nodes)
    outer = np.matmul(weighted.reshape(count, points, 3 * nodes).transpose(0, 2, 1), flat)
    outer = outer.reshape(count, nodes, 3, nodes, 3)
    matrix = lame * outer + shear * outer.transpose(0, 1, 4, 3, 2)
    trace = shear * np.einsum("eaibi->eab", outer)
    for axis in range(3):
        matrix[:, :, axis, :, axis] += trace
    rows = (3 * basis.element_dofs.T[:, :, None] + np.arange(3)).reshape(count, 3 * nodes).astype(np.int32)
    return sp.coo_matrix(
        (matrix.ravel(), (np.repeat(rows, 3 * nodes, axis=1).ravel(), np.tile(rows, (1, 3 * nodes)).ravel())),
        shape=(unknowns, unknowns),
    ).tocsr()


def _prolongation(body: Any) -> sp.csr_matrix:
    """Corner nodes keep their value, edge nodes take the mean of their two corners."""
    corners, edges = body.nvertices, body.edges
    count = edges.shape[1]
    half = sp.csr_matrix(
        (np.full(2 * count, 0.5), edges.T.ravel(), np.arange(0, 2 * count + 1, 2)), shape=(count, corners)
    )
    return sp.kron(sp.vstack([sp.eye(corners), half]), sp.eye(3)).tocsr()
