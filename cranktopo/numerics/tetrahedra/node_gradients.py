"""Derivatives of integrals over curved ten-node tetrahedra by the positions of their nodes.

With nodal displacements held, an element's virtual work depends on its nodes through dx and through grad u:
the discrete form of Eshelby's energy-momentum tensor. The quadrature is that of the evaluation, so that the
derivatives are those of its numbers.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.numerics.tetrahedra.elasticity import (
    LOAD_ORDER,
    STIFFNESS_ORDER,
    Elasticity,
    basis_above_plane,
)
from cranktopo.numerics.tetrahedra.stress import hooke, tensor_strain

_CHUNK = 4000
_TENSOR = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
"""Places of a symmetric tensor's entries among the six components."""


def work_slopes(
    model: Elasticity,
    youngs_MPa: float,
    poisson: float,
    first: Array,
    second: Array,
    elements: NDArray[np.intp] | None = None,
) -> Array:
    """Return the derivative of first' K second by the nodes, (3, nodes), N; by default of all elements."""
    total = np.zeros(model.nodes_mm.shape)
    for basis in chunks(model, STIFFNESS_ORDER, elements):
        shapes = shape_slopes(basis)
        slopes = [displacement_slopes(basis, shapes, u) for u in (first, second)]
        stresses = [full_tensor(hooke(tensor_strain(s), youngs_MPa, poisson)) for s in slopes]
        density = np.einsum("eqij,eqij->eq", stresses[0], slopes[1])
        flow = -np.einsum("eqik,eqij->eqkj", slopes[0], stresses[1])
        flow -= np.einsum("eqik,eqij->eqkj", slopes[1], stresses[0])
        flow += density[:, :, None, None] * np.eye(3)
        gather(total, basis, np.einsum("eqkj,njeq,eq->nke", flow, shapes, basis.dx, optimize=True))
    return total


def mean_slopes(model: Elasticity, axis: int, z_from_mm: float, field: Array) -> Array:
    """Return the derivative of `mean_displacement(model, axis, z_from_mm) @ field` by the nodes, (3, nodes).

    Which quadrature points lie beyond z is held.
    """
    basis, inside = basis_above_plane(model, z_from_mm)
    nodes = field.reshape(-1, 3)[:, axis][basis.element_dofs]
    value = np.einsum("neq,ne->eq", nodal_values(basis), nodes)
    weight = (value - (value * inside).sum() / inside.sum()) * inside / inside.sum()
    total = np.zeros(model.nodes_mm.shape)
    gather(total, basis, np.einsum("eq,njeq->nje", weight, shape_slopes(basis), optimize=True))
    return total


def centrifugal_slopes(model: Elasticity, density_tonne_per_mm3: float, field: Array) -> Array:
    """Return the derivative of `centrifugal_force(model, density) @ field` by the nodes, (3, nodes)."""
    total = np.zeros(model.nodes_mm.shape)
    for basis in chunks(model, LOAD_ORDER):
        values, place = nodal_values(basis), np.asarray(basis.global_coordinates())
        nodes = field.reshape(-1, 3)[basis.element_dofs]  # (10, e, 3)
        moved = np.einsum("neq,nei->ieq", values, nodes)
        moved[2] = 0.0
        pull = density_tonne_per_mm3 * basis.dx
        found = np.einsum(
            "eq,njeq->nje", pull * (place * moved).sum(axis=0), shape_slopes(basis), optimize=True
        )
        found += np.einsum("eq,ieq,neq->nie", pull, moved, values, optimize=True)
        gather(total, basis, found)
    return total


def moments(model: Elasticity) -> tuple[Array, Array]:
    """Return the volume, its moment in y and that of x2 + y2, (3,), and their derivatives by the nodes."""
    totals, slopes = np.zeros(3), np.zeros((3, *model.nodes_mm.shape))
    for basis in chunks(model, LOAD_ORDER):
        x, y, _ = np.asarray(basis.global_coordinates())
        shapes, values, zero = shape_slopes(basis), nodal_values(basis), np.zeros_like(x)
        weights = (np.ones_like(x), (zero, zero)), (y, (zero, zero + 1)), (x * x + y * y, (2 * x, 2 * y))
        for k, (weight, changes) in enumerate(weights):
            totals[k] += (weight * basis.dx).sum()
            found = np.einsum("eq,njeq->nje", weight * basis.dx, shapes, optimize=True)
            for axis, change in enumerate(changes):
                found[:, axis] += np.einsum("eq,neq->ne", change * basis.dx, values)
            gather(slopes[k], basis, found)
    return totals, slopes


def chunks(model: Elasticity, order: int, elements: NDArray[np.intp] | None = None) -> Iterator[Any]:
    """Return the bases of some thousand elements each, together those given; by default all."""
    from skfem import Basis, ElementTetP2

    numbers = np.arange(model.mesh.nelements) if elements is None else elements
    for start in range(0, len(numbers), _CHUNK):
        yield Basis(model.mesh, ElementTetP2(), intorder=order, elements=numbers[start : start + _CHUNK])


def shape_slopes(basis: Any) -> Array:
    """Return the derivatives of the shape functions by the place, (10, 3, elements, points), 1/mm."""
    return np.stack([phi[0].grad for phi in basis.basis])


def displacement_slopes(basis: Any, shapes: Array, field: Array) -> Array:
    """Return grad u, (elements, points, 3 components, 3 axes)."""
    nodes = field.reshape(-1, 3)[basis.element_dofs]
    return np.asarray(np.einsum("nei,njeq->eqij", nodes, shapes, optimize=True))


def full_tensor(components: Array) -> Array:
    """Return the symmetric tensors (..., 3, 3) from their six components."""
    return components[..., _TENSOR]


def gather(total: Array, basis: Any, found: Array) -> None:
    """Add what the elements give their nodes, (10, 3, elements), to (3, nodes)."""
    for axis in range(3):
        np.add.at(total[axis], basis.element_dofs, found[:, axis])


def nodal_values(basis: Any) -> Array:
    """Return the shape functions at the points of a basis, (10, elements, points)."""
    return np.stack([np.broadcast_to(np.asarray(phi[0]), basis.dx.shape) for phi in basis.basis])
