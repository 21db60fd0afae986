"""How much of each cell a section across the crank axis fills, at one height or through a slab.

The section's lateral intervals are exact; along the throw a quadrature goes over parts of a cell, which
are halved where both halves differ from the whole.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.spans import Section, Span
from cranktopo.throw.moments import gauss_rule

_PARTS, _PLACES = 4, 5
"""Parts of a cell along the throw to begin with, and points of the quadrature in each, with its ends."""
_TOLERANCE = 1e-6
"""Largest change of a cell's fraction by halving a part."""
_HALVINGS = 40
_GRAZED = 1e-5
"""A section that fills less of a cell, or all but less, leaves it empty or full: no slivers."""
_DIGITS = 7
_HEIGHTS = 5
"""Of the quadrature through a part of a slab."""
_SLAB_TOLERANCE = 3e-4
"""Largest change of the filled area, in cells, by halving a part of a slab, times its share of the slab."""
_THINNEST = 12
"""Halvings of a slab."""


def slab_fractions(x_mm: Array, y_mm: Array, z_mm: tuple[float, float], section: Section) -> Array:
    """Filled fraction (nx, ny) of the cells between nodes along x and y and two heights.

    Gauss quadrature goes through the slab; parts of it are halved until the areas in both halves add up.
    """
    low, high = (np.array([end]) for end in z_mm)
    total, whole = np.zeros((len(x_mm) - 1, len(y_mm) - 1)), _through(x_mm, y_mm, low, high, section)
    for _ in range(_THINNEST):
        middle = (low + high) / 2
        below = _through(x_mm, y_mm, low, middle, section)
        above = _through(x_mm, y_mm, middle, high, section)
        change = np.abs((below + above - whole).sum(axis=(0, 1)))
        open_ = change > _SLAB_TOLERANCE * (z_mm[1] - z_mm[0])
        total += (below + above)[..., ~open_].sum(axis=-1)
        low, high = (np.concatenate([a[open_], b[open_]]) for a, b in ((low, middle), (middle, high)))
        whole = np.concatenate([below[..., open_], above[..., open_]], axis=-1)
        if not len(low):
            break
    return np.asarray((total + whole.sum(axis=-1)) / (z_mm[1] - z_mm[0]))


def _through(x_mm: Array, y_mm: Array, low: Array, high: Array, section: Section) -> Array:
    """Fractions times the heights of parts of a slab, (nx, ny, parts), mm."""
    shares, weights = gauss_rule(_HEIGHTS)
    size = high - low
    heights = low[:, None] + size[:, None] * shares
    planes = plane_fractions(x_mm, y_mm, heights.ravel(), section)
    return np.asarray(planes.reshape(*planes.shape[:2], *heights.shape) @ weights * size)


def plane_fractions(x_mm: Array, y_mm: Array, z_mm: Array, section: Section) -> Array:
    """Filled fraction (nx, ny, heights) of the cells between nodes along x and y."""
    heights, cells = len(z_mm), len(y_mm) - 1
    total, largest = np.zeros((heights * cells, len(x_mm) - 1)), np.outer(np.diff(y_mm), np.diff(x_mm))
    steps = np.diff(y_mm)[:, None] * np.arange(_PARTS + 1) / _PARTS + y_mm[:-1, None]
    row = np.repeat(np.arange(heights * cells), _PARTS)
    low, high = (np.tile(ends.ravel(), heights) for ends in (steps[:, :-1], steps[:, 1:]))

    def areas(low: Array, high: Array) -> Array:
        return _areas(x_mm, low, high, z_mm[row // cells], section)

    whole = areas(low, high)
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        below, above = areas(low, middle), areas(middle, high)
        open_ = (np.abs(below + above - whole) > _TOLERANCE * largest[row % cells]).any(axis=1)
        np.add.at(total, row[~open_], (below + above)[~open_])
        low, high = (np.concatenate([a[open_], b[open_]]) for a, b in ((low, middle), (middle, high)))
        whole, row = np.concatenate([below[open_], above[open_]]), np.tile(row[open_], 2)
        if not len(row):
            break
    np.add.at(total, row, whole)
    fraction = np.round(total.reshape(heights, cells, -1) / largest, _DIGITS).transpose(2, 1, 0)
    return np.where(fraction < _GRAZED, 0.0, np.where(fraction > 1 - _GRAZED, 1.0, fraction))


def _areas(x_mm: Array, low: Array, high: Array, z_mm: Array, section: Section) -> Array:
    """Areas (parts, nx) that a section fills between places along the throw at heights, mm2."""
    share, weights = _rule()
    size = high - low
    places = low[:, None] + size[:, None] * share
    lengths = _lengths(x_mm, section(places.ravel(), np.repeat(z_mm, _PLACES)))
    return np.einsum("pgx,g,p->px", lengths.reshape(*places.shape, -1), weights, size)


def _lengths(x_mm: Array, spans: Sequence[Span]) -> Array:
    """Lengths (places, nx) that intervals fill of the cells along x, mm."""
    left, right = x_mm[:-1], x_mm[1:]
    parts = (np.minimum(right, high[:, None]) - np.maximum(left, low[:, None]) for low, high in spans)
    return np.asarray(sum(np.maximum(part, 0.0) for part in parts))


@lru_cache(maxsize=1)
def _rule() -> tuple[Array, Array]:
    """Lobatto points of 0 .. 1 and weights: a body that only just enters a part is seen at its end."""
    inner = math.sqrt(3 / 7)
    nodes = np.array([-1.0, -inner, 0.0, inner, 1.0])
    return (nodes + 1) / 2, np.array([9.0, 49.0, 64.0, 49.0, 9.0]) / 180
