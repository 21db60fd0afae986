"""Energy of a condensed body that a mesh misses: by its displacements, and by its shape.

The hierarchical estimate (Bank and Smith, A posteriori error estimates based on hierarchical bases, SIAM J.
Numer. Anal. 30, 1993): one cubic function per edge and one per face of the same mesh make the quadratic
elements cubic. The residual of the quadratic solution on each of them, answered by that function alone, adds
up to the energy that quadratic elements miss, but for a factor that hardly depends on mesh or body.

Where bending an element to the surface would fold it, its edge nodes stay off the surface. To first order
the energy of displacements changes by its derivative along the way to the surface, with no other solve.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.side_by_side import side_by_side
from cranktopo.numerics.tetrahedra.elasticity import (
    STIFFNESS_ORDER,
    Elasticity,
    basis_above_plane,
    inverse_jacobians,
    lame_constants_MPa,
    quadrature,
)
from cranktopo.numerics.tetrahedra.mesh import EDGES, TetMesh, shape_gradients
from cranktopo.numerics.tetrahedra.node_gradients import (
    chunks,
    displacement_slopes,
    full_tensor,
)
from cranktopo.numerics.tetrahedra.rigid_motions import section_turns
from cranktopo.numerics.tetrahedra.stress import hooke, tensor_strain
from cranktopo.numerics.tetrahedra.superelement import Superelement

_FACES = ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3))
"""Corners of the faces of a tetrahedron, in the order of scikit-fem."""
_QUADRATURE = 4
"""Exact for the products of the cubic functions' gradients on straight elements."""
_CORNER_SLOPES = np.vstack([-np.ones(3), np.eye(3)])


def hierarchical_estimator(
    model: Elasticity,
    blocks: Sequence[Superelement],
    youngs_MPa: float,
    poisson: float,
    loaded_mm: tuple[float, float],
) -> list[Array]:
    """Return the energy that the fields of condensed blocks miss, as a quadratic form over their amplitudes.

    Twice the energy of the half or whole body that motions q and a mean load f on the model miss is
    (q, f) G (q, f): one G per block, (m, m), or (m + 1, m + 1) where the block has a load field.

    Args:
        loaded_mm: heights between which the load along -y acts, as in the blocks.
    """
    every = np.hstack([block.fields for block in blocks])
    residual, stiffness = _residual(model, every, youngs_MPa, poisson)
    forms = []
    for block, some in zip(blocks, _columns(blocks), strict=True):
        own = residual[:, :, some]
        if own.shape[2] > len(block.motions):
            own = own.copy()
            own[:, 1, -1] -= _mean_weights(model, loaded_mm)
        forms.append(block.parts * _answered(own, stiffness, _held(model, block)))
    return forms


def _columns(blocks: Sequence[Superelement]) -> list[slice]:
    """Return which of the fields of all blocks, side by side, are those of each."""
    starts = np.cumsum([0, *(block.fields.shape[1] for block in blocks)])
    return [slice(start, end) for start, end in itertools.pairwise(starts)]


def _answered(residual: Array, stiffness: Array, held: NDArray[np.bool_]) -> Array:
    """Energy of the answers of all functions to the residuals, each alone; held components stay at zero."""
    residual = np.where(held[:, :, None], 0.0, residual)
    either = held[:, :, None] | held[:, None, :]
    answer = np.linalg.solve(np.where(either, np.eye(3), stiffness), residual)
    return np.asarray(np.einsum("nik,nil->kl", residual, answer, optimize=True))


def _residual(model: Elasticity, fields: Array, youngs: float, poisson: float) -> tuple[Array, Array]:
    """Return minus the forces of fields on the cubic functions, (functions, 3, fields), and the stiffness."""
    count, middle = model.mesh.nelements, model.mesh.nelements // 2
    part = partial(_part, model, fields, youngs, poisson)
    (force, own), (more_force, more) = side_by_side(lambda: part(0, middle), lambda: part(middle, count))
    return force + more_force, own + more


