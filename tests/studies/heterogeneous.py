"""Heterogeneous cantilevers after the sweep of arXiv 2604.26441 (Yang, Wang, Wang 2026), with own fields.

The paper has three contrasts, three correlation lengths and three sizes, and a cap of 200 iterations. Here a
beam of 4 : 2 : 1, clamped at one end, is loaded along the lower edge of the other. Densities are a Gaussian
field, smoothed over a correlation length and spread evenly from 0 to 1; SIMP with exponent 3 makes moduli of
them, from 1 / contrast to 1. Across the width it is padded with nothing, so that coarser grids fit.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np
from scipy.ndimage import gaussian_filter

from cranktopo.engine.load_case import LoadCase
from cranktopo.numerics.grid.boundary_conditions import CaseSupports, build_supports
from cranktopo.numerics.grid.conjugate_gradients import System
from cranktopo.numerics.grid.equilibrium import METHODS, compile_multigrid, run_method
from cranktopo.numerics.grid.lattice import Cells, Lattice
from cranktopo.numerics.grid.multigrid import build_tables
from cranktopo.tasks.density.model import ThrowModel
from tests.studies.cantilever import halvings

CONTRASTS = (1e3, 1e6, 1e9)
LENGTHS = (1.5, 3.0, 6.0)
"""Standard deviations of the smoothing, in cells."""
SIZES: dict[Cells, int] = {(20, 40, 80): 24, (30, 60, 120): 32, (40, 80, 160): 48}
"""Cells (width, height, length): 64 k, 216 k and 512 k; and the padded width."""
CAP, TOLERANCE = METHODS[0].cap, 1e-6
SEED = 26441


@dataclass(frozen=True)
class Answer:
    """What the first method, with 200 cycles at most, makes of a field."""

    cycles: int
    residual: float
    seconds: float

    @property
    def converged(self) -> bool:
        """Whether the residual is reached within the cap."""
        return self.residual <= TOLERANCE and self.cycles <= CAP


def beam(cells: Cells, contrast: float, length: float, padded: int) -> tuple[ThrowModel, np.ndarray]:
    """The model and its moduli; the seed follows from size and length, not from the contrast."""
    seed = SEED + 10 * cells[2] + round(2 * length)
    noise = gaussian_filter(np.random.default_rng(seed).standard_normal(cells), length, mode="nearest")
    density = noise.ravel().argsort().argsort().reshape(cells) / (noise.size - 1)
    moduli = np.zeros((padded, *cells[1:]))
    moduli[: cells[0]] = 1 / contrast + (1 - 1 / contrast) * density**3
    lattice = Lattice(moduli.shape, 1.0, 1.0, (1.0,) * cells[2], 0.3)
    coarser = halvings(moduli.shape)
    supports, forces = build_supports(lattice, (0.0, 0.0), coarser, (CaseSupports((), (), ()),))
    forces[0, 1, : cells[0] + 1, 0, -1] = -1.0
    loads = (LoadCase(name="tip", kind="bending", radial_N=1.0),)
    return ThrowModel(lattice, coarser, supports, jnp.asarray(forces), loads, 1.0, 1.0), moduli


def answer(cells: Cells, contrast: float, length: float, padded: int) -> Answer:
    """Solve one case by the first method alone; call inside `double_precision()`."""
    model, moduli = beam(cells, contrast, length, padded)
    tables = build_tables(model.lattice, model.levels)
    system = System(jnp.asarray(tables.blocks), model.supports, jnp.asarray(moduli), model.forces)
    compile_multigrid(tables, system, METHODS[0].precision)
    began = time.perf_counter()
    found = run_method(METHODS[0], tables, system, jnp.zeros_like(model.forces), TOLERANCE)
    residual = float(jnp.max(found.relative_residual))
    return Answer(int(found.iterations), residual, time.perf_counter() - began)
