"""What the solver costs on a cantilever: `python -m tests.benchmarks.solver [--json FILE] [--fine-grids]`.

Every grid runs in its own process without stored compilations, so that memory and compiling are its own.
Per grid: medians over the design iterations after the first, the product with the stiffness against the
memory bandwidth of this machine, the cycle in float32 against float64, and two load cases against one.
`--fine-grids` adds grids up to 2 million cells; the exponent of the cost is fitted. Where JAX finds a GPU
every grid has a row on it as well.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import resource
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.numerics.grid.conjugate_gradients import System, multigrid_cg
from cranktopo.numerics.grid.equilibrium import METHODS
from cranktopo.numerics.grid.lattice import layer_blocks
from cranktopo.numerics.grid.multigrid import build_hierarchy, build_tables
from cranktopo.numerics.grid.operator import apply_stiffness
from cranktopo.numerics.precision import CompileClock, Precision, double_precision
from cranktopo.tasks.density.model import ThrowModel
from tests.studies.cantilever import TOLERANCE, cantilever, moduli, optimise

GRIDS = ("48x24x24", "96x48x48", "160x80x80")
FINE_GRIDS = ("48x24x24", "64x32x32", "96x48x48", "128x64x64", "160x80x80", "192x96x112")
ITERATIONS = 12
REPEATS = 7
PRODUCTS = 10
# Compiling takes time and memory too: every row has it.
COMPILED_ANEW = {"JAX_ENABLE_COMPILATION_CACHE": "false"}
Row = dict[str, Any]


def main() -> None:
    """Run the grids, print the tables, write the JSON."""
    options = _options()
    if options.one:
        print(json.dumps(measure(options.one, options.iterations)))
        return
    grids = options.grids or (FINE_GRIDS if options.fine_grids else GRIDS)
    rows = []
    _print_header()
    for device, grid in product(devices(), grids):
        rows.append({"device": device, **_in_own_process(grid, options.iterations, device)})
        _print_row(rows[-1])
    report: Row = {
        "machine": platform.processor() or platform.machine(),
        "jax": jax.__version__,
        "rows": rows,
    }
    on_cpu = [row for row in rows if row["device"] == "cpu"]
    if len(on_cpu) > 2:
        report["exponent"] = exponent(on_cpu)
        print(f"\nseconds per design iteration grow with cells to the power {report['exponent']:.2f}")
    if options.json:
        Path(options.json).write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")


def exponent(rows: list[Row]) -> float:
    """Slope of the logarithm of seconds per design iteration over that of cells, least squares."""
    cells, seconds = (np.log([row[key] for row in rows]) for key in ("cells", "iteration_s"))
    return float(np.polyfit(cells, seconds, 1)[0])


def measure(grid: str, iterations: int) -> Row:
    """All figures of one grid, in this process."""
    clock = CompileClock()
    with double_precision():
        one, design, model = optimisation(grid, 1, iterations)
        compile_s, memory = clock.compile_s, peak_MiB()
        row = {"grid": grid, "cells": design.size, "unknowns": model.forces[0].size, **one}
        row |= {"compile_s": compile_s, "peak_MiB": memory, "stream_GB_s": stream_GB_s()}
        row |= {f"{p}_product_ns": product_ns(model, design, p) for p in ("float32", "float64")}
        row["float32_of_bandwidth"] = ideal_ns(model, 4, row["stream_GB_s"]) / row["float32_product_ns"]
        row["float64_of_bandwidth"] = ideal_ns(model, 8, row["stream_GB_s"]) / row["float64_product_ns"]
        row |= {f"{p}_solve_s": solve_s(model, design, p) for p in ("float32", "float64")}
        two, _, _ = optimisation(grid, 2, iterations)
        row["two_cases_ratio"] = two["iteration_s"] / one["iteration_s"]
    return row


def product_ns(model: ThrowModel, design: jax.Array, precision: Precision) -> float:
    """Nanoseconds per unknown of one product with the stiffness, in a row of them as a solve has.

    A product alone spends more time on memory that the system hands out afresh than on numbers.
    """
    field = jnp.asarray(np.random.default_rng(0).standard_normal(model.forces[:1].shape), precision)
    blocks, cells = jnp.asarray(layer_blocks(model.lattice), precision), design.astype(precision)
    return 1e9 * median_s(lambda: _products(blocks, cells, field)) / field.size / PRODUCTS


def solve_s(model: ThrowModel, design: jax.Array, precision: Precision) -> float:
    """Seconds of a solve from zero, hierarchy included, with the cycle in a precision."""
    tables = build_tables(model.lattice, model.levels)
    system = System(jnp.asarray(tables.blocks), model.supports, design, model.forces)
    limits = jnp.asarray(TOLERANCE), jnp.asarray(200)

    def solve() -> jax.Array:
        hierarchy = build_hierarchy(tables, model.supports, design, precision=precision)
        result = multigrid_cg(
            system, hierarchy, jnp.asarray(METHODS[0].degree), jnp.zeros_like(model.forces), *limits
        )
        if not float(jnp.max(result.relative_residual)) <= TOLERANCE:
            raise RuntimeError(f"{precision}: residual {result.relative_residual}")
        return result.displacements

    return median_s(solve, repeats=3)


def stream_GB_s() -> float:
    """Memory bandwidth of this machine under JAX: an array far larger than most caches, read and written.

    In place: a new array is memory that the system hands out afresh, and mostly waits for it.
    """
    kept = [jnp.zeros(1 << 25)]
    add_one = jax.jit(lambda a: a + 1.0, donate_argnums=0)

    def task() -> jax.Array:
        kept.append(add_one(kept.pop()))
        return kept[0]

    return 2 * kept[0].nbytes / median_s(task) / 1e9


def optimisation(grid: str, load_cases: int, iterations: int) -> tuple[Row, jax.Array, ThrowModel]:
    """Medians of an optimisation of the cantilever, its last moduli, and its model."""
    nx, ny, nz = (int(n) for n in grid.split("x"))
    model, density_chain = cantilever((nx, ny, nz), load_cases)
    rows, x = optimise(model, density_chain, iterations)
    later = rows[1:]
    figures = {
        "iteration_s": statistics.median(r.seconds for r in later),
        "first_s": rows[0].seconds,
        "cg": statistics.median(r.cg for r in later),
        "compliance": rows[-1].compliance,
    }
    return figures, moduli(density_chain, x), model


def ideal_ns(model: ThrowModel, item_bytes: int, bandwidth_GB_s: float) -> float:
    """Nanoseconds per unknown if displacements, forces and moduli crossed the memory bus once."""
    unknowns, cells = model.forces[0].size, int(np.prod(model.lattice.cells))
    return item_bytes * (2 + cells / unknowns) / bandwidth_GB_s


def median_s(task: Callable[[], jax.Array], repeats: int = REPEATS) -> float:
    """Median wall time of a task that was run once before."""
    seconds = []
    for _ in range(repeats + 1):
        began = time.perf_counter()
        jax.block_until_ready(task())
        seconds.append(time.perf_counter() - began)
    return statistics.median(seconds[1:])


@jax.jit
def _products(blocks: jax.Array, cells: jax.Array, field: jax.Array) -> jax.Array:
    """A row of products, each image scaled so that numbers stay in range."""

    def step(_: int, u: jax.Array) -> jax.Array:
        image = apply_stiffness(blocks, cells, u)
        return image / jnp.max(jnp.abs(image))

    return jax.lax.fori_loop(0, PRODUCTS, step, field)


def devices() -> list[str]:
    """JAX platforms of this machine to measure."""
    names = {device.platform for device in jax.devices()}
    return ["cpu", *sorted({"gpu": "cuda"}.get(name, name) for name in names - {"cpu"})]


def peak_MiB() -> float:
    """Most memory of the process, or of the accelerator it computes on."""
    used = jax.devices()[0].memory_stats()
    if used:
        return used["peak_bytes_in_use"] / 2**20
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def _in_own_process(grid: str, iterations: int, device: str) -> Row:
    command = [
        sys.executable,
        "-m",
        "tests.benchmarks.solver",
        "--one",
        grid,
        "--iterations",
        str(iterations),
    ]
    here = os.environ | COMPILED_ANEW | {"JAX_PLATFORMS": device}
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=here)
    if done.returncode:
        raise SystemExit(f"{grid}: {done.stderr}")
    row: Row = json.loads(done.stdout.splitlines()[-1])
    return row


def _print_header() -> None:
    print(
        "| device | grid | cells | s per iteration | first s | compile s | CG | peak MiB "
        "| float32 ns per unknown (of bandwidth) | float64 | GB/s | solve float32 s | float64 s "
        "| two cases to one |"
    )
    print("|" + "---|" * 14, flush=True)


def _print_row(row: Row) -> None:
    cells = [
        f"{row['device']} | {row['grid']} | {row['cells']:,}",
        f"{row['iteration_s']:.3g} | {row['first_s']:.3g}",
        f"{row['compile_s']:.3g} | {row['cg']:g} | {row['peak_MiB']:.0f}",
        f"{row['float32_product_ns']:.3g} ({row['float32_of_bandwidth']:.0%})",
        f"{row['float64_product_ns']:.3g} ({row['float64_of_bandwidth']:.0%})",
        f"{row['stream_GB_s']:.3g} | {row['float32_solve_s']:.3g} | {row['float64_solve_s']:.3g}",
        f"{row['two_cases_ratio']:.2f}",
    ]
    print(f"| {' | '.join(cells)} |", flush=True)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("grids", nargs="*", help="e.g. 48x24x24")
    parser.add_argument("--json", metavar="FILE")
    parser.add_argument("--fine-grids", action="store_true", help="grids from 28 thousand to 2 million cells")
    parser.add_argument("--iterations", type=int, default=ITERATIONS)
    parser.add_argument("--one", metavar="GRID", help=argparse.SUPPRESS)
    return parser.parse_args()


if __name__ == "__main__":
    main()