def _part(
    model: Elasticity, fields: Array, youngs: float, poisson: float, first: int, end: int
) -> tuple[Array, Array]:
    count, elements = model.mesh.nedges + model.mesh.nfacets, np.arange(first, end)
    force, own = np.zeros((count, 3, fields.shape[1])), np.zeros((count, 3, 3))
    nodal = fields.reshape(-1, 3, fields.shape[1])
    lame, shear = lame_constants_MPa(youngs, poisson)
    points = quadrature(_QUADRATURE)[0]
    quadratic, cubic = shape_gradients(points), _reference_slopes(points[:, 1:].T)
    for which, inverse, dx in inverse_jacobians(model.mesh, elements, _QUADRATURE):
        some = elements[which]
        numbers, signs = _functions(model, some)
        shapes = np.einsum("ijeq,qnj->nieq", inverse, quadratic, optimize=True)
        slopes = np.einsum("ijeq,njq->neqi", inverse, cubic, optimize=True) * signs[:, :, None, None]
        stress = _stress(shapes, nodal[model.mesh.dofs.element_dofs[:, some]], lame, shear)
        weighted = slopes * dx[:, :, None]
        np.add.at(force, numbers, -np.einsum("keqai,neqi->neak", stress, weighted, optimize=True))
        products = np.einsum("neqi,neqj->neij", weighted, slopes, optimize=True)
        trace = np.einsum("neii->ne", products)[:, :, None, None] * np.eye(3)
        np.add.at(own, numbers, lame * products + shear * (products.swapaxes(2, 3) + trace))
    return force, own


def _stress(shapes: Array, nodal: Array, lame: float, shear: float) -> Array:
    """Return the stress of fields at the quadrature points, (fields, elements, points, 3, 3)."""
    slope = np.einsum("nieq,neak->keqai", shapes, nodal, optimize=True)
    stress = shear * (slope + slope.swapaxes(3, 4))
    dilation = lame * np.einsum("keqaa->keq", slope)
    for axis in range(3):
        stress[..., axis, axis] += dilation
    return np.asarray(stress)


def _functions(model: Elasticity, elements: NDArray[np.intp]) -> tuple[NDArray[np.intp], Array]:
    """Numbers of the ten cubic functions of each element, and their signs, shape (10, elements).

    An edge's function changes its sign with the direction of the edge, which goes to the larger corner.
    """
    mesh = model.mesh
    numbers = np.vstack([mesh.t2e[:, elements], mesh.nedges + mesh.t2f[:, elements]])
    corners = mesh.t[:, elements]
    signs = np.ones(numbers.shape)
    for function, (a, b) in enumerate(EDGES):
        signs[function] = np.where(corners[a] < corners[b], 1.0, -1.0)
    return numbers, signs


def _reference_values(points: Array) -> Array:
    """Cubic functions at points (3, q) of the reference tetrahedron: a b (a - b) on edges, a b c on faces."""
    corner = np.vstack([1 - points.sum(axis=0), points])
    edges = [corner[a] * corner[b] * (corner[a] - corner[b]) for a, b in EDGES]
    return np.stack([*edges, *(corner[a] * corner[b] * corner[c] for a, b, c in _FACES)])


def _reference_slopes(points: Array) -> Array:
    corner = np.vstack([1 - points.sum(axis=0), points])
    slopes = []
    for i, j in EDGES:
        a, b = corner[i], corner[j]
        slopes.append(np.outer(_CORNER_SLOPES[i], 2 * a * b - b * b))
        slopes[-1] += np.outer(_CORNER_SLOPES[j], a * a - 2 * a * b)
    for face in _FACES:
        a, b, c = (corner[k] for k in face)
        products = zip(face, (b * c, a * c, a * b), strict=True)
        slopes.append(np.sum([np.outer(_CORNER_SLOPES[k], others) for k, others in products], axis=0))
    return np.stack(slopes)


