"""Sections across the crank axis as lateral intervals at places along the throw, and what remains of several.

Intervals are exact in x, so what is integrated over them is as exact as the quadrature along the throw.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array

Span = tuple[Array, Array]
"""Lateral interval (from, to), mm; empty where from >= to."""
Section = Callable[[Array, Array], Sequence[Span]]
"""Disjoint lateral intervals at places along the throw and heights over the mid-main-journal plane, mm."""
_REMOVED = -1000
"""Weight of an interval that takes material away, among those that add it."""


def material(added: Sequence[Span], removed: Sequence[Span] = ()) -> tuple[Array, Array]:
    """Ends (intervals, ...) of what some interval of the first holds and none of the second."""
    shape = np.broadcast_shapes(*(end.shape for span in (*added, *removed) for end in span))
    ends, steps = [], []
    for weight, spans in ((1, added), (_REMOVED, removed)):
        for start, stop in spans:
            ends += [np.broadcast_to(start, shape), np.broadcast_to(np.maximum(stop, start), shape)]
            steps += [weight, -weight]
    places = np.stack(ends)
    order = places.argsort(axis=0, kind="stable")
    places = np.take_along_axis(places, order, axis=0)
    solid = np.array(steps)[order].cumsum(axis=0)[:-1] > 0
    return places[:-1], np.where(solid, places[1:], places[:-1])


def section_difference(section: Section, *removed: Section) -> Section:
    """Return what sections leave of another."""

    def spans(y_mm: Array, z_mm: Array) -> Sequence[Span]:
        taken = [span for other in removed for span in other(y_mm, z_mm)]
        return list(zip(*material(section(y_mm, z_mm), taken), strict=True))

    return spans


def together(*sections: Section) -> Section:
    """Return what lies in any of the sections."""

    def spans(y_mm: Array, z_mm: Array) -> Sequence[Span]:
        return list(zip(*material([span for one in sections for span in one(y_mm, z_mm)]), strict=True))

    return spans


def common(one: Section, other: Section) -> Section:
    """Return what lies in both sections."""

    def spans(y_mm: Array, z_mm: Array) -> Sequence[Span]:
        pairs = product(one(y_mm, z_mm), other(y_mm, z_mm))
        return [(np.maximum(low, start), np.minimum(high, stop)) for (low, high), (start, stop) in pairs]

    return spans


def disc_section(radius_mm: float, centre_mm: float = 0.0) -> Section:
    """Disc around a place along the throw, at all heights."""

    def spans(y_mm: Array, _: Array) -> Sequence[Span]:
        half = np.sqrt(np.maximum(radius_mm**2 - (y_mm - centre_mm) ** 2, 0.0))
        return [(-half, half)]

    return spans


def holds(spans: Sequence[Span], x_mm: Array) -> NDArray[np.bool_]:
    """Tell whether points lie in intervals, their ends included; broadcastable."""
    parts = [(x_mm >= low) & (x_mm <= high) & (low < high) for low, high in spans]
    return np.asarray(np.logical_or.reduce(parts))
