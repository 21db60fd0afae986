"""The structured grid as the solver sees it: cells, and the stiffness of its hexahedra.

Corners are numbered a = 4 i + 2 j + k with i, j, k in {0, 1} along x, y, z; degree of freedom 3 a + c.
Without JAX: a process that writes machine code has no need of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import product

import numpy as np

from cranktopo.base.arrays import Array

CORNERS = np.array(list(product((0, 1), repeat=3)))
_GAUSS = (-1 / np.sqrt(3), 1 / np.sqrt(3))


def elasticity(poisson: float) -> Array:
    """Return the isotropic elasticity matrix (6, 6) for unit Young's modulus, order xx yy zz yz zx xy."""
    scale = 1 / ((1 + poisson) * (1 - 2 * poisson))
    matrix = np.zeros((6, 6))
    matrix[:3, :3] = poisson * scale
    matrix[range(3), range(3)] = (1 - poisson) * scale
    matrix[range(3, 6), range(3, 6)] = 0.5 / (1 + poisson)
    return matrix


def hexahedron_stiffness(
    size_mm: tuple[float, float, float], poisson: float, *, incompatible_modes: bool = True
) -> Array:
    """Return the stiffness (24, 24) of a box-shaped 8-node hexahedron for E = 1 MPa, N/mm.

    The three quadratic bubble modes per direction remove parasitic shear in bending and are condensed out; on
    a box they pass the patch test without correction.
    Source: E. L. Wilson et al., Incompatible displacement models, 1973; R. L. Taylor, P. J. Beresford, E. L.
    Wilson, A non-conforming element for stress analysis, IJNME 10, 1976.
    """
    d = elasticity(poisson)
    blocks = np.zeros((33, 33))
    volume = float(np.prod(size_mm)) / 8
    for point in product(_GAUSS, repeat=3):
        bubbles = np.diag([-2 * point[a] * 2 / size_mm[a] for a in range(3)])
        b = np.hstack([_strain(_corner_gradients(point, size_mm)), _strain(bubbles)])
        blocks += volume * b.T @ d @ b
    corner, mixed, bubble = blocks[:24, :24], blocks[:24, 24:], blocks[24:, 24:]
    stiffness = corner - mixed @ np.linalg.solve(bubble, mixed.T) if incompatible_modes else corner
    return np.asarray((stiffness + stiffness.T) / 2)


def parity_blocks(stiffness: Array) -> Array:
    """Return the blocks B (8, 3, 3) of a hexahedron's stiffness K = H^T B H in corner sums and differences.

    A box of isotropic material commutes with its three reflections, so the unnormalised Walsh-Hadamard
    transform H over its corners leaves one 3 x 3 block per parity class 4 px + 2 py + pz. Sum w = (wx, wy,
    wz) in {0, 1}^3 is a difference (1) or sum (0) per axis; component c of class p belongs to sum p xor e_c.
    """
    signs = np.prod(np.where(CORNERS[None, :, :] == 1, 2 * CORNERS[:, None, :] - 1, 1), axis=2).astype(float)
    sums = np.einsum("aw,acbd,bv->wcvd", signs, stiffness.reshape(8, 3, 8, 3), signs) / 64
    return np.array(
        [
            [[sums[parity_sum_of(p, c), c, parity_sum_of(p, d), d] for d in range(3)] for c in range(3)]
            for p in range(8)
        ]
    )


def parity_sum_of(parity_class: int, component: int) -> int:
    """Return the index (4 wx + 2 wy + wz) of the sum that a component of a parity class lives on."""
    return parity_class ^ (4 >> component)


def _corner_gradients(point: tuple[float, ...], size: tuple[float, float, float]) -> Array:
    sign = 2 * CORNERS - 1
    factors = 1 + sign * np.array(point)
    gradients = np.empty((8, 3))
    for axis in range(3):
        others = [a for a in range(3) if a != axis]
        gradients[:, axis] = (
            sign[:, axis] * factors[:, others[0]] * factors[:, others[1]] / 8 * 2 / size[axis]
        )
    return gradients


def _strain(gradients: Array) -> Array:
    """Return the strain-displacement matrix (6, 3 n) of shape-function gradients (n, 3)."""
    b = np.zeros((6, len(gradients), 3))
    dx, dy, dz = gradients.T
    b[0, :, 0], b[1, :, 1], b[2, :, 2] = dx, dy, dz
    b[3, :, 1], b[3, :, 2] = dz, dy
    b[4, :, 0], b[4, :, 2] = dz, dx
    b[5, :, 0], b[5, :, 1] = dy, dx
    return b.reshape(6, -1)


# Entries of the parity blocks that do not vanish by symmetry, the same for every box and material.
COUPLED = np.abs(parity_blocks(hexahedron_stiffness((1.0, 1.1, 0.9), 0.3))) > 1e-12


Cells = tuple[int, int, int]

# The dense inverse of the coarsest grid takes about as long as one V-cycle at this size.
_DENSE_UNKNOWNS = 450


@dataclass(frozen=True)
class Lattice:
    """A grid of box cells, uniform in x and y, with one height per layer in z."""

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
        while (
            3 * math.prod(n // f + 1 for n, f in zip(self.cells, factors[-1], strict=True)) > _DENSE_UNKNOWNS
        ):
            halved = tuple(
                2 * f if n % (2 * f) == 0 else f for n, f in zip(self.cells, factors[-1], strict=True)
            )
            if halved == factors[-1]:
                break
            factors.append((halved[0], halved[1], halved[2]))
        return tuple(factors)


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
