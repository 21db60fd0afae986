"""Way back from stresses at the surface to displacements and nodes: the adjoint of the stress recovery.

Every step of `nodal_stress` and of `surface_stress` in reverse order.
"""

from __future__ import annotations

import numpy as np

from cranktopo.base.arrays import Array, Index
from cranktopo.numerics.tetrahedra.elasticity import STIFFNESS_ORDER, Elasticity
from cranktopo.numerics.tetrahedra.mesh import node_points, shape_gradients
from cranktopo.numerics.tetrahedra.node_gradients import (
    displacement_slopes,
    full_tensor,
    gather,
    shape_slopes,
)
from cranktopo.numerics.tetrahedra.stress import (
    NodalStress,
    Surface,
    hooke,
    nodes_from_points,
    triangle_gradients,
)

_BOTH_HALVES = np.array([1.0, 1.0, 1.0, 0.5, 0.5, 0.5])
"""A component off the diagonal stands at two places of the tensor."""


def stress_adjoint(
    model: Elasticity,
    surface: Surface,
    stress: NodalStress,
    fields: Array,
    adjoint: tuple[Array, Array],
    elastic: tuple[float, float],
) -> tuple[Array, Array]:
    """Return the derivative of sum(adjoint * result of `surface_stress`) by displacements and nodes.

    Args:
        fields: displacements, shape (fields, unknowns).
        adjoint: of the stresses and of their derivatives into the depth, each (fields, surface nodes, 6).
        elastic: Young's modulus in MPa and Poisson's ratio.

    Returns:
        Shapes (fields, unknowns), displacements held for the second, (3, nodes).
    """
    of_stress, of_depth = adjoint
    nodal = np.zeros_like(stress.nodal_MPa)
    nodal[:, surface.nodes] += of_stress
    by_nodes = np.zeros(model.nodes_mm.shape)
    _through_depth(model, surface, stress, of_depth, nodal, by_nodes)
    return _through_nodes(model, stress, fields, nodal, elastic, by_nodes), by_nodes


def _through_depth(
    model: Elasticity,
    surface: Surface,
    nodal_stress: NodalStress,
    adjoint: Array,
    nodal: Array,
    by_nodes: Array,
) -> None:
    """Add the adjoint of the derivatives into the depth to those of the nodal stresses and of the nodes."""
    number = np.bincount(surface.faces.ravel(), minlength=len(surface.nodes))
    active = (adjoint != 0).any(axis=(0, 2))
    chosen = active[surface.faces].any(axis=0)
    faces, local, owners = surface.faces[:, chosen], surface.local[:, chosen], surface.owners[chosen]
    cells = nodal_stress.elements[:, owners]  # (10, f)
    reference = shape_gradients(node_points())[local]  # (6, f, 10, 3)
    jacobian = np.einsum("inf,pfnj->pfij", model.nodes_mm[:, cells], reference, optimize=True)
    direction = np.linalg.solve(jacobian, -surface.normals[faces][..., None])[..., 0]
    weights = np.einsum("pfnj,pfj->pfn", reference, direction, optimize=True)
    share = (adjoint / number[:, None])[:, faces]  # (fields, 6, f, 6)
    stress = nodal_stress.nodal_MPa[:, cells]  # (fields, 10, f, 6)
    for total, part in zip(nodal, share, strict=True):
        np.add.at(total, cells, np.einsum("pfn,pfc->nfc", weights, part, optimize=True))
    of_weights = np.einsum("xpfc,xnfc->pfn", share, stress, optimize=True)
    of_direction = np.einsum("pfnj,pfn->pfj", reference, of_weights, optimize=True)
    inward = np.linalg.solve(jacobian.swapaxes(2, 3), of_direction[..., None])[..., 0]
    of_jacobian = -inward[..., :, None] * direction[..., None, :]
    _add(by_nodes, cells, np.einsum("pfij,pfnj->inf", of_jacobian, reference, optimize=True))
    of_normal = np.zeros((len(surface.nodes), 3))
    np.add.at(of_normal, faces, -inward)
    _through_normals(model, surface, (faces, cells, local), of_normal, by_nodes)


