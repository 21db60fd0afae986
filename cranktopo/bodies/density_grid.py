"""Density in the cells of the web region, as handed over by the optimiser."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

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
        """Coordinates of the cell centres along one axis, (n,), mm."""
        number = np.arange(self.density.shape[axis], dtype=np.float64)
        return float(self.origin_mm[axis]) + (number + 0.5) * float(self.cell_mm[axis])

    def volume_mm3(self, solid_fraction: Array | None = None) -> float:
        """Volume of material, mm3.

        Args:
            solid_fraction: (nx, ny, nz) part of each cell that can hold material at all (cells cut by a
                bore or by the envelope); all of it by default.
        """
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
