"""A cantilever on the package's own functions: solver, SIMP, filter, optimality criteria, without a throw.

Clamped at z = 0, loaded down along the lower edge of the free end, volume fraction 0.3, contrast 1e-9.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.engine.load_case import LoadCase
from cranktopo.numerics.filters.density_filter import cone_filter, cone_kernel
from cranktopo.numerics.grid.boundary_conditions import CaseSupports, build_supports
from cranktopo.numerics.grid.lattice import Cells, Lattice
from cranktopo.tasks.density.material import MaterialInterpolation, physical_density, relative_moduli
from cranktopo.tasks.density.model import ThrowModel
from cranktopo.tasks.density.proposals import update
from cranktopo.tasks.density.response import compliance_gradients, compliances, solve

VOLUME_FRACTION = 0.3
FILTER_CELLS = 1.5
MOVE = 0.2
# Nearly no projection: the plain SIMP problem that other codes solve.
BETA = 1e-3
TOLERANCE = 1e-5


@dataclass(frozen=True)
class Iteration:
    """One design iteration.

    Attributes:
        seconds: wall time.
        cg: iterations of the solve.
        compliance: sum over the load cases, for unit modulus, cell edge and nodal force.
    """

    seconds: float
    cg: int
    compliance: float


def cantilever(cells: Cells, load_cases: int = 1) -> tuple[ThrowModel, MaterialInterpolation]:
    """Model and density chain; call inside `double_precision()`.

    Args:
        cells: number of cells (length, width, height): the length becomes the z axis of the package.
        load_cases: 1 for a force along the height, 2 for another one along the width.
    """
    length, width, height = cells
    lattice = Lattice((width, height, length), 1.0, 1.0, (1.0,) * length, 0.3)
    supports, forces = build_supports(
        lattice, (0.0, 0.0), halvings(cells), (CaseSupports((), (), ()),) * load_cases
    )
    for case, component in zip(range(load_cases), (1, 0), strict=False):
        forces[case, component, :, 0, -1] = -1.0  # on every node, as the peers' examples load theirs
    loads = tuple(LoadCase(name=f"tip {case}", kind="bending", radial_N=1.0) for case in range(load_cases))
    model = ThrowModel(lattice, halvings(cells), supports, jnp.asarray(forces), loads, 1.0, 1.0)
    design = jnp.ones(lattice.cells)
    kernel = jnp.asarray(cone_kernel((1.0, 1.0, 1.0), FILTER_CELLS))
    return model, MaterialInterpolation(
        jnp.zeros(lattice.cells), design, (0, length), cone_filter(design, kernel, False)
    )


def optimise(
    model: ThrowModel, density_chain: MaterialInterpolation, iterations: int
) -> tuple[list[Iteration], jax.Array]:
    """So many design iterations from the uniform start, the first one with compilation, and the design."""
    x = jnp.asarray(np.full(density_chain.design_fraction.shape, VOLUME_FRACTION))
    guess, rows = jnp.zeros_like(model.forces), []
    for _ in range(iterations):
        began = time.perf_counter()
        solution = solve(model, moduli(density_chain, x), guess=guess, tolerance=TOLERANCE)
        guess = solution.displacements
        work = float(jnp.sum(compliances(model, guess)))
        slope = jnp.sum(compliance_gradients(model, guess), axis=0)
        x = _update(
            density_chain, x, jnp.asarray(BETA), slope, jnp.asarray(VOLUME_FRACTION), jnp.asarray(MOVE)
        )
        jax.block_until_ready(x)
        rows.append(Iteration(time.perf_counter() - began, solution.iterations, work))
    return rows, x


def halvings(cells: Cells) -> int:
    """Halvings that all axes allow."""
    return min((n & -n).bit_length() - 1 for n in cells)


@jax.jit
def physical(density_chain: MaterialInterpolation, x: jax.Array) -> jax.Array:
    """Filtered density of the design variables."""
    return physical_density(density_chain, x, BETA)


@jax.jit
def moduli(density_chain: MaterialInterpolation, x: jax.Array) -> jax.Array:
    """Relative moduli of the design variables."""
    return relative_moduli(density_chain, physical(density_chain, x))


_update = jax.jit(update)