def _through_normals(
    model: Elasticity, surface: Surface, around: tuple[Index, Index, Index], adjoint: Array, by_nodes: Array
) -> None:
    """Add the adjoint of the unit normals of the surface nodes to that of the nodes."""
    faces, cells, _ = around
    numbers = surface.nodes[faces]
    at, gradients = model.nodes_mm[:, numbers], triangle_gradients()
    first, second = np.einsum("inf,pnk->kpfi", at, gradients)
    normal = np.cross(first, second)  # (6, f, 3)
    inside = model.nodes_mm[:, cells[:4]].mean(axis=1) - at[:, :3].mean(axis=1)
    sign = -np.sign(np.einsum("fi,if->f", normal.mean(axis=0), inside))[:, None]
    total = np.zeros_like(adjoint)
    np.add.at(total, faces, sign * normal)
    length = np.maximum(np.linalg.norm(total, axis=1, keepdims=True), np.finfo(float).tiny)
    unit = total / length
    of_total = (adjoint - unit * (unit * adjoint).sum(axis=1, keepdims=True)) / length
    of_normal = sign * of_total[faces]
    of_tangents = np.stack([np.cross(second, of_normal), np.cross(of_normal, first)])
    _add(by_nodes, numbers, np.einsum("kpfi,pnk->inf", of_tangents, gradients, optimize=True))


def _through_nodes(
    model: Elasticity,
    stress: NodalStress,
    fields: Array,
    adjoint: Array,
    elastic: tuple[float, float],
    by_nodes: Array,
) -> Array:
    """Return the adjoint of the displacements, (fields, unknowns); that of the nodes is added to theirs."""
    from skfem import Basis, ElementTetP2

    active = (adjoint != 0).any(axis=(0, 2))
    elements = np.flatnonzero(active[stress.elements].any(axis=0))
    basis = Basis(model.mesh, ElementTetP2(), intorder=STIFFNESS_ORDER, elements=elements)
    cells, volume = stress.elements[:, elements], basis.dx.sum(axis=1)
    around = np.zeros(adjoint.shape[1])
    np.add.at(around, cells, np.broadcast_to(volume, cells.shape))
    around[~active] = 1.0
    share = (adjoint / around[:, None])[:, cells.T]  # (fields, e, 10, 6)
    shapes, result = shape_slopes(basis), np.zeros_like(fields)
    spread = nodes_from_points(basis.X)
    of_volume = np.zeros(len(elements))
    for field, u, part in zip(range(len(fields)), fields, share, strict=True):
        departure = stress.element_MPa[field][elements] - stress.nodal_MPa[field][cells.T]
        of_volume += np.einsum("enc,enc->e", part, departure)
        of_stress = np.einsum("nq,enc->eqc", spread, part * volume[:, None, None], optimize=True)
        of_slopes = full_tensor(hooke(of_stress, *elastic) * _BOTH_HALVES)
        mine = np.zeros(model.nodes_mm.shape)
        gather(mine, basis, np.einsum("eqij,njeq->nie", of_slopes, shapes, optimize=True))
        result[field] = mine.T.ravel()
        flow = -np.einsum("eqij,eqik->eqkj", of_slopes, displacement_slopes(basis, shapes, u), optimize=True)
        gather(by_nodes, basis, np.einsum("eqkj,njeq->nke", flow, shapes, optimize=True))
    gather(by_nodes, basis, np.einsum("e,eq,nkeq->nke", of_volume, basis.dx, shapes, optimize=True))
    return result


def _add(total: Array, nodes: Index, found: Array) -> None:
    """Add shares of nodes (n, f), (3, n, f), to (3, all nodes)."""
    for axis in range(3):
        np.add.at(total[axis], nodes, found[axis])