def _mean_weights(model: Elasticity, z_mm: tuple[float, float]) -> Array:
    basis, inside = basis_above_plane(model, *z_mm)
    numbers, signs = _functions(model, basis.tind)
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


def straightened(
    model: Elasticity, mesh: TetMesh, blocks: Sequence[Superelement], youngs_MPa: float, poisson: float
) -> tuple[list[Array], float]:
    """Return the energy that straight elements add to fields of condensed blocks, and the volume, mm3.

    A quadratic form per block as `hierarchical_estimator` has them, less than 0 where volume is added.
    """
    away = np.zeros(model.nodes_mm.shape)
    if mesh.off_surface_mm is not None:
        away[:, model.mesh.dofs.element_dofs] = mesh.off_surface_mm[:, mesh.cells]
    off = (away != 0).any(axis=0, keepdims=True)[0]
    moved = np.flatnonzero(off[model.mesh.dofs.element_dofs].any(axis=0))
    if not len(moved):
        return [np.zeros((block.fields.shape[1],) * 2) for block in blocks], 0.0
    every = np.hstack([block.fields for block in blocks])
    ends = (0.0,) if blocks[0].copies == 2 else (0.0, float(model.nodes_mm[2].max()))
    added = _added(model, every, away, moved, (youngs_MPa, poisson))
    added += _by_sections(model, every, away, ends)
    columns = zip(blocks, _columns(blocks), strict=True)
    forms = [-block.parts * added[some, some] for block, some in columns]
    return forms, _volume(model, away, moved)


def _added(
    model: Elasticity, fields: Array, away: Array, moved: NDArray[np.intp], elastic: tuple[float, float]
) -> Array:
    """Return what the works of fields on each other gain, to first order, where the nodes go all the way.

    Sections move as before; where the load acts is held.
    """
    count = fields.shape[1]
    form = np.zeros((count, count))
    for basis in chunks(model, STIFFNESS_ORDER, moved):
        shapes = basis.slopes
        slopes = np.stack([displacement_slopes(basis, shapes, field) for field in fields.T])
        way = displacement_slopes(basis, shapes, away.T.ravel())
        stress = full_tensor(hooke(tensor_strain(slopes), *elastic)) * basis.dx[..., None, None]
        growth = np.einsum("eqii->eq", way)[..., None, None]
        flat, turned = stress.reshape(count, -1), (slopes @ way).reshape(count, -1)
        form += (stress * growth).reshape(count, -1) @ slopes.reshape(count, -1).T
        form -= flat @ turned.T + turned @ flat.T
    return form


def _by_sections(model: Elasticity, fields: Array, away: Array, ends: Sequence[float]) -> Array:
    """Return what they gain where the nodes of the sections move, which turn rigidly as before."""
    forces = (model.stiffness @ fields).reshape(-1, 3, fields.shape[1])
    form = np.zeros((fields.shape[1],) * 2)
    for z in ends:
        section, turns = section_turns(model, fields, z)
        torques = np.cross(away.T[section][:, :, None], forces[section], axis=1).sum(axis=0)
        form += torques.T @ turns + turns.T @ torques
    return form


def _volume(model: Elasticity, away: Array, moved: NDArray[np.intp]) -> float:
    """Volume that the way of the nodes takes off, to first order."""
    taken = 0.0
    for basis in chunks(model, STIFFNESS_ORDER, moved):
        way = away[:, basis.element_dofs]
        taken -= float(np.einsum("jne,njeq,eq->", way, basis.slopes, basis.dx, optimize=True))
    return taken


@dataclass(frozen=True)
class DiscretisationError:
    """Twice the energy that the fields of a condensed block miss, as quadratic forms over their amplitudes.

    Attributes:
        surplus: what cubic displacements would add.
        straight: what elements miss that are straight where the surface is not.
        volume_error: volume of the mesh over that of the body, less one, without what straight elements add.
    """

    surplus: Array
    straight: Array
    volume_error: float
