"""Planes, circles and cylinders through points by least squares, and how far the points lie from them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array

_TRIMMED = 6
"""Rounds in which points far from a circle are left out of its fit."""
_ON_ELLIPSE = 1e-6
"""Distance of points from an ellipse over its size below which they lie on it."""
_NEAR_ELLIPSE = 0.01
"""The same of corners from the ellipse through the outermost of them, of which they may be."""
_BAND = 4.0
"""Distance of points that are kept, over the median one."""
_DIRECTIONS = 64
"""Directions of which the one with most folds about it is taken."""
_ROUNDS, _EXACT = 12, 1e-6
"""Rounds in which the median of directions is found, and the sine between those that are one."""


@dataclass(frozen=True)
class FittedCircle:
    """A circle in a plane; `off_mm` is the distance of each point from it, outside positive."""

    centre: Array
    radius: float
    off_mm: Array


def rms(off_mm: Array) -> float:
    """Return the root of the mean of squares of distances (n,)."""
    return float(np.sqrt((off_mm**2).mean()))


def circle(points: Array, weights: Array | None = None) -> FittedCircle:
    """Return the circle through points (n, 2) by linear least squares (I. Kasa, IEEE Trans. IM 25, 1976)."""
    middle = points.mean(axis=0)
    x, y = (points - middle).T
    root = np.ones(len(x)) if weights is None else np.sqrt(weights)
    rows = np.column_stack([2 * x, 2 * y, np.ones(len(x))]) * root[:, None]
    solved, *_ = np.linalg.lstsq(rows, (x**2 + y**2) * root, rcond=None)
    radius = float(np.sqrt(max(solved[2] + solved[0] ** 2 + solved[1] ** 2, 0.0)))
    centre = middle + solved[:2]
    return FittedCircle(centre, radius, np.linalg.norm(points - centre, axis=1) - radius)


def trimmed_circle(points: Array, weights: Array, least_mm: float) -> tuple[FittedCircle, NDArray[np.bool_]]:
    """Return the circle through points (n, 2) of most weight, and which are on it: ends of fillets are not.

    Points nearer than `least_mm` stay.
    """
    on = np.ones(len(points), bool)
    for _ in range(_TRIMMED):
        found = circle(points[on], weights[on])
        off = np.linalg.norm(points - found.centre, axis=1) - found.radius
        near = np.abs(off) <= max(least_mm, _BAND * weighted_median(np.abs(off), weights))
        if near.sum() < 3 or (near == on).all():
            break
        on = near
    return FittedCircle(found.centre, found.radius, off), on


def weighted_median(values: Array, weights: Array) -> float:
    """Return the value (n,) up to which half of the weight lies."""
    return weighted_quantile(values, weights, 0.5)


def weighted_quantile(values: Array, weights: Array, share: float) -> float:
    """Return the value (n,) up to which a share of the weight lies."""
    order = np.argsort(values)
    sums = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(sums, share * sums[-1])])


def covered_rad(points: Array, centre: Array) -> tuple[float, float]:
    """Return the angle about a centre that points (n, 2) cover without their largest gap, and its middle."""
    angles = np.sort(np.arctan2(*(points - centre).T[::-1]))
    gaps = np.diff(angles, append=angles[0] + 2 * np.pi)
    largest = int(gaps.argmax())
    turn = float(2 * np.pi - gaps[largest])
    return turn, float(angles[(largest + 1) % len(angles)] + turn / 2)


def uncovered_rad(triangles: Array, centre: Array) -> float:
    """Return the largest angle about a centre that none of triangles (m, 3, 2) covers.

    Corners leave gaps as wide as facets; the triangles between them leave none.
    """
    away = triangles - centre
    angles = np.arctan2(away[..., 1], away[..., 0])
    turns = (angles - angles[:, :1] + np.pi) % (2 * np.pi) - np.pi
    low, high = (angles[:, 0] + turns.min(axis=1)) % (2 * np.pi), np.ptp(turns, axis=1)
    order = np.argsort(low)
    starts = np.concatenate([low[order], low[order] + 2 * np.pi])
    reached = np.maximum.accumulate(starts + np.tile(high[order], 2))
    return float(max((starts[1:] - reached[:-1])[len(low) - 1 :].max(), 0.0))


def tangent_fillet(out: Array, z: Array, radius: float) -> tuple[float, float]:
    """Return radius and height of the centre of a circle through (out, z) that touches out = `radius`."""
    start = circle(np.column_stack([out, z]))
    found = np.array([start.radius, start.centre[1]])
    for _ in range(_TRIMMED):
        tube, height = found
        away = np.maximum(np.hypot(out - radius - tube, z - height), 1e-12)
        slope = np.column_stack([-(out - radius - tube) / away - 1, -(z - height) / away])
        found = found - np.linalg.lstsq(slope, away - tube, rcond=None)[0]
    return float(found[0]), float(found[1])


def near_ellipse(corners: Array) -> tuple[float, float]:
    """Return the semi-axes along x and y of the ellipse about the origin that corners (n, 2) lie near.

    The largest coordinates are too small by up to the chords between corners; they begin the search.
    """
    squares = corners**2
    inverse = 1 / squares.max(axis=0)
    on = np.abs(squares @ inverse - 1) < _NEAR_ELLIPSE
    fitted = _inverse_squares(squares[on])
    x, y = 1 / np.sqrt(fitted if (fitted > 0).all() else inverse)
    return float(x), float(y)


def centred_ellipse(points: Array) -> tuple[float, float] | None:
    """Return the semi-axes along x and y of the ellipse about the origin through points (n, 2), if any."""
    squares = points**2
    inverse = _inverse_squares(squares)
    if (inverse <= 0).any() or np.abs(squares @ inverse - 1).max() > _ON_ELLIPSE:
        return None
    x, y = 1 / np.sqrt(inverse)
    return float(x), float(y)


def _inverse_squares(squares: Array) -> Array:
    """Return the inverse squares of both semi-axes, by least squares over squared coordinates (n, 2)."""
    return np.asarray(np.linalg.lstsq(squares, np.ones(len(squares)), rcond=None)[0], dtype=np.float64)


def tilt(unit: Array, heights: Array, off_mm: Array) -> Array:
    """Return the slopes (2,) of a cylinder's axis, from distances of points beside one that is nearly it.

    Args:
        unit: directions of the points from its axis, (n, 2).
        heights: of the points along it, from their mean.
    """
    slope = np.column_stack([unit, unit * heights[:, None], np.ones(len(heights))])
    return np.asarray(np.linalg.lstsq(slope, off_mm, rcond=None)[0][2:4])


def median_direction(folds: Array, weights: Array, spread: float) -> Array | None:
    """Return the median of the unit folds (n, 3) within a sine of the direction that most of them have.

    A mean would be turned by drillings and roundings beside it. None without folds.
    """
    if not len(folds):
        return None
    near_cosine = 1 - spread**2 / 2
    tried = np.random.default_rng(0).choice(len(folds), _DIRECTIONS, p=weights / weights.sum())
    axis = max(
        (folds[index] for index in tried),
        key=lambda d: float(weights[np.abs(folds @ d) > near_cosine].sum()),
    )
    for _ in range(_ROUNDS):
        near = np.abs(folds @ axis) > near_cosine
        aside = np.linalg.norm(np.cross(folds[near], axis), axis=1)
        own = weights[near] / np.maximum(aside, _EXACT)
        axis = np.linalg.eigh((folds[near].T * own) @ folds[near])[1][:, -1]
    return np.asarray(axis)


def across(axis: Array) -> Array:
    """Return two unit vectors (2, 3) across an axis."""
    helper = np.eye(3)[int(np.abs(axis).argmin())]
    first = np.cross(axis, helper)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(axis, first)])
