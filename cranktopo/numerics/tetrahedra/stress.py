"""Stresses of displacement fields on ten-node tetrahedra, from quadrature points to the nodes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.numerics.tetrahedra.curving import EDGES
from cranktopo.numerics.tetrahedra.elasticity import Elasticity

COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "zx")
_ORDER = 2
"""Four points, where stresses of quadratic tetrahedra are most accurate."""


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


def nodal_stress(model: Elasticity, displacement_mm: Array, youngs_MPa: float, poisson: float) -> NodalStress:
    """Stresses of displacement fields at all nodes.

    Quadrature points are where stresses of quadratic elements converge fastest; a linear field through the
    four of them gives the corners, and the means of corners the edge nodes (Barlow, Int. J. Num. Meth. Eng.,
    1976).

    Args:
        displacement_mm: shape (fields, unknowns).
    """
    from skfem import Basis, ElementTetP2

    basis = Basis(model.mesh, ElementTetP2(), intorder=_ORDER)
    stress = hooke(_strain(basis, displacement_mm), youngs_MPa, poisson)
    element = np.einsum("nq,feqc->fenc", nodes_from_points(basis.X), stress, optimize=True)
    return _averaged(basis.element_dofs, basis.dx.sum(axis=1), element)


def _averaged(elements: NDArray[np.intp], volume: Array, element: Array) -> NodalStress:
    count = int(elements.max()) + 1
    flat = elements.T.ravel()
    matrix = sp.csr_matrix((np.repeat(volume, 10), (flat, np.arange(flat.size))), (count, flat.size))
    total = np.asarray(matrix.sum(axis=1))
    nodal = np.stack([(matrix @ field.reshape(-1, 6)) / total for field in element])
    return NodalStress(elements, element, nodal)


def nodes_from_points(points: Array) -> Array:
    """Values at the ten nodes from those at four points of the reference element, shape (10, 4)."""
    barycentric = np.vstack([1 - points.sum(axis=0), points])
    corners = np.linalg.inv(barycentric.T)
    middles = [(corners[a] + corners[b]) / 2 for a, b in EDGES]
    return np.vstack([corners, middles])


def _strain(basis: Any, displacement: Array) -> Array:
    """Tensor strains, shape (fields, elements, points, 6)."""
    gradients = np.stack([phi[0].grad for phi in basis.basis])  # (10, 3, elements, points)
    nodes = displacement.reshape(len(displacement), -1, 3)[:, basis.element_dofs]  # (fields, 10, elements, 3)
    return tensor_strain(np.einsum("njeq,fnei->feqij", gradients, nodes, optimize=True))


def tensor_strain(slopes: Array) -> Array:
    """Tensor strains (..., 6), last axis as `COMPONENTS`, of displacement gradients (..., 3, 3)."""
    strain = (slopes + slopes.swapaxes(-1, -2)) / 2
    return np.asarray(strain[..., (0, 1, 2, 0, 1, 2), (0, 1, 2, 1, 2, 0)])


def hooke(strain: Array, youngs_MPa: float, poisson: float) -> Array:
    """Stresses of strains, MPa, of the same shape.

    Args:
        strain: tensor strains (..., 6), last axis as `COMPONENTS`.
    """
    shear = youngs_MPa / (2 * (1 + poisson))
    lame = 2 * shear * poisson / (1 - 2 * poisson)
    stress = 2 * shear * strain
    stress[..., :3] += lame * strain[..., :3].sum(axis=-1, keepdims=True)
    return np.asarray(stress)
