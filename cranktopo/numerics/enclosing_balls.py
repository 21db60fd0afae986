"""Smallest enclosing balls of many small point sets at once.

The ball of a few points is that of one of their subsets; the point that lies farthest outside joins them
until none does: E. Welzl's idea (Smallest enclosing disks, 1991) with the pivoting of B. Gaertner (Fast and
robust smallest enclosing balls, 1999), which many sets do side by side.
"""

from __future__ import annotations

from functools import cache
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array

_TOLERANCE = 1e-12
"""Relative excess of a point's distance over the radius at which it counts as enclosed."""
_PIVOTS = 60
"""Most points that join; some ten do."""
_FLAT = 1e-14
"""Share of the scatter at which a direction counts as flat; it moves the radius by half of that."""


def enclosing_balls(points: Array) -> tuple[Array, Array]:
    """Return the centres (n, d) and radii (n,) of the smallest balls around n sets of points (n, m, d).

    The radius encloses every point, so that an error of rounding makes it larger.
    """
    middle, axes = _own_axes(points)
    flat = (points - middle[:, None]) @ axes
    centre = _centres(flat)
    distance = np.linalg.norm(flat - centre[:, None], axis=2)
    return middle + np.einsum("nij,nj->ni", axes, centre), distance.max(axis=1)


def _own_axes(points: Array) -> tuple[Array, Array]:
    """Return the means and the directions (n, d, k) in which any of the sets has an extent."""
    middle = points.mean(axis=1)
    off = points - middle[:, None]
    scatter, axes = np.linalg.eigh(off.transpose(0, 2, 1) @ off)
    share = scatter / np.maximum(scatter[:, -1:], np.finfo(float).tiny)
    used = max(int((share > _FLAT).sum(axis=1).max()), 1)
    return middle, axes[:, :, -used:]


def _centres(points: Array) -> Array:
    rows, size = np.arange(len(points)), points.shape[2]
    first = points[rows, (points**2).sum(axis=2).argmax(axis=1)]
    few = np.repeat(first[:, None], size + 1, axis=1)
    centre, radius = first.copy(), np.zeros(len(points))
    active = rows
    for _ in range(_PIVOTS):
        off = ((points[active] - centre[active, None]) ** 2).sum(axis=2)
        far = off.argmax(axis=1)
        out = np.sqrt(off[np.arange(len(active)), far]) > radius[active] * (1 + _TOLERANCE)
        active, far = active[out], far[out]
        if not active.size:
            break
        joined = np.concatenate([few[active], points[active, far][:, None]], axis=1)
        centre[active], radius[active], few[active] = _ball_of_few(joined)
    return centre


def _ball_of_few(points: Array) -> tuple[Array, Array, Array]:
    """Return centre, radius and corners (n, d + 1, d) of the smallest balls around d + 2 points each."""
    subsets = _subsets(points.shape[1])
    chosen = points[:, subsets]
    centres = _circumcentres(chosen)
    off = np.linalg.norm(points[:, None] - centres[:, :, None], axis=3).max(axis=2)
    rows, best = np.arange(len(points)), off.argmin(axis=1)
    return centres[rows, best], off[rows, best], chosen[rows, best]


@cache
def _subsets(count: int) -> NDArray[np.intp]:
    """Return the subsets of two or more but not all of some points; the last of them is in each.

    The smaller ones are filled up with their first point.
    """
    size, last = count - 1, count - 1
    found = [(last, *others) for few in range(1, size) for others in combinations(range(last), few)]
    return np.array([(*one, *(last,) * (size - len(one))) for one in found])


def _circumcentres(corners: Array) -> Array:
    """Return the points (..., d) as far from all corners (..., k, d) as from the first, in their plane."""
    edges = corners[..., 1:, :] - corners[..., :1, :]
    gram = edges @ edges.swapaxes(-1, -2)
    squares = np.einsum("...ii->...i", gram)
    ridge = 1e-15 * squares.max(axis=-1, keepdims=True) + (squares <= 0)
    gram = gram + ridge[..., None] * np.eye(gram.shape[-1])
    share = np.linalg.solve(gram, squares[..., None] / 2)[..., 0]
    return np.asarray(corners[..., 0, :] + np.einsum("...k,...kd->...d", share, edges))
