"""Sections across the crank axis as lateral intervals, what remains of several, and polygons.

Intervals are exact in x, so what is integrated over them is as exact as the quadrature along the throw.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Index

Span = tuple[Array, Array]
"""Lateral interval (from, to), mm; empty where from >= to."""
Section = Callable[[Array, Array], Sequence[Span]]
"""Disjoint lateral intervals at places along the throw and heights over the mid-main-journal plane, mm."""
_REMOVED = -1000
"""Weight of an interval that takes material away, among those that add it."""


def material(added: Sequence[Span], removed: Sequence[Span] = ()) -> tuple[Array, Array]:
    """Return the ends (intervals, ...) of what some interval of the first holds and none of the second."""
    shape = np.broadcast_shapes(*(end.shape for span in (*added, *removed) for end in span))
    places = np.empty((2 * (len(added) + len(removed)), *shape))
    for number, (start, stop) in enumerate((*added, *removed)):
        places[2 * number] = start
        np.maximum(stop, start, out=places[2 * number + 1])
    begun = np.repeat(np.array([1, _REMOVED], np.int32), (len(added), len(removed)))
    order = places.argsort(axis=0, kind="stable")
    solid = np.stack([begun, -begun], axis=1).take(order).cumsum(axis=0, dtype=np.int32)[:-1] > 0
    order *= places[0].size  # places in the flat array: to take by these is several times faster
    order += np.arange(places[0].size).reshape(shape)
    places = places.take(order)
    return places[:-1], np.where(solid, places[1:], places[:-1])


def section_difference(section: Section, *removed: Section) -> Section:
    """Return what sections leave of another."""

    def spans(y_mm: Array, z_mm: Array) -> Sequence[Span]:
        taken = [span for other in removed for span in other(y_mm, z_mm)]
        return list(zip(*material(section(y_mm, z_mm), taken), strict=True))

    return spans


def superpose_sections(*sections: Section) -> Section:
    """Return what lies in any of the sections."""

    def spans(y_mm: Array, z_mm: Array) -> Sequence[Span]:
        return list(zip(*material([span for one in sections for span in one(y_mm, z_mm)]), strict=True))

    return spans


def common(one: Section, other: Section) -> Section:
    """Return what lies in both sections."""

    def spans(y_mm: Array, z_mm: Array) -> Sequence[Span]:
        pairs = product(one(y_mm, z_mm), other(y_mm, z_mm))
        found = [(np.maximum(low, start), np.minimum(high, stop)) for (low, high), (start, stop) in pairs]
        return [(low, high) for low, high in found if np.any(low < high)] or found[:1]

    return spans


def disc_section(radius_mm: float, centre_mm: float = 0.0) -> Section:
    """Return a disc around a place along the throw, at all heights."""

    def spans(y_mm: Array, _: Array) -> Sequence[Span]:
        half = np.sqrt(np.maximum(radius_mm**2 - (y_mm - centre_mm) ** 2, 0.0))
        return [(-half, half)]

    return spans


def holds(spans: Sequence[Span], x_mm: Array) -> NDArray[np.bool_]:
    """Tell whether points lie in intervals, their ends included; broadcastable."""
    parts = [(x_mm >= low) & (x_mm <= high) & (low < high) for low, high in spans]
    return np.asarray(np.logical_or.reduce(parts))


def polygon_section(contours: list[Array]) -> Section:
    """Return the inside of closed contours (n, 2) by the even-odd rule, at all heights."""
    starts = np.concatenate([np.zeros((0, 2)), *contours])
    ends = np.concatenate([np.zeros((0, 2)), *(np.roll(contour, -1, axis=0) for contour in contours)])

    def spans(y_mm: Array, _: Array) -> Sequence[Span]:
        edge, row = _crossings(starts[:, 1], ends[:, 1], y_mm.ravel())
        (x1, y1), (x2, y2) = starts[edge].T, ends[edge].T
        cuts = x1 + (y_mm.ravel()[row] - y1) * (x2 - x1) / (y2 - y1)
        order = np.lexsort((cuts, row))
        count = np.bincount(row, minlength=y_mm.size)
        rank = np.arange(row.size) - np.repeat(np.cumsum(count) - count, count)
        table = np.zeros((max(2, int(count.max(initial=0))), y_mm.size))
        table[rank, row[order]] = cuts[order]
        table = table.reshape(len(table), *y_mm.shape)
        return list(zip(table[::2], table[1::2], strict=True))

    return spans


def _crossings(start: Array, end: Array, places: Array) -> tuple[Index, Index]:
    """Edges and places of all pairs in which an edge passes a place; a corner belongs to the edge above."""
    order = np.argsort(places, kind="stable")
    first = np.searchsorted(places, np.minimum(start, end), sorter=order)
    last = np.searchsorted(places, np.maximum(start, end), sorter=order)
    count = last - first
    edge = np.repeat(np.arange(len(start)), count)
    within = np.arange(edge.size) - np.repeat(np.cumsum(count) - count, count)
    return edge, order[first[edge] + within]


def polygon_area(corners: Array) -> float:
    """Return the area of a closed polygon (n, 2); negative where it runs clockwise, as a hole does."""
    x, y = corners.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def self_intersection(points: Array) -> tuple[float, float] | None:
    """Return where a closed polygon (n, 2) crosses, touches or runs back along itself; None where nowhere."""
    ends = np.roll(points, -1, axis=0)
    steps = ends - points
    if (np.abs(steps).max(axis=1) == 0).any():
        corner = points[np.abs(steps).max(axis=1) == 0][0]
        return float(corner[0]), float(corner[1])
    after = np.roll(steps, -1, axis=0)
    back = (_cross(steps, after) == 0) & ((steps * after).sum(axis=1) < 0)
    if back.any():
        return float(ends[back][0, 0]), float(ends[back][0, 1])
    first, second = np.triu_indices(len(points), 2)
    apart = (second - first) % len(points) != len(points) - 1  # the last edge ends where the first one starts
    return _meeting(points, ends, first[apart], second[apart])


def _meeting(starts: Array, ends: Array, i: Index, j: Index) -> tuple[float, float] | None:
    """Return where the first pair of edges meets that has a point in common."""
    sides = [
        np.sign(_cross(ends[a] - starts[a], point - starts[a]))
        for a, point in ((i, starts[j]), (i, ends[j]), (j, starts[i]), (j, ends[i]))
    ]
    boxes = np.ones(len(i), bool)
    for axis in (0, 1):
        low, high = np.minimum(starts, ends)[:, axis], np.maximum(starts, ends)[:, axis]
        boxes &= (low[i] <= high[j]) & (low[j] <= high[i])
    meet = boxes & (sides[0] * sides[1] <= 0) & (sides[2] * sides[3] <= 0)
    if not meet.any():
        return None
    a, b = i[meet][0], j[meet][0]
    along, other = ends[a] - starts[a], ends[b] - starts[b]
    turn = _cross(along, other)
    share = _cross(starts[b] - starts[a], other) / turn if turn else 0.0
    x, y = starts[a] + share * along
    return float(x), float(y)


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
