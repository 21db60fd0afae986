"""What cubic displacements would take off the energy of quadratic ones: where the discretisation error is.

The hierarchical estimate (Bank and Smith, A posteriori error estimates based on hierarchical bases, SIAM J.
Numer. Anal. 30, 1993): one cubic function per edge and one per face of the same mesh make the quadratic
elements cubic. The residual of the quadratic solution on each of them, answered by that function alone, adds
up to the energy that quadratic elements miss, but for a factor that hardly depends on mesh or body.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.side_by_side import side_by_side
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, basis_above_plane, lame_constants_MPa
from cranktopo.tasks.fea.condense import Superelement

EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
FACES = ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3))
"""Corners of the edges and faces of a tetrahedron, in the order of scikit-fem."""
_CHUNK = 4000
_QUADRATURE = 4
"""Exact for the products of the cubic functions' gradients on straight elements."""
_CORNER_SLOPES = np.vstack([-np.ones(3), np.eye(3)])


def hierarchical_estimator(
    model: Elasticity,
    blocks: Sequence[Superelement],
    youngs_MPa: float,
    poisson: float,
    pin_mm: tuple[float, float],
) -> list[Array]:
    """Energy that the fields of condensed blocks miss, as a quadratic form over their amplitudes.

    Twice the energy of the half or whole throw that motions q and a mean pin load f on the model miss is
    (q, f) G (q, f).

    Args:
        blocks: condensed from this model.
        pin_mm: heights between which the material carries the pin load.

    Returns:
        G per block, shape (m, m), or (m + 1, m + 1) where the block has a load field.
    """
    fields = [block.fields for block in blocks]
    residual, stiffness = _residual(model, np.hstack(fields), youngs_MPa, poisson)
    starts = np.cumsum([0, *(field.shape[1] for field in fields)])
    forms = []
    for block, start, end in zip(blocks, starts, starts[1:], strict=False):
        own = residual[:, :, start:end]
        if end - start > len(block.motions):
            own = own.copy()
            own[:, 1, -1] -= _mean_weights(model, pin_mm)
        forms.append(block.parts * _answered(own, stiffness, _held(model, block)))
    return forms


def _answered(residual: Array, stiffness: Array, held: NDArray[np.bool_]) -> Array:
    """Energy of the answers of all functions to the residuals, each alone; held components stay at zero."""
    residual = np.where(held[:, :, None], 0.0, residual)
    either = held[:, :, None] | held[:, None, :]
    answer = np.linalg.solve(np.where(either, np.eye(3), stiffness), residual)
    return np.asarray(np.einsum("nik,nil->kl", residual, answer, optimize=True))


def _residual(model: Elasticity, fields: Array, youngs: float, poisson: float) -> tuple[Array, Array]:
    """Minus the inner forces of fields on the cubic functions, and each function's own stiffness.

    Returns:
        Shapes (functions, 3, fields) and (functions, 3, 3).
    """
    count, middle = model.mesh.nelements, model.mesh.nelements // 2
    part = partial(_part, model, fields, youngs, poisson)
    (force, own), (more_force, more) = side_by_side(lambda: part(0, middle), lambda: part(middle, count))
    return force + more_force, own + more


def _part(
    model: Elasticity, fields: Array, youngs: float, poisson: float, first: int, end: int
) -> tuple[Array, Array]:
    """Return what the elements from the first to before the end add to `_residual`."""
    from skfem import Basis, ElementTetP2

    count = model.mesh.nedges + model.mesh.nfacets
    force, own = np.zeros((count, 3, fields.shape[1])), np.zeros((count, 3, 3))
    nodal = fields.reshape(-1, 3, fields.shape[1])
    lame, shear = lame_constants_MPa(youngs, poisson)
    for start in range(first, end, _CHUNK):
        elements = np.arange(start, min(start + _CHUNK, end))
        basis = Basis(model.mesh, ElementTetP2(), intorder=_QUADRATURE, elements=elements)
        numbers, slopes = _functions(model, basis)[0], _slopes(model, basis)
        stress = _stress(basis, nodal[basis.element_dofs], lame, shear)
        weighted = slopes * basis.dx[:, :, None]
        np.add.at(force, numbers, -np.einsum("keqai,neqi->neak", stress, weighted, optimize=True))
        products = np.einsum("neqi,neqj->neij", weighted, slopes, optimize=True)
        trace = np.einsum("neii->ne", products)[:, :, None, None] * np.eye(3)
        np.add.at(own, numbers, lame * products + shear * (products.swapaxes(2, 3) + trace))
    return force, own


