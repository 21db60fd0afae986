"""Cyclic stress over all load states, from unit stresses: no state costs a solve.

Squared von Mises stress is a quadratic form of the loads at each node, the first invariant a linear one, so
the states of a cycle are two matrix products. A cycle is measured by the signed von Mises stress of its
states, or by the tensors between two of them: these feel nothing of a stress that stands still.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from cranktopo.base.arrays import Array, Index
from cranktopo.numerics.tetrahedra.stress import DEVIATOR, SurfaceStress, von_mises
from cranktopo.tasks.fatigue.criterion import LocalStress

_VALUES = 2**18
"""Values of nodes in states at a time: they stay in the cache of a core."""
_TURNS = 20
"""Most steps from a state to the farthest from it; three or four are enough."""


@dataclass(frozen=True)
class StressRange:
    """The cycle of every node between its two extreme states.

    Attributes:
        highest, lowest: state of the largest and of the smallest value, shape (n,); of tensors in any order.
    """

    local: LocalStress
    highest: Index
    lowest: Index


@dataclass(frozen=True)
class Measure:
    """A reading of cycles: their extreme states, and the stress between these.

    Attributes:
        ranges: extreme states of cycles, (states, fields) each, on a surface.
        local: cyclic stress of nodes between two states, from stresses and their derivatives into the depth
            in both, (2, n, 6) each.
    """

    ranges: Callable[[SurfaceStress, Sequence[Array]], list[StressRange]]
    local: Callable[[Array, Array], LocalStress]


def signed_von_mises_range(stress: SurfaceStress, loads: Array) -> StressRange:
    """Return the extreme signed von Mises stresses over load states at every surface node.

    On a surface free of traction the dominating principal stress has the sign of the first invariant.

    Args:
        loads: factor of each field in each state, shape (states, fields).
    """
    return signed_von_mises_ranges(stress, (loads,))[0]


def signed_von_mises_ranges(surface_stress: SurfaceStress, cycles: Sequence[Array]) -> list[StressRange]:
    """Return what `signed_von_mises_range` does of each of several cycles, (states, fields) each."""
    count = surface_stress.stress_MPa.shape[1]
    extreme = np.empty((len(cycles), 2, count), dtype=np.intp)
    products = [load_products(loads) for loads in cycles]
    step = max(_VALUES // max(len(loads) for loads in cycles), 1)
    for start in range(0, count, step):
        chunk = slice(start, start + step)
        stress = surface_stress.stress_MPa[:, chunk]
        form, trace = von_mises_form(stress), trace_form(stress)
        for cycle, (loads, squares) in enumerate(zip(cycles, products, strict=True)):
            signed = form @ squares
            np.maximum(signed, 0.0, out=signed)
            np.copysign(signed, trace @ loads.T, out=signed)
            extreme[cycle, :, chunk] = signed.argmax(axis=1), signed.argmin(axis=1)
    return [_range(surface_stress, loads, *states) for loads, states in zip(cycles, extreme, strict=True)]


def _range(stress: SurfaceStress, loads: Array, high: Index, low: Index) -> StressRange:
    """Return the range between the states of the largest and the smallest value of every node."""
    return StressRange(local_stress(*extreme_stresses(stress, loads[high], loads[low])), high, low)


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


def tensor_ranges(surface_stress: SurfaceStress, cycles: Sequence[Array]) -> list[StressRange]:
    """Return the range of the stress tensor over each of several cycles, (states, fields) each.

    Its ends are two states that are each the farthest from the other, by the von Mises stress of the
    difference: no other pair is noticeably farther.
    """
    count = surface_stress.stress_MPa.shape[1]
    found = []
    for loads in cycles:
        swinging = loads - loads.mean(axis=0)  # without what stands still
        step = max(_VALUES // len(loads), 1)
        products, ends = load_products(swinging), np.empty((2, count), dtype=np.intp)
        for start in range(0, count, step):
            stress = surface_stress.stress_MPa[:, start : start + step]
            ends[:, start : start + step] = _farthest_pair(
                stress, swinging, von_mises_form(stress) @ products
            )
        found.append(StressRange(tensor_stress(*extreme_stresses(surface_stress, *loads[ends])), *ends))
    return found


def _farthest_pair(stress: Array, loads: Array, squares: Array) -> tuple[Index, Index]:
    """Return two states of every node; squares are those of the von Mises stress, (n, states)."""

    def farthest(states: Index) -> Index:
        weighted = _at(stress, loads[states]) @ DEVIATOR
        shared = np.einsum("fnc,nc->nf", stress, weighted) @ loads.T
        return np.asarray((squares - 2 * shared).argmax(axis=1))

    before = squares.argmax(axis=1)
    here = farthest(before)
    for _ in range(_TURNS):
        ahead = farthest(here)
        if (ahead == before).all():
            break
        before, here = here, ahead
    return before, here


def tensor_stress(stress_MPa: Array, depth_MPa_per_mm: Array) -> LocalStress:
    """Return the cyclic stress of nodes by the tensors of its two ends, (2, n, 6) each.

    The amplitude is the von Mises stress of half their difference, whose gradient counts (FKM guideline:
    amplitudes of the components first, then their equivalent stress). The mean is the first invariant of the
    tensor midway, at most its von Mises stress: the signed one, but that it falls to zero where the principal
    stresses have different signs, in place of a jump. A mean shear hardly counts: G. Sines, NACA TN 3495,
    1955.
    """
    half, below = (stress_MPa[0] - stress_MPa[1]) / 2, (depth_MPa_per_mm[0] - depth_MPa_per_mm[1]) / 2
    middle = stress_MPa.mean(axis=0)
    most = von_mises(middle)
    mean = np.clip(middle[:, :3].sum(axis=1), -most, most)
    return LocalStress(von_mises(half), mean, _related_gradient(half, below))


@cache
def _pairs(fields: int) -> tuple[Index, Index]:
    """Return the first and the second load of every product."""
    return np.triu_indices(fields)


def von_mises_form(stress: Array) -> Array:
    """Return the squared von Mises stress of nodes as a form of the loads' products, (n, pairs)."""
    return product_form(stress, stress)


def product_form(one: Array, other: Array) -> Array:
    """Return the product s D t of two tensors at nodes as a form of the loads' products, (n, pairs).

    Args:
        one, other: of each field, (fields, n, 6).
    """
    count, (first, second) = len(one), _pairs(len(one))
    left, right = one.transpose(1, 0, 2) @ DEVIATOR, other.transpose(1, 2, 0)
    every = (left @ right).reshape(-1, count**2)
    found = every.take(first * count + second, axis=1)
    found += every.take(second * count + first, axis=1)
    found *= np.where(first == second, 0.5, 1.0)
    return found


def trace_form(stress: Array) -> Array:
    """Return the first invariant of nodes as a form of the loads, (n, fields)."""
    return np.asarray(stress[..., :3].sum(axis=-1).T)


def load_products(loads: Array) -> Array:
    """Return the products of the loads in every state, (pairs, states)."""
    first, second = _pairs(loads.shape[1])
    return loads.T[first] * loads.T[second]


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


SIGNED = Measure(signed_von_mises_ranges, local_stress)
TENSOR = Measure(tensor_ranges, tensor_stress)
