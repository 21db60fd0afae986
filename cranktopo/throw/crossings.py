"""Heights at which the edge of an oblique cut moves over the edges of other cuts: kinks of a section."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.throw.feature import Body

_INSIDE = 1e-7
"""Distance inside an interval of heights at which its ends are looked at, over its size."""
_STEPS = 14
_TINY = 1e-300
Gap = Callable[[Array, Array], Array]
"""Of places along the throw and heights, mm."""


def crossings(bodies: Sequence[Body], y_mm: Array, breaks_mm: Array) -> Array:
    """Return heights of crossings between breaks (y, n), (y, most of a place); the rest the first break."""
    rows, heights = [np.zeros(0, dtype=np.intp)], [np.zeros(0)]
    for gap in _gaps([body for body in bodies if not body.adds]):
        row, height = roots(gap, y_mm, breaks_mm)
        rows.append(row)
        heights.append(height)
    row, height = np.concatenate(rows), np.concatenate(heights)
    order = np.argsort(row, kind="stable")
    row, height = row[order], height[order]
    count = np.bincount(row, minlength=len(y_mm))
    found = np.repeat(breaks_mm[:, :1], int(count.max(initial=0)), axis=1)
    found[row, np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)] = height
    return found


def _gaps(cuts: Sequence[Body]) -> Iterator[Gap]:
    """Yield, for each oblique cut and each edge of another, how far its own edge lies farther out."""
    zero = np.zeros(1)
    for cut in (cut for cut in cuts if cut.oblique):
        for other in (other for other in cuts if other is not cut):
            for number in range(len(other.spans(zero, zero))):
                for side in (0, 1):
                    yield partial(_gap, cut, other, number, side)


def _gap(cut: Body, other: Body, number: int, side: int, y_mm: Array, z_mm: Array) -> Array:
    own, edge = cut.spans(y_mm, z_mm)[-1][0], other.spans(y_mm, z_mm)[number][side]
    return np.asarray(own - np.abs(edge))


def roots(gap: Gap, y_mm: Array, breaks_mm: Array) -> tuple[NDArray[np.intp], Array]:
    """Return where a gap changes its sign between breaks: rows and heights, by the Illinois method."""
    inside = _INSIDE * np.diff(breaks_mm, axis=1)
    low, high = breaks_mm[:, :-1] + inside, breaks_mm[:, 1:] - inside
    below, above = gap(y_mm[:, None], low), gap(y_mm[:, None], high)
    row, column = np.nonzero(below * above < 0)
    low, high, below, above = (one[row, column] for one in (low, high, below, above))
    middle, at = low, y_mm[row]
    for _ in range(_STEPS if len(row) else 0):
        middle = high - above * (high - low) / (above - below)
        found = gap(at, middle)
        turned = found * above < 0
        low, below = np.where(turned, high, low), np.where(turned, above, below / 2)
        high, above = middle, found
        above = np.where(above == below, np.copysign(_TINY, -below), above)
    return row, middle
