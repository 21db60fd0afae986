"""The grid of the half throw: planes on the web faces, axes padded for multigrid coarsening."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

# The coarsest grid is solved densely: stop halving once it has at most so many unknowns.
_COARSEST_UNKNOWNS = 1500


@dataclass(frozen=True)
class Grid:
    """Node coordinates of a structured grid; uniform along x and y, one cell height per slab along z.

    Attributes:
        x_mm: nodes along x (nx + 1,), mm.
        y_mm: nodes along y.
        z_mm: nodes along z; the web faces are among them.
        padding: cells added beyond the body along (x, y), void, and slab cells added along z.
        levels: how often all axes can be halved.
    """

    x_mm: NDArray[np.float64]
    y_mm: NDArray[np.float64]
    z_mm: NDArray[np.float64]
    padding: tuple[int, int, int]
    levels: int

    @property
    def cells(self) -> tuple[int, int, int]:
        """Number of cells along x, y, z."""
        return len(self.x_mm) - 1, len(self.y_mm) - 1, len(self.z_mm) - 1

    @property
    def steps_mm(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Cell edges along each axis, mm."""
        return np.diff(self.x_mm), np.diff(self.y_mm), np.diff(self.z_mm)

    @property
    def cell_volume_mm3(self) -> NDArray[np.float64]:
        """Volume of the cells of each z layer, shape (nz,), mm3."""
        dx, dy, dz = self.steps_mm
        return np.asarray(dx[0] * dy[0] * dz)


def plan_grid(
    x_range: tuple[float, float],
    y_range: tuple[float, float],
    z_planes: tuple[float, ...],
    resolution_mm: float,
) -> Grid:
    """A grid whose cells are no larger than the resolution and whose planes meet the given ranges.

    Args:
        x_range: lateral range of the body, mm.
        y_range: range along the throw, mm.
        z_planes: increasing z of planes that must be grid planes (ends, web faces, mirror), mm.
        resolution_mm: largest cell edge, mm.

    Returns:
        Grid with cell counts divisible by 2**levels.
    """
    left, right, step = _lateral_counts(x_range, resolution_mm)
    counts = [left + right, _count(y_range, resolution_mm)]
    slabs = [_count(pair, resolution_mm) for pair in zip(z_planes, z_planes[1:], strict=False)]
    levels = _levels(counts[0], counts[1], sum(slabs))
    factor = 1 << levels
    pads = [-n % factor for n in counts]
    grown = _grow_slabs(slabs, z_planes, factor)
    x = step * np.arange(-left, right + pads[0] + 1)
    dy = (y_range[1] - y_range[0]) / counts[1]
    y = y_range[0] + dy * np.arange(counts[1] + pads[1] + 1)
    edges = [np.linspace(a, b, n + 1)[:-1] for a, b, n in zip(z_planes, z_planes[1:], grown, strict=False)]
    z = np.concatenate([*edges, [z_planes[-1]]])
    return Grid(x, y, z, (pads[0], pads[1], sum(grown) - sum(slabs)), levels)


def _count(span: tuple[float, float], resolution: float) -> int:
    # The small slack keeps 48 mm / 1.5 mm at 32 cells in spite of rounding.
    return max(1, math.ceil((span[1] - span[0]) / resolution - 1e-9))


def _lateral_counts(x_range: tuple[float, float], resolution: float) -> tuple[int, int, float]:
    """Cells left and right of x = 0 and their edge; x = 0 is a grid plane, so half and quarter agree."""
    reach = max(-x_range[0], x_range[1])
    step = reach / _count((0.0, reach), resolution)
    return math.ceil(-x_range[0] / step - 1e-9), math.ceil(x_range[1] / step - 1e-9), step


def _levels(nx: int, ny: int, nz: int) -> int:
    """Fewest halvings that leave a coarsest grid small enough for a dense solve."""
    for levels in range(1, 12):
        coarse = [math.ceil(n / (1 << levels)) for n in (nx, ny, nz)]
        if 3 * math.prod(n + 1 for n in coarse) <= _COARSEST_UNKNOWNS:
            return levels
    raise AssertionError("no grid that fits in memory gets here")


def _grow_slabs(slabs: list[int], planes: tuple[float, ...], factor: int) -> list[int]:
    """Add cells where they are tallest until the total divides by the factor."""
    grown = list(slabs)
    while sum(grown) % factor:
        heights = [(b - a) / n for a, b, n in zip(planes, planes[1:], grown, strict=False)]
        grown[heights.index(max(heights))] += 1
    return grown
