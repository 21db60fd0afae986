"""Fill of each cell by a section across the crank axis.

The section's lateral intervals are exact; along the throw a quadrature goes over parts of a cell, which
are halved where both halves differ from the whole.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Index
from cranktopo.base.spans import Section
from cranktopo.throw.moments import gauss_rule

_PARTS = 4
"""Parts of a cell along the throw to begin with."""
_INNER = math.sqrt(3 / 7)
_SHARES = (np.array([-1.0, -_INNER, 0.0, _INNER, 1.0]) + 1) / 2
_WEIGHTS = np.array([9.0, 49.0, 64.0, 49.0, 9.0]) / 180
"""Lobatto points of 0 .. 1 and weights: a body that only just enters a part is seen at its end."""
_ROW_SHARES = (np.arange(_PARTS)[:, None] + _SHARES).ravel() / _PARTS
"""Places in a row of cells at which the first quadrature along the throw looks."""
_HALVINGS = 40
_GRAZED = 1e-5
"""A section that fills less of a cell, or all but less, leaves it empty or full: no slivers."""
_DIGITS = 7
_HEIGHTS = 5
"""Of the quadrature through a part of a slab."""
_THINNEST = 12
"""Halvings of a slab."""


@dataclass(frozen=True)
class FillTolerance:
    """Accuracy of the filled fractions of cells.

    Attributes:
        area: largest change of a cell's fraction in a plane by halving a part.
        slab: largest change of the filled area, in cells, by halving a part of a slab, times its share of it.
    """

    area: float = 1e-6
    slab: float = 3e-4


EXACT, QUICK = FillTolerance(), FillTolerance(1e-4, 3e-3)
"""The second one moves a stiffness by some millionths of it, and takes half of the time."""


def slab_fractions(
    x_mm: Array, y_mm: Array, z_mm: Array, section: Section, tolerance: FillTolerance = EXACT
) -> Array:
    """Return the filled fractions (nx, ny, slabs) of the cells between nodes along x and y.

    Rows of cells in which the section is the same through a slab take it from its middle. Through the others
    goes Gauss quadrature; parts of a slab are halved until the areas in both halves add up.

    Args:
        z_mm: lower and upper heights (2, slabs).
    """
    low, high = z_mm
    moving = _moving(y_mm, low, high, section)
    result = np.empty((*moving.shape, len(x_mm) - 1))
    slab, row = np.nonzero(~moving)
    middle = (low + high)[slab] / 2
    result[slab, row] = _row_fractions(x_mm, _ends(y_mm, row), middle, section, tolerance)
    slab, row = np.nonzero(moving)
    rows = _Rows(slab, _ends(y_mm, row), z_mm[:, slab])
    result[slab, row] = _through_slabs(x_mm, rows, section, tolerance) / (high - low)[slab, None]
    return np.asarray(result.transpose(2, 1, 0))


def _ends(nodes: Array, cell: Index) -> Array:
    return np.stack([nodes[cell], nodes[cell + 1]])


def _moving(y_mm: Array, low: Array, high: Array, section: Section) -> NDArray[np.bool_]:
    """Tell in which rows of cells a section differs between the heights of a slab, (slabs, rows)."""
    heights = low[:, None] + (high - low)[:, None] * gauss_rule(_HEIGHTS)[0]
    places = y_mm[:-1, None] + np.diff(y_mm)[:, None] * _ROW_SHARES
    shape = *heights.shape, *places.shape
    spans = section(np.broadcast_to(places, shape).ravel(), np.repeat(heights, places.size))
    found = np.zeros(shape[:1] + shape[2:3], dtype=bool)
    for start, end in spans:
        filled = end > start
        for side in (start, end):
            ends = np.where(filled, side, 0.0).reshape(shape)
            found |= (ends[:, 1:] != ends[:, :1]).any(axis=(1, 3))
    return found


class _Rows(NamedTuple):
    """Parts of slabs in rows of cells.

    Attributes:
        slab: that each belongs to, (n,).
        y_mm: ends along the throw, (2, n).
        z_mm: lower and upper heights, (2, n).
    """

    slab: Index
    y_mm: Array
    z_mm: Array

    def where(self, chosen: NDArray[np.bool_]) -> _Rows:
        return _Rows(self.slab[chosen], self.y_mm[:, chosen], self.z_mm[:, chosen])

    def then(self, other: _Rows) -> _Rows:
        pairs = zip(self[1:], other[1:], strict=True)
        return _Rows(np.append(self.slab, other.slab), *map(np.hstack, pairs))

    def halved(self) -> tuple[_Rows, _Rows]:
        (low, high), middle = self.z_mm, self.z_mm.mean(axis=0)
        return self._replace(z_mm=np.stack([low, middle])), self._replace(z_mm=np.stack([middle, high]))


def _through_slabs(x_mm: Array, rows: _Rows, section: Section, tolerance: FillTolerance) -> Array:
    """Return fractions times heights of rows of slabs, (n, nx), mm."""
    allowed = tolerance.slab * np.diff(rows.z_mm, axis=0)[0]
    total, row = np.zeros((len(allowed), len(x_mm) - 1)), np.arange(len(allowed))
    whole = _through(x_mm, rows, section, tolerance)
    for _ in range(_THINNEST):
        first, second = rows.halved()
        below, above = np.split(_through(x_mm, first.then(second), section, tolerance), 2)
        # What a part of a slab gains is summed over its rows: small errors of either sign are no reason.
        part = np.unique([rows.slab, rows.z_mm[0]], axis=1, return_inverse=True)[1]
        change = np.bincount(part, (below + above - whole).sum(axis=1))[part]
        open_ = np.abs(change) > allowed[row]
        np.add.at(total, row[~open_], (below + above)[~open_])
        rows, row = first.where(open_).then(second.where(open_)), np.tile(row[open_], 2)
        whole = np.concatenate([below[open_], above[open_]])
        if not len(row):
            break
    np.add.at(total, row, whole)
    return total


def _through(x_mm: Array, rows: _Rows, section: Section, tolerance: FillTolerance) -> Array:
    """Return fractions times the heights of parts of slabs, (n, nx), mm."""
    shares, weights = gauss_rule(_HEIGHTS)
    low, high = rows.z_mm[..., None]
    heights = low + (high - low) * shares
    y_mm = rows.y_mm.repeat(_HEIGHTS, axis=1)
    planes = _row_fractions(x_mm, y_mm, heights.ravel(), section, tolerance)
    planes = planes.reshape(*heights.shape, len(x_mm) - 1)
    return np.asarray((high - low) * np.einsum("nhx,h->nx", planes, weights))


def plane_fractions(
    x_mm: Array, y_mm: Array, z_mm: float, section: Section, tolerance: FillTolerance = EXACT
) -> Array:
    """Return the filled fraction (nx, ny) of the cells between nodes along x and y, at a height."""
    rows = np.arange(len(y_mm) - 1)
    heights = np.full(len(rows), z_mm)
    return _row_fractions(x_mm, _ends(y_mm, rows), heights, section, tolerance).T


def _row_fractions(
    x_mm: Array, y_mm: Array, z_mm: Array, section: Section, tolerance: FillTolerance
) -> Array:
    """Return filled fractions (n, nx) of rows of cells between places along the throw (2, n), at heights."""
    start, stop = y_mm
    rows, width = len(z_mm), stop - start
    total, largest = np.zeros((rows, len(x_mm) - 1)), np.outer(width, np.diff(x_mm))
    steps = width[:, None] * np.arange(_PARTS + 1) / _PARTS + start[:, None]
    row = np.repeat(np.arange(rows), _PARTS)
    low, high = steps[:, :-1].ravel(), steps[:, 1:].ravel()

    def areas(low: Array, high: Array) -> Array:
        return _areas(x_mm, low, high, z_mm[row], section)

    whole = areas(low, high)
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        below, above = areas(low, middle), areas(middle, high)
        open_ = (np.abs(below + above - whole) > tolerance.area * largest[row]).any(axis=1)
        np.add.at(total, row[~open_], (below + above)[~open_])
        low, high = (np.concatenate([a[open_], b[open_]]) for a, b in ((low, middle), (middle, high)))
        whole, row = np.concatenate([below[open_], above[open_]]), np.tile(row[open_], 2)
        if not len(row):
            break
    np.add.at(total, row, whole)
    fraction = np.round(total / largest, _DIGITS)
    return np.where(fraction < _GRAZED, 0.0, np.where(fraction > 1 - _GRAZED, 1.0, fraction))


def _areas(x_mm: Array, low: Array, high: Array, z_mm: Array, section: Section) -> Array:
    """Areas (parts, nx) that a section fills between places along the throw at heights, mm2.

    What is filled before a lateral end is 1 in the columns before it, a share of its own and 0 behind: two
    steps, of which the sum along a row is taken once for all ends.
    """
    size, columns = high - low, len(x_mm)
    places = low[:, None] + size[:, None] * _SHARES
    spans = section(places.ravel(), np.repeat(z_mm, len(_SHARES)))
    filled = [np.flatnonzero(end > start) for start, end in spans]  # most sections are empty at most places
    starts, stops = (
        np.concatenate([span[side][at] for span, at in zip(spans, filled, strict=True)]) for side in (0, 1)
    )
    place, ends = np.concatenate(filled * 2), np.concatenate([starts, stops])
    sign = np.repeat([-1.0, 1.0], len(starts))
    column = np.clip(np.searchsorted(x_mm, ends, side="right") - 1, 0, columns - 2)
    share = np.clip((ends - x_mm[column]) / np.diff(x_mm)[column], 0.0, 1.0)
    weight = sign * (size[:, None] * _WEIGHTS).ravel()[place]
    at = place // len(_SHARES) * columns + column
    steps = np.bincount(at, weight * (share - 1), len(low) * columns)
    steps -= np.bincount(at + 1, weight * share, len(low) * columns)
    return np.asarray(steps.reshape(-1, columns)[:, :-1].cumsum(axis=1) * np.diff(x_mm))
