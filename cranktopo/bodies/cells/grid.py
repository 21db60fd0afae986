"""The grid of the half throw, its axes padded for multigrid coarsening, and a density on cells of the web."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.frames import Z
from cranktopo.design.schema import Scene

_ROUNDING = 1e-6


@dataclass(frozen=True)
class DensityGrid:
    """Physical density (filtered and projected) per cell, full width in x, between the web faces in z.

    Attributes:
        origin_mm: lower corner of the first cell, (3,), mm, in the frame of `cranktopo.base.frames`.
        cell_mm: edge lengths of a cell, (3,), mm.
        density: (nx, ny, nz), 0 = void, 1 = solid; 0 in cells outside the design envelope.
    """

    origin_mm: Array
    cell_mm: Array
    density: Array

    def __post_init__(self) -> None:
        if self.origin_mm.shape != (3,) or self.cell_mm.shape != (3,) or self.density.ndim != 3:
            raise ValueError("DensityGrid needs origin_mm (3,), cell_mm (3,) and density (nx, ny, nz)")
        if np.any(self.cell_mm <= 0) or self.density.size == 0:
            raise ValueError("DensityGrid needs cells of positive size")
        # Written so that NaN fails as well.
        if not (self.density.min() >= -_ROUNDING and self.density.max() <= 1 + _ROUNDING):
            raise ValueError("DensityGrid needs densities in [0, 1]")

    @property
    def upper_mm(self) -> Array:
        """Upper corner of the last cell, (3,), mm."""
        upper: Array = self.origin_mm + self.cell_mm * np.array(self.density.shape)
        return upper

    def centres_mm(self, axis: int) -> Array:
        """Return the coordinates of the cell centres along one axis, (n,), mm."""
        number = np.arange(self.density.shape[axis], dtype=np.float64)
        return float(self.origin_mm[axis]) + (number + 0.5) * float(self.cell_mm[axis])

    def volume_mm3(self, solid_fraction: Array | None = None) -> float:
        """Return the volume of material, mm3, in the part of each cell that can hold some."""
        filled = self.density if solid_fraction is None else self.density * solid_fraction
        return float(filled.sum() * np.prod(self.cell_mm))

    def spans_web(self, scene: Scene) -> bool:
        """Tell whether the grid reaches exactly from the journal-side to the pin-side face of the web."""
        ends = (self.origin_mm[Z], self.upper_mm[Z])
        return bool(np.allclose(ends, scene.web_z_mm, rtol=0, atol=1e-6 * scene.web.thickness_mm))


def is_x_symmetric(grid: DensityGrid, *others: Array) -> bool:
    """Tell whether grid, density and other fields on it are their own mirror image in the plane x = 0."""
    centred = bool(abs(grid.origin_mm[0] + grid.upper_mm[0]) <= _ROUNDING * grid.cell_mm[0])
    fields = [grid.density, *others]
    return centred and all(np.allclose(field, field[::-1], rtol=0, atol=_ROUNDING) for field in fields)


# The coarsest grid is solved densely: stop halving once the half throw has at most so many unknowns.
_COARSEST_UNKNOWNS = 2400

Extent = Literal["quarter", "half", "full"]


@dataclass(frozen=True)
class CellGrid:
    """Node coordinates of a structured grid; uniform along x and y, one cell height per layer along z.

    Web faces are among the z nodes. Padding counts cells added beyond the body along (x, y), void, and along
    z; levels, how often all axes can be halved.
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
    def largest_edge_mm(self) -> float:
        """Largest edge of a cell, mm."""
        return max(float(step.max()) for step in self.steps_mm)

    @property
    def cell_volume_mm3(self) -> NDArray[np.float64]:
        """Volume of the cells of each z layer, shape (nz,), mm3."""
        dx, dy, dz = self.steps_mm
        return np.asarray(dx[0] * dy[0] * dz)


Reach = tuple[tuple[float, float], tuple[float, float], tuple[float, ...]]
"""Ranges of x and y that hold the half throw, and its planes along z: ends and web faces, mm."""


def plan_grid(
    x_range: tuple[float, float],
    y_range: tuple[float, float],
    z_planes: tuple[float, ...],
    resolution_mm: float,
    extent: Extent = "half",
) -> CellGrid:
    """Return a grid whose cells are no larger than the resolution and whose planes meet the given ranges.

    The half throw is planned, whatever the extent, so that quarter, half and full model have the same cells
    and give the same stiffness. Cell counts are divisible by 2**levels.

    Args:
        x_range: lateral range of the body, both sides, mm.
        z_planes: increasing z of the half throw's planes that must be grid planes (ends, web faces), mm.
        extent: "quarter" keeps x >= 0, "full" adds the mirror image beyond the last z plane.
    """
    left, right, step = _lateral_counts(x_range, resolution_mm)
    along = _count(y_range, resolution_mm)
    layers = [_count(pair, resolution_mm) for pair in pairwise(z_planes)]
    levels = _levels(left + right, along, sum(layers))
    factor = 1 << levels
    grown = _grow_layers(layers, z_planes, factor)
    first = 0 if extent == "quarter" else left
    pad_x, pad_y = -(first + right) % factor, -along % factor
    dy = (y_range[1] - y_range[0]) / along
    return CellGrid(
        x_mm=(step * np.arange(-first, right + pad_x + 1)).astype(np.float64),
        y_mm=y_range[0] + dy * np.arange(along + pad_y + 1).astype(np.float64),
        z_mm=_axial_nodes(z_planes, grown, extent == "full"),
        padding=(pad_x, pad_y, sum(grown) - sum(layers)),
        levels=levels,
    )


def follow_grid(grid: CellGrid, before: Reach, after: Reach) -> CellGrid:
    """Return the grid of a body for what the body has become, so that both are in the same cells.

    Along the throw the cells stay where they are, and there are more of them where the body needs some.
    Sideways and along the crank axis they are stretched: a web keeps its edges and faces in theirs.
    """
    (x, y, planes), (new_x, new_y, new_planes) = before, after
    dy, factor = float(grid.y_mm[1] - grid.y_mm[0]), 1 << grid.levels
    below = max(0, math.ceil((y[0] - new_y[0]) / dy - 1e-9))
    above = max(len(grid.y_mm) - 1, math.ceil((new_y[1] - y[0]) / dy - 1e-9))
    above += -(above + below) % factor
    return replace(
        grid,
        x_mm=max(new / old for new, old in zip(new_x, x, strict=True)) * grid.x_mm,
        y_mm=(y[0] + dy * np.arange(-below, above + 1)).astype(np.float64),
        z_mm=np.interp(grid.z_mm, planes, new_planes),
    )


def _axial_nodes(planes: tuple[float, ...], counts: list[int], mirrored: bool) -> NDArray[np.float64]:
    edges = [np.linspace(a, b, n + 1)[:-1] for (a, b), n in zip(pairwise(planes), counts, strict=True)]
    half = np.concatenate([*edges, [planes[-1]]])
    return np.concatenate([half, 2 * planes[-1] - half[-2::-1]]) if mirrored else half


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


def _grow_layers(layers: list[int], planes: tuple[float, ...], factor: int) -> list[int]:
    grown = list(layers)
    while sum(grown) % factor:
        heights = [(b - a) / n for a, b, n in zip(planes, planes[1:], grown, strict=False)]
        grown[heights.index(max(heights))] += 1
    return grown
