"""One cantilever in cranktopo, pyMOTO and PyTopo3D: `python -m tests.benchmarks.peers [GRID...]`.

The peers run in an environment of their own (`--environment`, made on the first run from
`requirements.txt` beside this file), every code in its own process, one after the other: same grid, load,
volume fraction 0.3, filter of 1.5 cells, move 0.2, optimality criteria, number of iterations. Seconds are the
medians of the design iterations after the first. The last design of every code is assessed by one solver.
Grids of `--own-grids` are cranktopo's alone. `--plot FILE` draws seconds and peak memory over the cells, with
the least seconds that cranktopo's products with the stiffness would take at the bandwidth of the memory.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from cranktopo.numerics.grid.equilibrium import METHODS
from cranktopo.numerics.grid.multigrid import smoothing_steps
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.density.model import ThrowModel
from cranktopo.tasks.density.response import compliances, solve
from tests.benchmarks.peers.picture import save_picture
from tests.benchmarks.solver import COMPILED_ANEW, ideal_ns, stream_GB_s
from tests.studies.cantilever import TOLERANCE, cantilever, optimise, physical

GRIDS = ("48x24x24", "96x48x48")
HERE = Path(__file__).parent
PEERS = {"pyMOTO": "with_pymoto.py", "PyTopo3D": "with_pytopo3d.py"}
STIFF, SOFT = 1.0, 1e-9
Cells = tuple[int, int, int]
Row = dict[str, Any]


def main() -> None:
    """Run every code on every grid and print the table."""
    options = _options()
    if options.own:
        print(json.dumps(own_run(_cells(options.grids[0]), options.iterations, options.own)))
        return
    python = _environment(Path(options.environment))
    print("| cells | code | s per iteration | to cranktopo | peak MiB | volume fraction | compliance |")
    print("|" + "---|" * 7, flush=True)
    rows: list[Row] = []
    shared = options.grids or GRIDS
    for grid in (*shared, *options.own_grids):
        own = [sys.executable, "-m", "tests.benchmarks.peers", grid, "--iterations", str(options.iterations)]
        cells = [str(n) for n in _cells(grid)]
        commands = {"cranktopo": [*own, "--own"]}
        for code, script in PEERS.items() if grid in shared else ():
            commands[code] = [str(python), str(HERE / script), *cells, str(options.iterations)]
        for code, command in commands.items():
            size = {"grid": grid, "cells": math.prod(_cells(grid)), "code": code}
            rows.append(size | _run(command, _cells(grid), options.limit_s))
            _print_row(rows[-1], next(r for r in rows if r["grid"] == grid))
    if options.json:
        Path(options.json).write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")
    if options.plot:
        save_picture(rows, Path(options.plot))


def own_run(cells: Cells, iterations: int, density_file: str) -> Row:
    """Our design iterations; the last physical density [length, width, height] goes to a file."""
    with double_precision():
        model, density_chain = cantilever(cells)
        rows, x = optimise(model, density_chain, iterations)
        density = np.asarray(physical(density_chain, x))
    np.save(density_file, density.transpose(2, 0, 1))
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    steps = statistics.median(row.cg for row in rows[1:])
    limit_s = steps * _least_step_s(model, METHODS[0].degree)
    return {"seconds": [r.seconds for r in rows], "peak_MiB": peak, "limit_s": limit_s}


def _least_step_s(model: ThrowModel, degree: int) -> float:
    """Least seconds of a step's products with the stiffness of the finest grid, at the memory's bandwidth."""
    products = 1 + 2 * smoothing_steps(degree, 0, math.prod(model.forces.shape[2:]))
    return products * 1e-9 * ideal_ns(model, 4, stream_GB_s()) * model.forces.size


def compliance(density: NDArray[np.float64], cells: Cells) -> float:
    """Compliance of a density [length, width, height], SIMP with power 3, for unit nodal forces."""
    with double_precision():
        model, _ = cantilever(cells)
        moduli = jnp.asarray(SOFT + (STIFF - SOFT) * density.transpose(1, 2, 0) ** 3)
        return float(compliances(model, solve(model, moduli, tolerance=TOLERANCE).displacements)[0])


def _run(command: list[str], cells: Cells, limit_s: float) -> Row:
    """Seconds, memory and assessed design of one code, or why there are none."""
    here = os.environ | COMPILED_ANEW
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "density.npy"
        try:
            done = subprocess.run(
                [*command, str(file)], capture_output=True, text=True, timeout=limit_s, check=False, env=here
            )
        except subprocess.TimeoutExpired:
            return {"failure": f"not within {limit_s:g} s"}
        if done.returncode:
            last = (done.stderr.strip().splitlines() or ["no message"])[-1]
            return {"failure": f"exit {done.returncode}: {last[:80]}"}
        found: Row = json.loads(done.stdout.splitlines()[-1])
        density = np.load(file)
    seconds = found.pop("seconds")
    return {
        "iteration_s": statistics.median(seconds[1:]),
        **found,
        "volume_fraction": float(density.mean()),
        "compliance": compliance(density, cells),
    }


def _print_row(row: Row, own: Row) -> None:
    if "failure" in row:
        print(f"| {row['grid']} | {row['code']} | {row['failure']} | - | - | - | - |", flush=True)
        return
    ratio = row["iteration_s"] / own["iteration_s"]
    change = 100 * (row["compliance"] / own["compliance"] - 1)
    cost = f"{row['iteration_s']:.3g} | {ratio:.1f} | {row['peak_MiB']:.0f}"
    result = f"{row['volume_fraction']:.4f} | {row['compliance']:.1f} ({change:+.2f} %)"
    print(f"| {row['grid']} | {row['code']} | {cost} | {result} |", flush=True)


def _environment(folder: Path) -> Path:
    """Python of the peers' environment, made if it is not there."""
    python = folder / "bin" / "python"
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", str(folder)], check=True)
        needs = str(HERE / "requirements.txt")
        subprocess.run([str(python), "-m", "pip", "install", "-q", "-r", needs], check=True)
    return python


def _cells(grid: str) -> Cells:
    nx, ny, nz = (int(n) for n in grid.split("x"))
    return nx, ny, nz


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("grids", nargs="*", help="e.g. 48x24x24")
    parser.add_argument("--iterations", type=int, default=6)
    parser.add_argument("--environment", default=".venv-peers", help="folder of the peers' environment")
    parser.add_argument("--limit-s", type=float, default=1200.0, help="longest time of one code on one grid")
    parser.add_argument("--own-grids", nargs="*", default=[], help="grids of cranktopo alone")
    parser.add_argument("--json", metavar="FILE")
    parser.add_argument("--plot", metavar="FILE", help="picture, .svg or .png")
    parser.add_argument("--own", metavar="FILE", help=argparse.SUPPRESS)
    return parser.parse_args()


if __name__ == "__main__":
    main()
