"""The structured grid as the solver sees it: cell counts, cell sizes and the element blocks per layer."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from cranktopo.fem.element import hexahedron_stiffness, reflection_blocks

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Lattice:
    """A grid of box cells, uniform in x and y, with one height per layer in z.

    Attributes:
        cells: number of cells (nx, ny, nz).
        dx_mm: cell edge along x, mm.
        dy_mm: cell edge along y, mm.
        dz_mm: cell edge along z for each of the nz layers, mm.
        poisson: Poisson's ratio of every cell.
    """

    cells: tuple[int, int, int]
    dx_mm: float
    dy_mm: float
    dz_mm: tuple[float, ...]
    poisson: float

    @property
    def nodes(self) -> tuple[int, int, int]:
        """Number of nodes per axis."""
        nx, ny, nz = self.cells
        return nx + 1, ny + 1, nz + 1

    @property
    def field_shape(self) -> tuple[int, int, int, int]:
        """Shape of a displacement field: component, then nodes."""
        return (3, *self.nodes)

    def coarsened(self, level: int) -> tuple[int, int, int]:
        """Cell counts after `level` halvings of every axis."""
        nx, ny, nz = (n >> level for n in self.cells)
        return nx, ny, nz


@lru_cache(maxsize=64)
def layer_stiffness(lattice: Lattice, layer: int) -> Array:
    """Stiffness (24, 24) of a cell in a z layer for unit modulus, N/mm per MPa."""
    return hexahedron_stiffness((lattice.dx_mm, lattice.dy_mm, lattice.dz_mm[layer]), lattice.poisson)


@lru_cache(maxsize=16)
def layer_blocks(lattice: Lattice) -> Array:
    """Reflection blocks (8, 3, 3, nz) of every layer; entries that vanish by symmetry are exactly zero."""
    heights = sorted(set(lattice.dz_mm))
    known = {h: reflection_blocks(layer_stiffness(lattice, lattice.dz_mm.index(h))) for h in heights}
    blocks = np.stack([known[h] for h in lattice.dz_mm], axis=-1)
    blocks[np.abs(blocks) < 1e-12 * np.abs(blocks).max()] = 0.0
    return blocks
