"""Derivatives of integrals over curved ten-node tetrahedra by the positions of their nodes.

With nodal displacements held, an element's virtual work depends on its nodes through dx and through grad u:
the discrete form of Eshelby's energy-momentum tensor. The quadrature is that of the evaluation, so that the
derivatives are those of its numbers.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array, Index
from cranktopo.numerics.tetrahedra.elasticity import (
    LOAD_ORDER,
    STIFFNESS_ORDER,
    Elasticity,
    basis_above_plane,
    centrifugal_force,
    inverse_jacobians,
    quadrature,
    swing_force,
)
from cranktopo.numerics.tetrahedra.mesh import shape_gradients, shape_values
from cranktopo.numerics.tetrahedra.stress import hooke, tensor_strain

_TENSOR = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
"""Places of a symmetric tensor's entries among the six components."""


def work_slopes(
    model: Elasticity,
    youngs_MPa: float,
    poisson: float,
    first: Array,
    second: Array,
) -> Array:
    """Return the derivative of first' K second by the nodes, (3, nodes), N."""
    return sums_of_work_slopes(model, youngs_MPa, poisson, first[None], second[None, None])[0]


def sums_of_work_slopes(
    model: Elasticity,
    youngs_MPa: float,
    poisson: float,
    firsts: Array,
    seconds: Array,
) -> Array:
    """Return the derivatives of sums of first' K second over fields by the nodes, (sums, 3, nodes), N.

    Args:
        firsts: shape (fields, unknowns), the same in every sum.
        seconds: shape (sums, fields, unknowns).
    """
    totals = np.zeros((len(seconds), *model.nodes_mm.shape))
    for basis in chunks(model, STIFFNESS_ORDER):

        def strained(field: Array, basis: ElementPoints = basis) -> tuple[Array, Array]:
            slopes = displacement_slopes(basis, basis.slopes, field)
            return slopes, full_tensor(hooke(tensor_strain(slopes), youngs_MPa, poisson))

        before = [strained(field) for field in firsts]
        for total, fields in zip(totals, seconds, strict=True):
            flow = sum(_flow(one, strained(other)) for one, other in zip(before, fields, strict=True))
            gather(total, basis, np.einsum("eqkj,njeq,eq->nke", flow, basis.slopes, basis.dx, optimize=True))
    return totals


def _flow(first: tuple[Array, Array], second: tuple[Array, Array]) -> Array:
    """Return what the works of two fields, by slopes and stresses, change by per slope of a move."""
    density = np.einsum("eqij,eqij->eq", first[1], second[0])
    flow = -np.einsum("eqik,eqij->eqkj", first[0], second[1])
    flow -= np.einsum("eqik,eqij->eqkj", second[0], first[1])
    return np.asarray(flow + density[:, :, None, None] * np.eye(3))


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
    by_place = field.reshape(-1, 3).T.copy()
    by_place[2] = 0.0
    return density_tonne_per_mm3 * integral_slopes(model, None, by_place)


def integral_slopes(model: Elasticity, even: Array | None, by_place: Array) -> Array:
    """Return the derivative by the nodes of the integral of a field and of place times fields, (3, nodes).

    Args:
        even: field by its values at the nodes, (nodes,); none is 0.
        by_place: fields that x, y and z are multiplied by, (3, nodes).
    """
    total = np.zeros(model.nodes_mm.shape)
    for basis in chunks(model, LOAD_ORDER):
        values, place = basis.values, basis.places_mm
        weights = np.einsum("qn,ine->ieq", values, by_place[:, basis.element_dofs], optimize=True)
        density = (place * weights).sum(axis=0)
        if even is not None:
            density += np.einsum("qn,ne->eq", values, even[basis.element_dofs], optimize=True)
        found = np.einsum("eq,njeq->nje", basis.dx * density, basis.slopes, optimize=True)
        found += np.einsum("ieq,qn->nie", basis.dx * weights, values, optimize=True)
        gather(total, basis, found)
    return total


def swing_slopes(model: Elasticity, field: Array) -> Array:
    """Return the derivative of `swing_force(model) @ field` by the nodes, (3, nodes)."""
    across = field.reshape(-1, 3)
    turned = np.stack([-across[:, 1], across[:, 0], np.zeros(len(across))], axis=1).ravel()
    outward, along = centrifugal_force(model, 1.0).reshape(-1, 3).T, model.nodes_mm.copy()
    along[2] = 0.0
    inertia = float((outward * along).sum())
    of_inertia = outward + centrifugal_slopes(model, 1.0, along.T.ravel())
    work = float(swing_force(model) @ field)
    return np.asarray((centrifugal_slopes(model, 1.0, turned) - work * of_inertia) / inertia)


def moments(model: Elasticity) -> tuple[Array, Array]:
    """Return the volume, its moment in y and that of x2 + y2, (3,), and their derivatives by the nodes."""
    totals, slopes = np.zeros(3), np.zeros((3, *model.nodes_mm.shape))
    for basis in chunks(model, LOAD_ORDER):
        x, y, _ = basis.places_mm
        zero = np.zeros_like(x)
        weights = (np.ones_like(x), (zero, zero)), (y, (zero, zero + 1)), (x * x + y * y, (2 * x, 2 * y))
        for k, (weight, changes) in enumerate(weights):
            totals[k] += (weight * basis.dx).sum()
            found = np.einsum("eq,njeq->nje", weight * basis.dx, basis.slopes, optimize=True)
            for axis, change in enumerate(changes):
                found[:, axis] += basis.values.T @ (change * basis.dx).T
            gather(slopes[k], basis, found)
    return totals, slopes


@dataclass(frozen=True)
class ElementPoints:
    """The points of a quadrature in some elements: what integrals over these take.

    Attributes:
        element_dofs: nodes of the elements, (10, elements).
        dx: volume of each point, (elements, points), mm3.
        slopes: derivatives of the shape functions by the place, (10, 3, elements, points), 1/mm.
        values: shape functions, (points, 10), the same in all elements.
        nodes_mm: of the mesh, (3, nodes).
    """

    element_dofs: Index
    dx: Array
    slopes: Array
    values: Array
    nodes_mm: Array

    @property
    def places_mm(self) -> Array:
        """Places of the points, (3, elements, points)."""
        nodes = self.nodes_mm[:, self.element_dofs]
        return np.asarray(np.einsum("ine,qn->ieq", nodes, self.values, optimize=True))


def chunks(model: Elasticity, order: int, elements: Index | None = None) -> Iterator[ElementPoints]:
    """Yield the points of some thousand elements each, together those given; by default all.

    Scikit-fem's bases take four times as long.
    """
    points, _ = quadrature(order)
    reference, values = shape_gradients(points), shape_values(points)
    numbers = np.arange(model.mesh.nelements) if elements is None else elements
    for which, inverse, dx in inverse_jacobians(model.mesh, numbers, order):
        slopes = np.einsum("ijeq,qnj->nieq", inverse, reference, optimize=True)
        nodes = model.mesh.dofs.element_dofs[:, numbers[which]]
        yield ElementPoints(nodes, dx, slopes, values, model.mesh.doflocs)


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
