"""Heights at which the edge of an oblique cut moves over the edges of other cuts: kinks of a section."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np

from cranktopo.base.arrays import Array, Index
from cranktopo.throw.feature import Body

_INSIDE = 1e-7
"""Distance inside an interval of heights at which its ends are looked at, over its size."""
_STEPS = 14
_SETTLED = 1e-9
"""Last step over the size of its interval that ends a search: an integral errs by its square."""
_TINY = 1e-300
Gap = Callable[[Array, Array], Array]
"""Of places along the throw and heights, mm."""


def crossings(bodies: Sequence[Body], y_mm: Array, breaks_mm: Array) -> Array:
    """Return heights of crossings between breaks (y, n), (y, most of a place); the rest the first break."""
    rows, heights = [np.zeros(0, dtype=np.intp)], [np.zeros(0)]
    for row, height in _all_crossings([body for body in bodies if not body.adds], y_mm, breaks_mm):
        rows.append(row)
        heights.append(height)
    row, height = np.concatenate(rows), np.concatenate(heights)
    order = np.argsort(row, kind="stable")
    row, height = row[order], height[order]
    count = np.bincount(row, minlength=len(y_mm))
    found = np.repeat(breaks_mm[:, :1], int(count.max(initial=0)), axis=1)
    found[row, np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)] = height
    return found


def _all_crossings(cuts: Sequence[Body], y_mm: Array, breaks_mm: Array) -> Iterator[tuple[Index, Array]]:
    """Yield rows and heights where the edge of an oblique cut meets an edge of another, edge by edge."""
    ends = _inside(breaks_mm)
    for cut in (cut for cut in cuts if cut.oblique):
        own = [_own_edge(cut, y_mm[:, None], z) for z in ends]
        for other in (other for other in cuts if other is not cut):
            for place, edges in _other_edges(other, y_mm[:, None], ends):
                gaps = [mine - edge for mine, edge in zip(own, edges, strict=True)]
                yield _between(partial(_gap, cut, other, *place), y_mm, ends, gaps)


def _other_edges(
    other: Body, y_mm: Array, ends: Sequence[Array]
) -> Iterator[tuple[tuple[int, int], list[Array]]]:
    """Yield the number and the side of each edge with how far out it lies at both ends; like ones once."""
    known: list[list[Array]] = []
    spans = [other.spans(y_mm, z) for z in ends]
    for number in range(len(spans[0])):
        for side in (0, 1):
            edges = [np.abs(one[number][side]) for one in spans]
            if not any(all(map(np.array_equal, edges, before)) for before in known):
                known.append(edges)
                yield (number, side), edges


def _own_edge(cut: Body, y_mm: Array, z_mm: Array) -> Array:
    return cut.spans(y_mm, z_mm)[-1][0]


def _gap(cut: Body, other: Body, number: int, side: int, y_mm: Array, z_mm: Array) -> Array:
    """Distance by which the edge of an oblique cut lies farther out than one of another."""
    return np.asarray(_own_edge(cut, y_mm, z_mm) - np.abs(other.spans(y_mm, z_mm)[number][side]))


def roots(gap: Gap, y_mm: Array, breaks_mm: Array) -> tuple[Index, Array]:
    """Return where a gap changes its sign between breaks: rows and heights."""
    ends = _inside(breaks_mm)
    return _between(gap, y_mm, ends, [gap(y_mm[:, None], z) for z in ends])


def _inside(breaks_mm: Array) -> tuple[Array, Array]:
    inside = _INSIDE * np.diff(breaks_mm, axis=1)
    return breaks_mm[:, :-1] + inside, breaks_mm[:, 1:] - inside


def _between(gap: Gap, y_mm: Array, ends: tuple[Array, Array], gaps: Sequence[Array]) -> tuple[Index, Array]:
    """Return where a gap that is known at both ends of intervals (y, n) is none, by the Illinois method."""
    row, column = np.nonzero(gaps[0] * gaps[1] < 0)
    low, high, below, above = (one[row, column] for one in (*ends, *gaps))
    middle, at, near = low, y_mm[row], _SETTLED * (high - low)
    for _ in range(_STEPS if len(row) else 0):
        before, middle = middle, high - above * (high - low) / (above - below)
        if (np.abs(middle - before) <= near).all():
            break
        found = gap(at, middle)
        turned = found * above < 0
        low, below = np.where(turned, high, low), np.where(turned, above, below / 2)
        high, above = middle, found
        above = np.where(above == below, np.copysign(_TINY, -below), above)
    return row, middle
