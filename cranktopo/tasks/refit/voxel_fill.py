"""Voxel fill: the share of each cell of the web that an extracted body fills; the re-model fits it."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.design.schema import Scene

if TYPE_CHECKING:
    from manifold3d import Manifold

MOST = 0.5 + 1e-6
"""Share of a cell that is most of it; a plane through its middle leaves half of it but for rounding."""
_MARGIN_CELLS = 3
_DIGITS, _DIGITS_MM = 4, 3
"""Decimals of fills and of the grid's ends: bodies that differ by rounding have the same cells."""
_LINES = 3
"""Lines per cell, in y and in z, along which the body's lateral extent is taken."""


@dataclass(frozen=True)
class VoxelFill:
    """Share of each cell that is filled, mean of both sides of x = 0.

    Attributes:
        x_mm, y_mm, z_mm: cell centres; x > 0 only.
        cell_mm: (3,) edge lengths of a cell.
        filled: (nx, ny, nz) in [0, 1].
    """

    x_mm: Array
    y_mm: Array
    z_mm: Array
    cell_mm: Array
    filled: Array

    @property
    def solid(self) -> NDArray[np.bool_]:
        """Cells that are filled for the most part, (nx, ny, nz)."""
        return self.filled > MOST

    @property
    def volume_mm3(self) -> float:
        """Volume of both sides, mm3."""
        return float(2 * self.filled.sum() * np.prod(self.cell_mm))


def voxel_fill(body: Manifold, scene: Scene, cell_mm: float) -> VoxelFill:
    """Return the fill of the cells between the web faces.

    Exact in x (lengths of chords), by the mean of 3 x 3 lines per cell in y and z.

    Args:
        body: solid of the half throw or of its web.
        cell_mm: largest edge of a cell.

    Raises:
        CranktopoError: nothing of the body lies between the web faces.
    """
    start, end = scene.web_z_mm
    x0, y0, z0, x1, y1, z1 = np.round(body.bounding_box(), _DIGITS_MM).tolist()
    if body.is_empty() or z1 <= start or z0 >= end:
        raise CranktopoError(
            f"surface: nothing lies between the web faces at z = {start:g} and {end:g} mm.",
            hint="Give the design that the surface belongs to, in mm.",
        )
    margin = _MARGIN_CELLS * cell_mm
    x = _edges(0.0, max(-x0, x1) + margin, cell_mm)
    y, z = _edges(y0 - margin, y1 + margin, cell_mm), _edges(start, end, cell_mm)
    filled = np.stack([_layer(body, x, y, pair) for pair in pairwise(z)], axis=-1).round(_DIGITS)
    sizes = np.array([e[1] - e[0] for e in (x, y, z)])
    cx, cy, cz = ((e[:-1] + e[1:]) / 2 for e in (x, y, z))
    return VoxelFill(cx, cy, cz, sizes, filled)


def _edges(low: float, high: float, cell: float) -> Array:
    return np.linspace(low, high, max(1, int(np.ceil((high - low) / cell - 1e-9))) + 1)


def _layer(body: Manifold, x: Array, y: Array, z: tuple[float, float]) -> Array:
    offsets = (np.arange(_LINES) + 0.5) / _LINES
    rows = (y[:-1, None] + np.diff(y)[:, None] * offsets).ravel()
    total = np.zeros((len(x) - 1, len(rows)))
    for height in z[0] + (z[1] - z[0]) * offsets:
        for contour in body.slice(float(height)).to_polygons():
            total += _signed_lengths(np.asarray(contour), x, rows)
    share = total / (2 * _LINES * np.diff(x)[:, None])
    return np.asarray(share.reshape(len(x) - 1, len(y) - 1, _LINES).mean(axis=-1))


def _signed_lengths(contour: Array, x: Array, rows: Array) -> Array:
    """Return the length of each x cell that a contour encloses on each row; holes count negative."""
    a, b = contour, np.roll(contour, -1, axis=0)
    crosses = (a[:, None, 1] <= rows) != (b[:, None, 1] <= rows)
    edge, row = np.nonzero(crosses)
    rise = b[edge, 1] - a[edge, 1]
    at = a[edge, 0] + (rows[row] - a[edge, 1]) / rise * (b[edge, 0] - a[edge, 0])
    # What lies right of a falling edge (left of a rising one) cancels except inside the contour.
    sign = np.sign(rise)
    right = np.clip(at[:, None], x[:-1], x[1:]) - x[:-1]
    left = x[1:] - np.clip(-at[:, None], x[:-1], x[1:])
    lengths = np.zeros((len(rows), len(x) - 1))
    np.add.at(lengths, row, sign[:, None] * (right + left))
    return lengths.T
