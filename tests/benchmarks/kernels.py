"""What the processor's kernels save on a cantilever: `python -m tests.benchmarks.kernels [--json FILE]`.

Every row is made of processes of their own, with kernels and without in turn (CRANKTOPO_KERNELS=off), without
stored compilations. Per process: the product with the stiffness, a solve from zero with its hierarchy, and
the median over the design iterations after the first. A row is the median of its processes.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
from itertools import product
from pathlib import Path
from typing import Any

from cranktopo.numerics.kernels.catalogue import OFF, SWITCH
from cranktopo.numerics.kernels.registry import why_no_kernels
from cranktopo.numerics.precision import CompileClock, double_precision
from tests.benchmarks.solver import COMPILED_ANEW, optimisation, peak_MiB, product_ns, solve_s

GRIDS = ("48x24x24", "96x48x48")
SWITCHES = {"on": "", "off": OFF}
ITERATIONS = 6
ROUNDS = 3
# Columns of the table: title, key of a row, format.
COLUMNS = (
    ("grid", "grid", "{}"),
    ("cells", "cells", "{:,}"),
    ("kernels", "kernels", "{}"),
    ("float32 product ns per unknown", "float32_product_ns", "{:.3g}"),
    ("float64", "float64_product_ns", "{:.3g}"),
    ("solve s", "solve_s", "{:.3g}"),
    ("s per iteration", "iteration_s", "{:.3g}"),
    ("compile s", "compile_s", "{:.3g}"),
    ("peak MiB", "peak_MiB", "{:.0f}"),
)
Row = dict[str, Any]


def main() -> None:
    """Run the grids, print the table, write the JSON."""
    options = _options()
    if options.one:
        print(json.dumps(measure(options.one)))
        return
    rows = []
    print(f"| {' | '.join(title for title, _, _ in COLUMNS)} |")
    print("|" + "---|" * len(COLUMNS), flush=True)
    for grid in options.grids or GRIDS:
        rows += (pair := compared(grid, options.rounds))
        for row in pair:
            cells = (form.format(row[key]) for _, key, form in COLUMNS)
            print(f"| {' | '.join(cells)} |", flush=True)
    if options.json:
        Path(options.json).write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")


def compared(grid: str, rounds: int) -> list[Row]:
    """A row with kernels and one without: medians of processes that took turns."""
    runs: dict[str, list[Row]] = {kernels: [] for kernels in SWITCHES}
    for _, kernels in product(range(rounds), SWITCHES):
        runs[kernels].append(_in_own_process(grid, SWITCHES[kernels]))
    keys = [key for _, key, _ in COLUMNS[3:]]
    return [
        {"grid": grid, "cells": found[0]["cells"], "kernels": kernels}
        | {key: statistics.median(row[key] for row in found) for key in keys}
        for kernels, found in runs.items()
    ]


def measure(grid: str) -> Row:
    """All figures of one grid, in this process."""
    clock = CompileClock()
    if not os.environ.get(SWITCH) and (reason := why_no_kernels()):
        raise SystemExit(f"no kernels here: {reason}")
    with double_precision():
        figures, design, model = optimisation(grid, 1, ITERATIONS)
        row = {"cells": design.size, **figures, "compile_s": clock.compile_s, "peak_MiB": peak_MiB()}
        row["float32_product_ns"] = product_ns(model, design, "float32")
        row["float64_product_ns"] = product_ns(model, design, "float64")
        row["solve_s"] = solve_s(model, design, "float32")
    return row


def _in_own_process(grid: str, switch: str) -> Row:
    command = [sys.executable, "-m", "tests.benchmarks.kernels", "--one", grid]
    here = os.environ | COMPILED_ANEW | {"JAX_PLATFORMS": "cpu", SWITCH: switch}
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=here)
    if done.returncode:
        raise SystemExit(f"{grid}: {done.stderr}")
    row: Row = json.loads(done.stdout.splitlines()[-1])
    return row


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("grids", nargs="*", help="e.g. 48x24x24")
    parser.add_argument("--json", metavar="FILE")
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    parser.add_argument("--one", metavar="GRID", help=argparse.SUPPRESS)
    return parser.parse_args()


if __name__ == "__main__":
    main()
