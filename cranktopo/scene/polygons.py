"""Point membership of closed contours."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Coordinates = NDArray[np.float64]
Shape = Callable[[Coordinates, Coordinates], NDArray[np.bool_]]
"""Whether points, x and y in mm, lie inside."""


def polygons(contours: list[Coordinates]) -> Shape:
    """Inside of closed contours (n, 2) by the even-odd rule, for x of shape (n, 1) and y of shape (1, m)."""
    starts = np.concatenate([np.zeros((0, 2)), *contours])
    ends = np.concatenate([np.zeros((0, 2)), *(np.roll(contour, -1, axis=0) for contour in contours)])

    def inside(x: Coordinates, y: Coordinates) -> NDArray[np.bool_]:
        rows = [_crossings(starts, ends, value) for value in y.ravel()]
        # A point is inside if the ray towards -x crosses the boundary an odd number of times.
        counts = [np.searchsorted(row, x.ravel()) for row in rows]
        return np.asarray(np.stack(counts, axis=1) % 2 == 1)

    return inside


def _crossings(starts: Coordinates, ends: Coordinates, y: float) -> Coordinates:
    """Sorted x where the edges cross a line of constant y."""
    (x1, y1), (x2, y2) = starts.T, ends.T
    crosses = (y1 <= y) != (y2 <= y)
    x1, y1, x2, y2 = (values[crosses] for values in (x1, y1, x2, y2))
    return np.sort(x1 + (y - y1) * (x2 - x1) / (y2 - y1))
