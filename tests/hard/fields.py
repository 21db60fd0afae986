"""The hard cases: fields of moduli, loads and small grids that defeat careless solvers.

One list serves the tests and the table of `tests.benchmarks.hard_cases`. Nearly all cases share one number
of cells, so that everything is compiled once.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from cranktopo.domain.grid import plan_grid
from cranktopo.fem.lattice import Lattice
from cranktopo.fem.model import ThrowModel
from cranktopo.fem.supports import CaseSupports, SectionMotion, build_supports
from cranktopo.loads.cases import LoadCase

Array = NDArray[np.float64]
Answer = Literal["number", "no material", "no support", "void", "moduli"]

CELLS = (8, 12, 16)
CUBES = Lattice(CELLS, 1.0, 1.0, (1.0,) * CELLS[2], 0.3)
CLAMPED = CaseSupports((), (), ())
# A sprung section that may turn and shift at the start, a mirror at x = 0, another at the end.
THROW_LIKE = CaseSupports(
    (0,),
    (2,),
    (SectionMotion(0, "tz"), SectionMotion(0, "rx"), SectionMotion(0, "ty", stiffness=0.5)),
)


@dataclass(frozen=True)
class HardCase:
    """A field, its load and what the solver owes for it.

    Attributes:
        name: for the test id and the table.
        moduli: relative modulus per cell.
        forces: nodal forces over the modulus (3, nodes...).
        lattice: the grid.
        supports: of the one load case.
        answer: a number, or what the error must complain about.
        levels: halvings that all axes allow.
    """

    name: str
    moduli: Array
    forces: Array
    lattice: Lattice = CUBES
    supports: CaseSupports = CLAMPED
    answer: Answer = "number"
    levels: int = 1

    @property
    def contrast(self) -> float:
        """Least positive modulus over the largest."""
        return float(self.moduli[self.moduli > 0].min() / self.moduli.max())

    def model(self) -> ThrowModel:
        """The case as the package's solver takes it; call inside `double_precision()`."""
        supports, _ = build_supports(self.lattice, (0.0, 0.0), self.levels, (self.supports,))
        load = LoadCase("tip", "bending", radial_N=1.0)
        return ThrowModel(
            self.lattice, self.levels, supports, jnp.asarray(self.forces[None]), (load,), 1.0, 1.0
        )


def tip_load(lattice: Lattice = CUBES) -> Array:
    """Along the lower edge of the last plane: down, and a little along x, so that nothing is symmetric."""
    forces = np.zeros(lattice.field_shape)
    share = np.full(lattice.nodes[0], 1.0 / lattice.cells[0])
    share[[0, -1]] /= 2
    forces[1, :, 0, -1], forces[0, :, 0, -1] = -share, 0.3 * share
    return forces


def with_plate(moduli: Array) -> Array:
    """The field with a solid last layer to carry the load."""
    return np.concatenate([moduli[..., :-1], np.ones_like(moduli[..., -1:])], axis=-1)


def blobs(volume: float, cells: tuple[int, int, int] = CELLS, seed: int = 3) -> NDArray[np.bool_]:
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
    solid[:, :, 5:9] = False
    solid[link[0], link[1], 5:9] = True
    return solid


def touching(by: Literal["edge", "corner"]) -> NDArray[np.bool_]:
    """Two bars that share one edge or one corner of a cell: a hinge or a ball joint."""
    solid = np.zeros(CELLS, bool)
    solid[2:5, 3:7, :8] = True
    solid[5:8, 7:11, 8:] = by == "corner"
    if by == "edge":
        solid[2:5, 7:11, 8:] = True
    return solid


def island() -> NDArray[np.bool_]:
    """A solid beam, and beside it a block that touches nothing."""
    solid = np.zeros(CELLS, bool)
    solid[:4] = True
    solid[6:8, 4:8, 6:10] = True
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


@dataclass(frozen=True)
class _Padded:
    lattice: Lattice
    levels: int
    solid: NDArray[np.bool_] = field(repr=False)


def padded(counts: tuple[int, int, int]) -> _Padded:
    """A grid of so many unit cells as the domain plans it: padded by void along x and y, resliced along z."""
    nx, ny, nz = counts
    grid = plan_grid((-nx, nx), (0.0, ny), (0.0, float(nz)), 1.0, "quarter")
    dx, dy, dz = grid.steps_mm
    solid = np.zeros(grid.cells, bool)
    solid[:nx, :ny] = True
    lattice = Lattice(grid.cells, float(dx[0]), float(dy[0]), tuple(float(d) for d in dz), 0.3)
    return _Padded(lattice, grid.levels, solid)
