"""Solves on one device and on several, in a process whose JAX is told to make devices of its cores.

The web is lopsided: random moduli, unequal layers, and two cases with other mirrors, sections and springs.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from typing import Any
from unittest.mock import patch

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.numerics.grid.boundary_conditions import CaseSupports, SectionMotion, build_supports
from cranktopo.numerics.grid.conjugate_gradients import (
    CgResult,
    SharedSolve,
    System,
    partition_of,
    stiffness_product,
)
from cranktopo.numerics.grid.equilibrium import METHODS, run_method
from cranktopo.numerics.grid.lattice import Cells, Lattice
from cranktopo.numerics.grid.multigrid import GridTables, build_tables, project
from cranktopo.numerics.grid.partition import WHOLE
from cranktopo.numerics.precision import double_precision
from tests.studies.cantilever import halvings

TOLERANCE = 1e-8
DEVICES = 16
_MIRRORED = CaseSupports((1, 2), (0, 1), (SectionMotion(0, "rz", load=900.0), SectionMotion(0, "tx", 30.0)))
_TWO_SECTIONS = CaseSupports(
    (),
    (),
    (
        SectionMotion(0, "ty", 20.0),
        SectionMotion(0, "rx"),
        SectionMotion(-1, "rz", load=700.0),
        SectionMotion(-1, "tz"),
        SectionMotion(-1, "tx", 5.0, load=3.0),
    ),
)
Row = dict[str, Any]


def in_own_process(grid: str, parts: tuple[int, ...]) -> list[Row]:
    """Rows of a grid in a process with so many devices."""
    flags = f"--xla_force_host_platform_device_count={DEVICES}"
    here = os.environ | {"XLA_FLAGS": flags, "JAX_PLATFORMS": "cpu"}
    command = [sys.executable, "-m", "tests.studies.parts", grid, *map(str, parts)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=here)
    if done.returncode:
        raise RuntimeError(done.stderr)
    return [json.loads(line) for line in done.stdout.splitlines()]


def lopsided(cells: Cells) -> tuple[GridTables, System]:
    """A system whose parts are all different; call inside `double_precision()`."""
    numbers = np.random.default_rng(5)
    heights = tuple(float(h) for h in 1.0 + 0.3 * np.sin(np.arange(cells[2])))
    lattice = Lattice(cells, 1.0, 1.2, heights, 0.3)
    levels = halvings(cells)
    supports, forces = build_supports(lattice, (-2.0, -5.0), levels, (_MIRRORED, _TWO_SECTIONS))
    forces[:, :, 1:, :, 1:-1] += 0.1 * numbers.standard_normal(forces[:, :, 1:, :, 1:-1].shape)
    coarse = numbers.choice([1e-6, 0.2, 1.0], size=tuple(n // 2 for n in cells), p=[0.3, 0.2, 0.5])
    moduli = coarse.repeat(2, 0).repeat(2, 1).repeat(2, 2)
    tables = build_tables(lattice, levels)
    return tables, System(jnp.asarray(tables.blocks), supports, jnp.asarray(moduli), jnp.asarray(forces))


def solved(tables: GridTables, system: System, parts: int) -> CgResult:
    """On so many devices; on one as every command does."""
    if parts == 1:
        return run_method(METHODS[0], tables, system, jnp.zeros_like(system.forces), TOLERANCE)
    return _shared(tables, system, parts).result()


def device_bytes(tables: GridTables, system: System, parts: int) -> int:
    """Memory of the solve on each device, as the compiler sets it aside: of JAX code, as on GPUs."""
    shared = _shared(tables, system, parts)
    jax.clear_caches()  # a processor's kernels may be in what was traced before
    with patch("cranktopo.numerics.kernels.registry.kernels_usable", return_value=False):
        memory = shared.program().lower(*shared.arguments()).compile().memory_analysis()
    jax.clear_caches()
    taken = memory.argument_size_in_bytes + memory.output_size_in_bytes + memory.temp_size_in_bytes
    return int(taken - memory.alias_size_in_bytes)


def _shared(tables: GridTables, system: System, parts: int) -> SharedSolve:
    """The first method's solve from zero."""
    method, guess = METHODS[0], jnp.zeros_like(system.forces)
    limits = jnp.asarray(TOLERANCE), jnp.asarray(method.cap)
    return SharedSolve(tables, system, method.degree, guess, limits, method.precision, parts)


def true_residual(system: System, u: jax.Array) -> float:
    """Largest relative residual of the cases, by the product of the whole grid."""
    free = project(system.supports, system.forces)
    miss = free - stiffness_product(system, u)
    return float(jnp.sqrt(jnp.max(WHOLE.dot(miss, miss) / WHOLE.dot(free, free))))


def main(grid: str, parts: tuple[int, ...]) -> None:
    """Print a row for each number of parts."""
    nx, ny, nz = (int(n) for n in grid.split("x"))
    with double_precision():
        tables, system = lopsided((nx, ny, nz))
        whole = solved(tables, system, 1)
        for count in parts:
            found = solved(tables, system, count)
            difference = jnp.max(jnp.abs(found.displacements - whole.displacements))
            row = {
                "parts": count,
                "levels": partition_of(tables, count).levels,
                "iterations": int(found.iterations),
                "iterations_on_one": int(whole.iterations),
                "residual": true_residual(system, found.displacements),
                "difference": float(difference / jnp.max(jnp.abs(whole.displacements))),
                "device_bytes": device_bytes(tables, system, count),
            }
            print(json.dumps(row), flush=True)


if __name__ == "__main__":
    main(sys.argv[1], tuple(int(n) for n in sys.argv[2:]))
