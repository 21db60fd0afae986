"""Stresses at nodes of the surface by polynomials fitted to those of the elements around.

One cubic polynomial per corner, by least squares through the quadrature points of the elements within two
rings (Zienkiewicz and Zhu, The superconvergent patch recovery, Int. J. Num. Meth. Eng. 33, 1992). It scatters
half as much from mesh to mesh as means over the elements that touch a node, and its slope is the gradient.
"""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Index
from cranktopo.base.notes import at_work
from cranktopo.base.side_by_side import in_halves
from cranktopo.numerics.tetrahedra.elasticity import STIFFNESS_ORDER, Elasticity, quadrature
from cranktopo.numerics.tetrahedra.mesh import shape_values
from cranktopo.numerics.tetrahedra.stress import Surface, point_stresses

_TERMS = [axes for degree in range(4) for axes in combinations_with_replacement(range(3), degree)]
"""The 20 terms of the polynomial by the axes that they are the product of; the first is the constant."""
_FACTORS = [(_TERMS.index(axes[:-1]), axes[-1]) for axes in _TERMS[1:]]
"""Every further term as a term before it and the axis that this is multiplied by."""
_CHUNK, _POINTS = 64, 1024
"""Patches that are fitted at a time, and points at which their polynomials are told."""
_LEAST = 1e-10
"""Added to the normal equations over the mean of their diagonal: a flat patch tells no slope across it."""


@at_work("stresses on the fillets")
def fitted_stress(
    model: Elasticity,
    surface: Surface,
    chosen: NDArray[np.bool_],
    fields_mm: Array,
    elastic: tuple[float, float],
) -> tuple[Array, Array]:
    """Return the stresses of displacement fields at chosen surface nodes, and derivatives into the depth.

    Shapes (fields, nodes chosen, 6), MPa and MPa/mm. An edge node has the mean of the polynomials of both
    its ends.

    Args:
        chosen: mask of the surface nodes.
        fields_mm: shape (fields, unknowns).
        elastic: Young's modulus in MPa and Poisson's ratio.
    """
    ends = _ends(surface)[:, chosen]
    corners, place = np.unique(surface.nodes[ends], return_inverse=True)
    centres = model.nodes_mm[:, corners].T
    terms, size = _fits(model, centres, _patches(model, corners), fields_mm, elastic)
    points, inward = surface.points_mm[:, chosen].T, -surface.normals[chosen]
    found = np.zeros((len(points), 2, terms.shape[2]))

    def add(half: slice) -> None:
        for own in place.reshape(ends.shape):
            for start in range(half.start, half.stop, _POINTS):
                some = slice(start, min(start + _POINTS, half.stop))
                patch = own[some]
                at = ((points[some] - centres[patch]) / size[patch, None])[:, None]
                values = _values(at)
                slopes = np.einsum("ntpi,ni->nt", _slopes(at, values), inward[some]) / size[patch, None]
                found[some] += np.stack([values[..., 0], slopes], axis=1) @ terms[patch] / 2

    in_halves(len(points), add)
    value, depth = found.reshape(len(points), 2, len(fields_mm), 6).transpose(1, 2, 0, 3)
    return value, depth


def _ends(surface: Surface) -> Index:
    """Return both corners of every surface node as positions among these, (2, n); a corner is its own."""
    ends = np.tile(np.arange(len(surface.nodes)), (2, 1))
    for middle, pair in zip(surface.faces[3:], ((0, 1), (1, 2), (2, 0)), strict=True):
        ends[:, middle] = surface.faces[list(pair)]
    return ends


def _patches(model: Elasticity, corners: Index) -> sp.csr_matrix:
    """Return which elements touch a corner or an element that does, (corners, elements)."""
    cells = model.mesh.t
    count = cells.shape[1]
    numbers = np.tile(np.arange(count), 4)
    around = sp.csr_matrix(
        (np.ones(4 * count, np.int32), (cells.ravel(), numbers)), (int(cells.max()) + 1, count)
    )
    return sp.csr_matrix((around[corners] @ around.T) @ around)


def _fits(
    model: Elasticity, centres: Array, patches: sp.csr_matrix, fields_mm: Array, elastic: tuple[float, float]
) -> tuple[Array, Array]:
    """Return the terms of the polynomial of each patch, (patches, terms, fields 6), and its scale, mm."""
    elements, place = np.unique(patches.indices, return_inverse=True)
    values = shape_values(quadrature(STIFFNESS_ORDER)[0])
    nodes = model.nodes_mm[:, model.mesh.dofs.element_dofs[:, elements]]
    points = np.einsum("ine,qn->eqi", nodes, values, optimize=True)
    stress = point_stresses(model, elements, fields_mm, *elastic)
    stress = np.ascontiguousarray(stress.transpose(1, 2, 0, 3)).reshape(*points.shape[:2], -1)
    counts = np.diff(patches.indptr)
    order = np.argsort(counts, kind="stable")
    terms, size = np.empty((len(counts), len(_TERMS), stress.shape[2])), np.empty(len(counts))

    chunks = [order[start : start + _CHUNK] for start in range(0, len(order), _CHUNK)]
    shuffled = chunks[::2] + chunks[1::2]  # as many of the large patches in either half

    def fit(half: slice) -> None:
        for some in shuffled[half]:
            inside = np.arange(counts[some].max()) < counts[some, None]
            own = place[np.where(inside, patches.indptr[some, None] + np.arange(inside.shape[1]), 0)]
            away = points[own] - centres[some, None, None]
            terms[some], size[some] = _fit(away, stress[own], inside)

    in_halves(len(shuffled), fit)
    return terms, size


def _fit(away: Array, stress: Array, inside: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Return the terms of the polynomials through points of elements, and their scales.

    Args:
        away: points from the centres, (patches, elements, points, 3).
        stress: at them, (patches, elements, points, components).
        inside: which elements are of the patch, (patches, elements).
    """
    squared = (away**2).sum(axis=-1)
    size = np.sqrt((squared.mean(axis=2) * inside).sum(axis=1) / inside.sum(axis=1))
    weight = np.exp(-squared / (4 * size[:, None, None] ** 2)) * inside[:, :, None]
    count, weight = len(away), weight.reshape(len(away), -1)
    at = away.reshape(count, -1, 3) / size[:, None, None]
    terms = _values(at) * weight[:, None]
    weighted = stress.reshape(*weight.shape, -1) * weight[..., None]
    normal = terms @ terms.swapaxes(1, 2)
    trace = np.einsum("nii->n", normal) / len(_TERMS)
    normal += _LEAST * trace[:, None, None] * np.eye(len(_TERMS))
    return np.linalg.solve(normal, terms @ weighted), size


def _values(at: Array) -> Array:
    """Return the terms at points (n, points, 3), shape (n, terms, points)."""
    values = np.ones((len(at), len(_TERMS), at.shape[1]))
    for term, (factor, axis) in enumerate(_FACTORS, start=1):
        np.multiply(values[:, factor], at[..., axis], out=values[:, term])
    return values


def _slopes(at: Array, values: Array) -> Array:
    """Return the derivatives of the terms at points (n, points, 3), shape (n, terms, points, 3).

    Args:
        values: of the terms there, (n, terms, points).
    """
    slopes = np.zeros((*values.shape, 3))
    for term, (factor, axis) in enumerate(_FACTORS, start=1):
        slopes[:, term] = slopes[:, factor] * at[..., axis, None]
        slopes[:, term, :, axis] += values[:, factor]
    return slopes