def _stress(basis: Any, nodal: Array, lame: float, shear: float) -> Array:
    """Stress of fields at the quadrature points, shape (fields, elements, points, 3, 3).

    Args:
        nodal: displacements of each element's nodes, shape (10, elements, 3, fields).
    """
    shapes = np.stack([phi[0].grad for phi in basis.basis])
    slope = np.einsum("nieq,neak->keqai", shapes, nodal, optimize=True)
    stress = shear * (slope + slope.swapaxes(3, 4))
    dilation = lame * np.einsum("keqaa->keq", slope)
    for axis in range(3):
        stress[..., axis, axis] += dilation
    return np.asarray(stress)


def _functions(model: Elasticity, basis: Any) -> tuple[NDArray[np.intp], Array]:
    """Numbers of the ten cubic functions of each element of a basis, and their signs, shape (10, elements).

    An edge's function changes its sign with the direction of the edge, which goes to the larger corner.
    """
    mesh, elements = model.mesh, basis.tind
    numbers = np.vstack([mesh.t2e[:, elements], mesh.nedges + mesh.t2f[:, elements]])
    corners = mesh.t[:, elements]
    signs = np.ones(numbers.shape)
    for function, (a, b) in enumerate(EDGES):
        signs[function] = np.where(corners[a] < corners[b], 1.0, -1.0)
    return numbers, signs


def _slopes(model: Elasticity, basis: Any) -> Array:
    """Gradients of the cubic functions at the quadrature points, shape (10, elements, points, 3)."""
    inverse = basis.mapping.invDF(basis.X, tind=basis.tind)
    signs = _functions(model, basis)[1][:, :, None, None]
    found = np.einsum("jieq,njq->neqi", inverse, _reference_slopes(basis.X), optimize=True)
    return np.asarray(found * signs)


def _reference_values(points: Array) -> Array:
    """Cubic functions at points (3, q) of the reference tetrahedron: a b (a - b) on edges, a b c on faces."""
    corner = np.vstack([1 - points.sum(axis=0), points])
    edges = [corner[a] * corner[b] * (corner[a] - corner[b]) for a, b in EDGES]
    return np.stack([*edges, *(corner[a] * corner[b] * corner[c] for a, b, c in FACES)])


def _reference_slopes(points: Array) -> Array:
    """Gradients of the cubic functions at points (3, q) of the reference tetrahedron, shape (10, 3, q)."""
    corner = np.vstack([1 - points.sum(axis=0), points])
    slopes = []
    for i, j in EDGES:
        a, b = corner[i], corner[j]
        slopes.append(np.outer(_CORNER_SLOPES[i], 2 * a * b - b * b))
        slopes[-1] += np.outer(_CORNER_SLOPES[j], a * a - 2 * a * b)
    for face in FACES:
        a, b, c = (corner[k] for k in face)
        products = zip(face, (b * c, a * c, a * b), strict=True)
        slopes.append(np.sum([np.outer(_CORNER_SLOPES[k], others) for k, others in products], axis=0))
    return np.stack(slopes)


def _mean_weights(model: Elasticity, z_mm: tuple[float, float]) -> Array:
    """Mean of each cubic function over the material between two heights, shape (functions,)."""
    basis, inside = basis_above_plane(model, *z_mm)
    numbers, signs = _functions(model, basis)
    weights = np.zeros(model.mesh.nedges + model.mesh.nfacets)
    np.add.at(weights, numbers, signs * (_reference_values(basis.X) @ inside.T))
    return np.asarray(weights / inside.sum())


def _held(model: Elasticity, block: Superelement) -> NDArray[np.bool_]:
    """Components of each cubic function that a block holds: those of all nodes of its edge or face."""
    unknowns = np.zeros(model.nodes_mm.size, dtype=bool)
    unknowns[block.held] = True
    fixed = unknowns.reshape(-1, 3)
    mesh = model.mesh
    edges = fixed[mesh.edges].all(axis=0) & fixed[mesh.nvertices :]
    return np.vstack([edges, fixed[mesh.facets].all(axis=0) & edges[mesh.f2e].all(axis=0)])
