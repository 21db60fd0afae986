"""The constraint of a process, kept between the cells as well: what it leaves of a resampled density.

The hard form of what `optimise.forging_constraint` and `optimise.tool_access` do smoothly on cells. A tool's
radius is left to the cells.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.frames import X, Y
from cranktopo.bodies.undercuts import Withdrawal, withdrawal_of
from cranktopo.design.schema import Scene


def released(
    field: Array, first_mm: Array, spacing_mm: Array, usable: NDArray[np.bool_], scene: Scene
) -> Array:
    """Return the least field above a given one that its process can make.

    Args:
        field: (nx, ny, nz) on a lattice whose first point is at `first_mm`.
        usable: points that can hold material; the others are no obstacle.
    """
    way = withdrawal_of(scene)
    if way.parting_mm is not None:
        return _by_die(field, first_mm, spacing_mm, way, scene)
    main, pin = _journal_sections(field, first_mm, spacing_mm, scene)
    solid = np.concatenate([main, np.where(usable, field, 0.0), pin], axis=2)
    left = np.min([_closed_along(solid, axis, spacing_mm, scene) for axis in way.axes], axis=0)
    # In a bore the solid on both sides goes on: what the drill leaves beside it has no gap.
    return np.where(usable, left[:, :, 1:-1], np.maximum(field, left[:, :, 1:-1]))


def _journal_sections(field: Array, first_mm: Array, spacing_mm: Array, scene: Scene) -> tuple[Array, Array]:
    """Return the layers beyond both faces: 1 where a journal stands."""
    x, y = (first_mm[axis] + spacing_mm[axis] * np.arange(field.shape[axis]) for axis in (X, Y))
    main, pin = (
        (np.hypot(x[:, None], y[None, :] - centre) < journal.radius_mm).astype(np.float64)[:, :, None]
        for journal, centre in scene.throw.journals
    )
    return main, pin


def _by_die(field: Array, first_mm: Array, spacing_mm: Array, way: Withdrawal, scene: Scene) -> Array:
    """Return each side raised to what lies further out.

    What ends at the parting plane goes on to the first points beyond it: its edge, which smoothing rounds,
    would otherwise be caught in its own half.
    """
    axis = X if way.axis is None else way.axis
    parted = way.parting_mm or 0.0
    moved = np.moveaxis(field, axis, 0).copy()
    places = first_mm[axis] + spacing_mm[axis] * np.arange(len(moved))
    count = int(np.count_nonzero(places < parted))
    draft_slope = _draft_slope(spacing_mm, axis, scene)
    moved[:count] = closed(moved[:count], draft_slope)
    moved[count:] = closed(moved[count:][::-1], draft_slope)[::-1]
    moved[count - 1 : count + 1] = moved[count - 1 : count + 1].max(axis=0)
    return np.moveaxis(moved, 0, axis)


def _closed_along(solid: Array, axis: int, spacing_mm: Array, scene: Scene) -> Array:
    """Return what both ways along an axis leave."""
    moved, draft_slope = np.moveaxis(solid, axis, 0), _draft_slope(spacing_mm, axis, scene)
    both = np.minimum(closed(moved, draft_slope), closed(moved[::-1], draft_slope)[::-1])
    return np.moveaxis(both, 0, axis)


def closed(field: Array, draft_slope: tuple[float, float]) -> Array:
    """Raise the field, layer by layer from the first on, to the layers before it and their draft."""
    if not any(draft_slope):
        return np.asarray(np.maximum.accumulate(field))
    found = field.copy()
    for layer in range(1, len(found)):
        found[layer] = np.maximum(found[layer], _dilated(found[layer - 1], draft_slope))
    return found


def _dilated(layer: Array, draft_slope: tuple[float, float]) -> Array:
    """Return a layer and its steepest climb over so many points along each axis; flat beyond its edges."""
    square = np.zeros_like(layer)
    for axis, part in enumerate(draft_slope):
        padded = np.pad(layer, [(1, 1) if axis == other else (0, 0) for other in range(2)], mode="edge")
        sides = np.stack([np.take(padded, range(k, k + layer.shape[axis]), axis) for k in (0, 2)])
        square += (part * np.maximum(0.0, sides.max(axis=0) - layer)) ** 2
    return layer + np.sqrt(square)


def _draft_slope(spacing_mm: Array, axis: int, scene: Scene) -> tuple[float, float]:
    if scene.optimise.process == "milled":
        return 0.0, 0.0
    slope = math.tan(math.radians(scene.optimise.draft_deg)) * float(spacing_mm[axis])
    first, second = (slope / float(step) for other, step in enumerate(spacing_mm) if other != axis)
    return first, second
