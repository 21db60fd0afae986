"""Signed equivalent stress over all load states of a cycle, from unit stresses: no state costs a solve.

Squared von Mises stress is a quadratic form of the loads at each node, the first invariant a linear one, so
the states of a cycle are two matrix products.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array, Index
from cranktopo.numerics.tetrahedra.stress import DEVIATOR, SurfaceStress, von_mises
from cranktopo.tasks.fatigue.criterion import LocalStress

_VALUES = 2**18
"""Values of nodes in states at a time: they stay in the cache of a core."""


@dataclass(frozen=True)
class SignedVonMisesRange:
    """Signed von Mises stress in its two extreme states at every node.

    Attributes:
        highest, lowest: state of the largest and of the smallest value, shape (n,).
    """

    local: LocalStress
    highest: Index
    lowest: Index


def signed_von_mises_range(stress: SurfaceStress, loads: Array) -> SignedVonMisesRange:
    """Return the extreme signed von Mises stresses over load states at every surface node.

    On a surface free of traction the dominating principal stress has the sign of the first invariant.

    Args:
        loads: factor of each field in each state, shape (states, fields).
    """
    return signed_von_mises_ranges(stress, (loads,))[0]


def signed_von_mises_ranges(
    surface_stress: SurfaceStress, cycles: Sequence[Array]
) -> list[SignedVonMisesRange]:
    """Return what `signed_von_mises_range` does of each of several cycles, (states, fields) each."""
    count = surface_stress.stress_MPa.shape[1]
    extreme = np.empty((len(cycles), 2, count), dtype=np.intp)
    products = [_products(loads) for loads in cycles]
    step = max(_VALUES // max(len(loads) for loads in cycles), 1)
    for start in range(0, count, step):
        chunk = slice(start, start + step)
        stress = surface_stress.stress_MPa[:, chunk]
        form, trace = _form(stress), stress[..., :3].sum(axis=-1).T
        for cycle, (loads, squares) in enumerate(zip(cycles, products, strict=True)):
            signed = form @ squares
            np.maximum(signed, 0.0, out=signed)
            np.copysign(signed, trace @ loads.T, out=signed)
            extreme[cycle, :, chunk] = signed.argmax(axis=1), signed.argmin(axis=1)
    return [_range(surface_stress, loads, *states) for loads, states in zip(cycles, extreme, strict=True)]


def _range(stress: SurfaceStress, loads: Array, high: Index, low: Index) -> SignedVonMisesRange:
    """Return the range between the states of the largest and the smallest value of every node."""
    return SignedVonMisesRange(local_stress(*extreme_stresses(stress, loads[high], loads[low])), high, low)


def extreme_stresses(stress: SurfaceStress, high: Array, low: Array) -> tuple[Array, Array]:
    """Return stresses, and their derivatives into the depth, in two states of every node, (2, n, 6) each.

    Args:
        high, low: factors of the fields in both states of every node, (n, fields).
    """
    both = (stress.stress_MPa, stress.depth_MPa_per_mm)
    values, slopes = (np.stack([_at(part, loads) for loads in (high, low)]) for part in both)
    return values, slopes


def local_stress(stress_MPa: Array, depth_MPa_per_mm: Array) -> LocalStress:
    """Return the cyclic stress of nodes between their highest and lowest states, (2, n, 6) each."""
    top, bottom = (signed_von_mises(one) for one in stress_MPa)
    first = (np.abs(top) >= np.abs(bottom))[:, None]
    worst, below = (np.where(first, both[0], both[1]) for both in (stress_MPa, depth_MPa_per_mm))
    gradient = _related_gradient(worst, below)
    return LocalStress((top - bottom) / 2, (top + bottom) / 2, gradient)


def _pairs(fields: int) -> list[tuple[int, int]]:
    return [(a, b) for a in range(fields) for b in range(a, fields)]


def _form(stress: Array) -> Array:
    """Return the squared von Mises stress of every node as a form of the loads' products, (n, pairs)."""
    weighted = stress @ DEVIATOR
    terms = [
        (1 if a == b else 2) * np.einsum("ni,ni->n", weighted[a], stress[b]) for a, b in _pairs(len(stress))
    ]
    return np.stack(terms, axis=1)


def _products(loads: Array) -> Array:
    """Return the products of the loads in every state, (pairs, states)."""
    return np.stack([loads[:, a] * loads[:, b] for a, b in _pairs(loads.shape[1])])


def _at(stress: Array, loads: Array) -> Array:
    """Stress of each node in its own state, shape (n, 6); loads (n, fields)."""
    return np.einsum("fnc,nf->nc", stress, loads)


def signed_von_mises(stress_MPa: Array) -> Array:
    """Return the von Mises stress with the sign of the first invariant, (n,) of (n, 6)."""
    return np.asarray(np.where(stress_MPa[:, :3].sum(axis=1) >= 0, 1.0, -1.0) * von_mises(stress_MPa))


def _related_gradient(stress: Array, depth: Array) -> Array:
    """Fall of the von Mises stress into the depth over its surface value, 1/mm; zero where it rises."""
    squared = np.einsum("ni,ij,nj->n", stress, DEVIATOR, stress)
    gradient = -np.einsum("ni,ij,nj->n", stress, DEVIATOR, depth)
    return np.asarray(np.maximum(gradient / np.maximum(squared, 1e-30), 0.0))
