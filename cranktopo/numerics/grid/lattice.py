"""The structured grid as the solver sees it: cell counts, cell sizes and the element blocks per layer."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.numerics.grid.element import hexahedron_stiffness, parity_blocks

Cells = tuple[int, int, int]

# The dense inverse of the coarsest grid takes about as long as one V-cycle at this size.
_DENSE_UNKNOWNS = 450


@dataclass(frozen=True)
class Lattice:
    """A grid of box cells, uniform in x and y, with one height per layer in z.

    Attributes:
        dz_mm: cell edge along z for each of the nz layers, mm.
        incompatible_modes: of the hexahedra; without, they are too stiff in bending.
    """

    cells: Cells
    dx_mm: float
    dy_mm: float
    dz_mm: tuple[float, ...]
    poisson: float
    incompatible_modes: bool = True

    @property
    def nodes(self) -> tuple[int, int, int]:
        """Number of nodes per axis."""
        nx, ny, nz = self.cells
        return nx + 1, ny + 1, nz + 1

    @property
    def field_shape(self) -> tuple[int, int, int, int]:
        """Shape of a displacement field: component, then nodes."""
        return (3, *self.nodes)

    def coarsenings(self, levels: int) -> tuple[Cells, ...]:
        """Return fine cells per coarse cell along (x, y, z) on every coarse grid of the multigrid hierarchy.

        All axes are halved `levels` times; then those that still can, until a dense solve is cheap.
        """
        factors = [(1 << level, 1 << level, 1 << level) for level in range(1, levels + 1)]
        while self._coarse_unknowns(factors[-1]) > _DENSE_UNKNOWNS:
            halved = tuple(
                2 * f if n % (2 * f) == 0 else f for n, f in zip(self.cells, factors[-1], strict=True)
            )
            if halved == factors[-1]:
                break
            factors.append((halved[0], halved[1], halved[2]))
        return tuple(factors)

    def _coarse_unknowns(self, factors: Cells) -> int:
        return 3 * math.prod(n // f + 1 for n, f in zip(self.cells, factors, strict=True))


@lru_cache(maxsize=64)
def layer_stiffness(lattice: Lattice, layer: int) -> Array:
    """Return the stiffness (24, 24) of a cell in a z layer for unit modulus, N/mm per MPa."""
    size = lattice.dx_mm, lattice.dy_mm, lattice.dz_mm[layer]
    return hexahedron_stiffness(size, lattice.poisson, incompatible_modes=lattice.incompatible_modes)


@lru_cache(maxsize=16)
def layer_blocks(lattice: Lattice) -> Array:
    """Return parity blocks (8, 3, 3, nz) of every layer; entries that vanish by symmetry are exactly zero."""
    heights = sorted(set(lattice.dz_mm))
    known = {h: parity_blocks(layer_stiffness(lattice, lattice.dz_mm.index(h))) for h in heights}
    blocks = np.stack([known[h] for h in lattice.dz_mm], axis=-1)
    blocks[np.abs(blocks) < 1e-12 * np.abs(blocks).max()] = 0.0
    return blocks
