"""Fields of moduli, loads, supports and small grids that defeat careless solvers.

They share one number of cells, so that everything is compiled once.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter, label

from cranktopo.bodies.cells.grid import plan_grid
from cranktopo.numerics.grid.boundary_conditions import CaseSupports, SectionMotion
from cranktopo.numerics.grid.lattice import Lattice

Array = NDArray[np.float64]

CELLS = (8, 12, 12)
CUBES = Lattice(CELLS, 1.0, 1.0, (1.0,) * CELLS[2], 0.3)
CLAMPED = CaseSupports((), (), ())
# A sprung section that may turn and shift at the start, a mirror at x = 0, another at the end.
THROW_LIKE = CaseSupports(
    (0,),
    (2,),
    (SectionMotion(0, "tz"), SectionMotion(0, "rx"), SectionMotion(0, "ty", stiffness=0.5)),
)


def tip_load(lattice: Lattice = CUBES, cells: int = CELLS[0]) -> Array:
    """Along the lower edge of the last plane: down, and a little along x, so that nothing is symmetric.

    Args:
        lattice: the grid.
        cells: that many cells from x = 0 are loaded.
    """
    forces = np.zeros(lattice.field_shape)
    share = np.full(cells + 1, 1.0 / cells)
    share[[0, -1]] /= 2
    forces[1, : cells + 1, 0, -1], forces[0, : cells + 1, 0, -1] = -share, 0.3 * share
    return forces


def with_plate(moduli: Array) -> Array:
    """The field with a solid last layer to carry the load."""
    return np.concatenate([moduli[..., :-1], np.ones_like(moduli[..., -1:])], axis=-1)


def blobs(volume: float, cells: tuple[int, int, int] = CELLS, seed: int = 4) -> NDArray[np.bool_]:
    """Smooth random shapes, stretched along z, that fill the volume fraction."""
    noise = np.random.default_rng(seed).standard_normal(cells)
    smooth = gaussian_filter(noise, (1.2, 1.2, 3.0), mode="nearest")
    return np.asarray(smooth >= np.quantile(smooth, 1 - volume))


def random_cells(volume: float, seed: int = 5) -> NDArray[np.bool_]:
    """Cells filled independently at random."""
    return np.random.default_rng(seed).random(CELLS) < volume


def two_phase(solid: NDArray[np.bool_], void: float) -> Array:
    """Moduli 1 and `void`, with the loaded plate."""
    return with_plate(np.where(solid, 1.0, void))


def checkerboard() -> NDArray[np.bool_]:
    return np.asarray(np.indices(CELLS).sum(axis=0) % 2 == 0)


def walls() -> NDArray[np.bool_]:
    """Walls one cell thick, three cells apart, crossing each other."""
    i, j, _ = np.indices(CELLS)
    return np.asarray((i % 4 == 1) | (j % 5 == 2))


def blocks_joined(link: tuple[slice, slice]) -> NDArray[np.bool_]:
    """Two solid blocks, and between them only the cells of the link."""
    solid = np.ones(CELLS, bool)
    solid[:, :, 4:8] = False
    solid[link[0], link[1], 4:8] = True
    return solid


def touching(by: Literal["edge", "corner"]) -> NDArray[np.bool_]:
    """Two bars that share one edge or one corner of a cell: a hinge or a ball joint."""
    solid = np.zeros(CELLS, bool)
    solid[2:5, 3:7, :6] = True
    solid[5:8, 7:11, 6:] = by == "corner"
    if by == "edge":
        solid[2:5, 7:11, 6:] = True
    return solid


def island() -> NDArray[np.bool_]:
    """A solid beam, and beside it a block that touches nothing."""
    solid = np.zeros(CELLS, bool)
    solid[:4] = True
    solid[6:8, 4:8, 4:8] = True
    return solid


def gap() -> NDArray[np.bool_]:
    """Two solid blocks with nothing between them."""
    return blocks_joined((slice(0), slice(0)))


def simp(density: float) -> Array:
    """Uniform density under SIMP with exponent 3."""
    return with_plate(np.full(CELLS, density**3))


def stretched(factors: tuple[float, float, float], poisson: float = 0.3) -> Lattice:
    """The grid with other cell edges, mm."""
    return Lattice(CELLS, factors[0], factors[1], (factors[2],) * CELLS[2], poisson)


def padded(counts: tuple[int, int, int]) -> tuple[Lattice, int, NDArray[np.bool_]]:
    """Unit cells as the domain plans them: padded by void along x and y, resliced along z.

    Returns:
        The lattice, the halvings that its axes allow, and which cells belong to the body.
    """
    nx, ny, nz = counts
    grid = plan_grid((-nx, nx), (0.0, ny), (0.0, float(nz)), 1.0, "quarter")
    dx, dy, dz = grid.steps_mm
    lattice = Lattice(grid.cells, float(dx[0]), float(dy[0]), tuple(float(d) for d in dz), 0.3)
    body = np.zeros(grid.cells, bool)
    body[:nx, :ny] = True
    return lattice, grid.levels, body


def off_material(void: float) -> Array:
    """The loaded end and the layers before it are void."""
    moduli = np.where(blobs(0.4), 1.0, void)
    moduli[..., -3:] = void
    return moduli


def half_off_material(void: float) -> Array:
    """Half of the loaded edge lies on void."""
    moduli = two_phase(blobs(0.4), void)
    moduli[:4, :2, -1] = void
    moduli[:4, 0, -2] = void
    return moduli


def loose_parts(moduli: Array) -> bool:
    """Whether a body of material floats in void."""
    _, bodies = label(moduli > 1e-4 * moduli.max(), structure=np.ones((3, 3, 3)))
    return bool(bodies > 1)
