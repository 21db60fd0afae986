"""Least safety of surfaces by a method of stress histories: most points are settled by a bound.

The signed von Mises stress and the loads alone bound what any plane of a point may have; points are judged in
full, the worst bound first, until none is left that could be the worst of its part.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Mask
from cranktopo.base.notes import at_work, detail
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.stress import DEVIATOR
from cranktopo.tasks.fatigue.plane_criterion import HistoryBounds, PlaneCriterion

_AT_A_TIME = 64
"""Points that are judged in full before the bounds of the rest are compared again."""
_STEPS = 6
"""Steps of the centre of the loads towards the farthest state."""
_VALUES = 2**18
"""Values of nodes in states at a time: they stay in the cache of a core."""
_ROUNDING = 1 + 1e-9
_HULL_DIMENSIONS = 4
_SAME = 1e-9
"""Share of the loads up to which their extent counts as none."""
_CANCELLED = 1e-13
"""Share of a squared stress that its difference to another may lose to rounding."""


@at_work("planes of the worst points")
def least_safety(
    stress_MPa: Array,
    cycles: Sequence[Array],
    strength_MPa: Array,
    parts: Sequence[Mask],
    chosen: PlaneCriterion,
    scene: Scene,
) -> Array:
    """Return the safety of points of each image, (images, n): exact where a part has its least one.

    Elsewhere it is a bound that no point of the part falls below, at most the safety of the point.

    Args:
        stress_MPa: of each unit field, shape (fields, n, 6).
        cycles: of each image, factor of each field in each state, shape (states, fields).
        strength_MPa: fully reversed strength of the points, shape (images, n).
        parts: masks of points (n,) whose least safety over all images is wanted.
    """
    corners = [loads[corner_states(loads)] for loads in cycles]
    least = np.stack([chosen.at_most_MPa(scene, history_bounds(stress_MPa, loads)) for loads in corners])
    safety = strength_MPa / np.maximum(least * _ROUNDING, 1e-12 * strength_MPa)
    exact = np.zeros(safety.shape, dtype=bool)
    while (images := _candidates(safety, exact, parts)).any():
        for image, loads in enumerate(corners):
            nodes = np.flatnonzero(images[image])
            if nodes.size:
                equivalent = chosen.severity(scene, histories(stress_MPa[:, nodes], loads)).equivalent_MPa
                strength = strength_MPa[image, nodes]
                safety[image, nodes] = strength / np.maximum(equivalent, 1e-12 * strength)
        exact |= images
    detail(f"{chosen.name}: {exact.sum()} of {exact.size} points judged on all planes")
    return np.asarray(safety)


def histories(stress_MPa: Array, loads: Array) -> Array:
    """Return the stress of points in each state, (n, states, 6), from fields (fields, n, 6)."""
    return np.asarray(np.einsum("sf,fnc->nsc", loads, stress_MPa, optimize=True))


def _candidates(safety: Array, exact: Mask, parts: Sequence[Mask]) -> Mask:
    """Return the points to judge next: the least bounds of each part that are below its least safety."""
    chosen = np.zeros_like(exact)
    for part in parts:
        known = np.where(exact & part, safety, np.inf).min()
        bound = np.where(~exact & part, safety, np.inf)
        few = np.argsort(bound, axis=None, kind="stable")[:_AT_A_TIME]
        chosen.flat[few[bound.flat[few] < known]] = True
    return chosen


def corner_states(loads: Array) -> NDArray[np.intp]:
    """Return the states (states, fields) at the corners of their convex hull: no other can be an extreme one.

    Circles, spheres and largest values of what is linear or convex in the loads are those of the hull. Where
    the loads vary in more than four ways, every state counts.
    """
    extent = np.ptp(loads, axis=0)
    constant = extent <= _SAME * np.abs(loads).max(axis=0)
    off = (loads - loads.mean(axis=0)) / np.where(constant, np.inf, extent)
    scales, axes = np.linalg.svd(off, full_matrices=False)[1:]
    varied = int((scales > _SAME).sum())
    along = off @ axes[:varied].T
    if varied == 0:
        return np.zeros(1, dtype=np.intp)
    if varied == 1:
        return np.unique([along[:, 0].argmin(), along[:, 0].argmax()])
    if varied > _HULL_DIMENSIONS or len(loads) <= varied + 1:
        return np.arange(len(loads))
    from scipy.spatial import ConvexHull

    return np.sort(ConvexHull(along).vertices).astype(np.intp)


def history_bounds(stress_MPa: Array, loads: Array) -> HistoryBounds:
    """Return what bounds the stresses of points on any plane over load states, from von Mises stresses alone.

    With the von Mises stress v of a state less some centre, its shear stress on any plane is at most
    v / sqrt(3), and so is the radius of any circle or sphere around shear stresses; the largest principal
    stress is at most the hydrostatic one and 2 v / 3, with v of the state itself. Both are equations between
    invariants of the deviator: the former is sharp in pure shear, the latter in tension.
    """
    count = stress_MPa.shape[1]
    step = max(_VALUES // len(loads), 1)
    parts = [_bounds(stress_MPa[:, at : at + step], loads) for at in range(0, count, step)]
    return HistoryBounds(*(np.concatenate(values) for values in zip(*parts, strict=True)))


def _bounds(stress: Array, loads: Array) -> tuple[Array, Array, Array]:
    form = np.einsum("fni,ij,gnj->nfg", stress, DEVIATOR, stress, optimize=True)
    squares = np.einsum("sf,nfg,sg->ns", loads, form, loads, optimize=True)
    hydrostatic = (stress[..., :3].mean(axis=-1).T) @ loads.T
    normal = hydrostatic + 2 / 3 * np.sqrt(np.maximum(squares, 0.0))
    return _swing(form, squares, loads) / np.sqrt(3), normal.max(axis=1), hydrostatic.max(axis=1)


def _swing(form: Array, squares: Array, loads: Array) -> Array:
    """Return the largest von Mises stress of the states less a centre that nears the best one of each point.

    The centre moves towards the farthest state by ever smaller steps (M. Badoiu, K. L. Clarkson, 2003); each
    step has a bound, and the least of them counts.
    """
    centre = np.tile((loads.max(axis=0) + loads.min(axis=0)) / 2, (len(form), 1))
    least = np.full(len(form), np.inf)
    for step in range(_STEPS):
        weighted = np.einsum("nfg,ng->nf", form, centre)
        off = squares - 2 * weighted @ loads.T + np.einsum("nf,nf->n", weighted, centre)[:, None]
        off += _CANCELLED * squares.max(axis=1, keepdims=True)
        far = off.argmax(axis=1)
        least = np.minimum(least, off[np.arange(len(off)), far])
        centre += (loads[far] - centre) / (step + 3)
    return np.sqrt(np.maximum(least, 0.0))
