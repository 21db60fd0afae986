"""Signed equivalent stress over all load states of a cycle, from unit stresses: no state costs a solve.

Squared von Mises stress is a quadratic form of the loads at each node, the first invariant a linear one, so
the states of a cycle are two matrix products.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.numerics.tetrahedra.stress import DEVIATOR, SurfaceStress, von_mises
from cranktopo.tasks.fatigue.criterion import LocalStress

Index = NDArray[np.intp]

_CHUNK = 4096


@dataclass(frozen=True)
class SignedVonMisesRange:
    """Signed von Mises stress in its two extreme states at every node.

    Attributes:
        highest, lowest: state of the largest and of the smallest value, shape (n,).
    """

    local: LocalStress
    highest: Index
    lowest: Index


def signed_von_mises_range(found: SurfaceStress, loads: Array) -> SignedVonMisesRange:
    """Extreme signed von Mises stresses over load states at every surface node.

    On a surface free of traction the dominating principal stress has the sign of the first invariant.

    Args:
        loads: factor of each field in each state, shape (states, fields).
    """
    count = found.stress_MPa.shape[1]
    high, low = np.empty(count, dtype=np.intp), np.empty(count, dtype=np.intp)
    for start in range(0, count, _CHUNK):
        chunk = slice(start, start + _CHUNK)
        signed = _signed(found.stress_MPa[:, chunk], loads)
        high[chunk], low[chunk] = signed.argmax(axis=1), signed.argmin(axis=1)
    upper, lower = (_at(found.stress_MPa, loads[state]) for state in (high, low))
    top, bottom = _sign(upper) * von_mises(upper), _sign(lower) * von_mises(lower)
    worst = np.where(np.abs(top) >= np.abs(bottom), high, low)
    gradient = _related_gradient(
        _at(found.stress_MPa, loads[worst]), _at(found.depth_MPa_per_mm, loads[worst])
    )
    return SignedVonMisesRange(LocalStress((top - bottom) / 2, (top + bottom) / 2, gradient), high, low)


def _signed(stress: Array, loads: Array) -> Array:
    """Signed von Mises stress of every node in every state, shape (n, states)."""
    fields = len(stress)
    pairs = [(a, b) for a in range(fields) for b in range(a, fields)]
    form = [(1 if a == b else 2) * np.einsum("ni,ij,nj->n", stress[a], DEVIATOR, stress[b]) for a, b in pairs]
    products = [loads[:, a] * loads[:, b] for a, b in pairs]
    squared = np.stack(form, axis=1) @ np.stack(products)
    trace = stress[..., :3].sum(axis=-1).T @ loads.T
    return np.asarray(np.where(trace >= 0, 1.0, -1.0) * np.sqrt(np.maximum(squared, 0.0)))


def _at(stress: Array, loads: Array) -> Array:
    """Stress of each node in its own state, shape (n, 6); loads (n, fields)."""
    return np.einsum("fnc,nf->nc", stress, loads)


def _sign(stress: Array) -> Array:
    return np.where(stress[:, :3].sum(axis=1) >= 0, 1.0, -1.0)


def _related_gradient(stress: Array, depth: Array) -> Array:
    """Fall of the von Mises stress into the depth over its surface value, 1/mm; zero where it rises."""
    squared = np.einsum("ni,ij,nj->n", stress, DEVIATOR, stress)
    fall = -np.einsum("ni,ij,nj->n", stress, DEVIATOR, depth)
    return np.asarray(np.maximum(fall / np.maximum(squared, 1e-30), 0.0))
