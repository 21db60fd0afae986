"""Where a design iteration spends its time: `python -m tests.benchmarks.solver_parts [GRID]`.

Each part is taken alone, some times in a row in one compiled program, on the last design of a cantilever.
Its share of the memory bandwidth counts every array that it reads or writes once. `all else` is what the
iteration takes beside the parts: sums and scalings of vectors, the coarsest grid, Python.
"""

from __future__ import annotations

import statistics
import sys
from collections.abc import Callable, Iterator
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.numerics.grid.conjugate_gradients import System, product_and_work
from cranktopo.numerics.grid.equilibrium import METHODS
from cranktopo.numerics.grid.multigrid import (
    Hierarchy,
    build_hierarchy,
    build_tables,
    level_smoother,
    smoothing_steps,
)
from cranktopo.numerics.grid.operator import add_prolonged, restrict
from cranktopo.numerics.grid.smoothing import SmootherState
from cranktopo.numerics.precision import CompileClock, double_precision
from cranktopo.tasks.density.material import MaterialInterpolation
from cranktopo.tasks.density.model import ThrowModel
from cranktopo.tasks.density.proposals import update
from cranktopo.tasks.density.response import compliance_gradients, compliances
from tests.benchmarks.solver import median_s, stream_GB_s
from tests.studies.cantilever import BETA, MOVE, VOLUME_FRACTION, cantilever, moduli, optimise

GRID = "160x80x80"
ITERATIONS = 5
IN_A_ROW = 8
# The true residual, at the start and at the end, takes a product each.
MEASUREMENTS = 2


class Part(NamedTuple):
    """Seconds of one, how many an iteration has, bytes of the arrays it reads and writes if counted."""

    name: str
    seconds: float
    count: float
    moved: int | None = None

    def row(self, whole_s: float, bandwidth_GB_s: float) -> str:
        """Line of the table."""
        spent = self.seconds * self.count
        told = f"{1e3 * self.seconds:.4g} | {self.count:g} | {1e3 * spent:.0f} | {100 * spent / whole_s:.0f}"
        share = "-" if self.moved is None else f"{100 * self.moved / self.seconds / bandwidth_GB_s / 1e9:.0f}"
        return f"| {self.name} | {told} | {share} |"


def main() -> None:
    """Print the table as Markdown."""
    nx, ny, nz = (int(n) for n in (sys.argv[1] if len(sys.argv) > 1 else GRID).split("x"))
    clock = CompileClock()
    with double_precision():
        model, density_chain = cantilever((nx, ny, nz))
        rows, x = optimise(model, density_chain, ITERATIONS)
        compile_s, whole_s = clock.compile_s, statistics.median(row.seconds for row in rows[1:])
        cycles = statistics.median(row.cg for row in rows[1:])
        parts = [
            *_of_the_solve(model, moduli(density_chain, x), cycles),
            *_of_the_design(model, density_chain, x),
        ]
        bandwidth_GB_s = stream_GB_s()
    rest_s = whole_s - sum(part.seconds * part.count for part in parts)
    print("| part | ms of one | per iteration | ms | % | of bandwidth % |\n|" + "---|" * 6)
    for part in (*parts, Part("all else", rest_s, 1), Part("a design iteration", whole_s, 1)):
        print(part.row(whole_s, bandwidth_GB_s))
    print(f"\ncompiling, once: {compile_s:.1f} s; bandwidth {bandwidth_GB_s:.0f} GB/s")


def _of_the_solve(model: ThrowModel, cells: jax.Array, cycles: float) -> Iterator[Part]:
    tables = build_tables(model.lattice, model.levels)
    set_up_s = median_s(lambda: build_hierarchy(tables, model.supports, cells))
    yield Part("coarse operators, their largest eigenvalues, inverse of the coarsest", set_up_s, 1)
    system = System(jnp.asarray(tables.blocks), model.supports, cells, model.forces)
    hierarchy = build_hierarchy(tables, model.supports, cells)
    field = jnp.asarray(np.random.default_rng(0).standard_normal(model.forces.shape))
    product_s = _in_a_row_s(lambda u: product_and_work(system, u)[0], field)
    moved = 2 * field.nbytes + cells.nbytes
    yield Part("product and its work in float64", product_s, cycles + MEASUREMENTS, moved)
    for level in range(len(hierarchy.steps)):
        yield _smoothing(hierarchy, model, level, cycles)
    fine, coarse = (jnp.zeros((1, *sizes.shape), jnp.float32) for sizes in hierarchy.steps[:2])
    nodes = (coarse.shape[2], coarse.shape[3], coarse.shape[4])
    down = jax.jit(lambda field: restrict(field, nodes))
    restricted_s = median_s(lambda: down(fine))
    yield Part("restriction from the finest grid", restricted_s, cycles, fine.nbytes + coarse.nbytes)
    prolonged_s = _in_a_row_s(lambda field: add_prolonged(coarse, field)[1], fine)
    yield Part("interpolation to the finest grid", prolonged_s, cycles, 3 * fine.nbytes + coarse.nbytes)


def _smoothing(hierarchy: Hierarchy, model: ThrowModel, level: int, cycles: float) -> Part:
    """A step of smoothing on a level."""
    smoother = level_smoother(hierarchy, model.supports, level)
    sizes = hierarchy.steps[level]
    zero = jnp.zeros((1, *sizes.shape), sizes.dtype)

    @jax.jit
    def steps(field: jax.Array) -> SmootherState:
        return smoother.after(SmootherState(field, field, field), IN_A_ROW)

    seconds = median_s(lambda: steps(zero)) / IN_A_ROW
    count = 2 * smoothing_steps(METHODS[0].degree, level, hierarchy.steps[0][0].size)
    moved = sum(array.nbytes for array in smoother.arrays) + sizes.nbytes + 6 * zero.nbytes
    name = f"smoothing step on {'x'.join(str(n) for n in sizes.shape[1:])} nodes"
    return Part(name, seconds, count * cycles, moved)


def _of_the_design(model: ThrowModel, density_chain: MaterialInterpolation, x: jax.Array) -> Iterator[Part]:
    slope = jax.jit(lambda u: (compliances(model, u), compliance_gradients(model, u)))
    yield Part("compliance and its gradient", median_s(lambda: slope(model.forces)), 1)
    limits = jnp.asarray(BETA), -moduli(density_chain, x), jnp.asarray(VOLUME_FRACTION), jnp.asarray(MOVE)
    step = jax.jit(update)
    yield Part(
        "filter, projection and step of the design", median_s(lambda: step(density_chain, x, *limits)), 1
    )


def _in_a_row_s(step: Callable[[jax.Array], jax.Array], start: jax.Array) -> float:
    """Seconds of a step from a field to one like it, of some in a row."""

    @jax.jit
    def steps(field: jax.Array) -> jax.Array:
        for _ in range(IN_A_ROW):
            field = step(field)
        return field

    return median_s(lambda: steps(start)) / IN_A_ROW


if __name__ == "__main__":
    main()
