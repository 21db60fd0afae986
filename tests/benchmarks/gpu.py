"""Large grids on a GPU and on the CPU: `python -m tests.benchmarks.gpu [GRID...] [--cpu-cells N]`.

A cantilever of 1, 8, 64 and 134 million cells on every device that JAX finds, each in a process of its own:
seconds per design iteration, bytes per cell at the peak, share of the memory bandwidth that the product with
the stiffness reaches, compliance of the last design. The CPU takes the grids up to `--cpu-cells`; where both
have a row, their compliances may differ by 0.1 %. Then the hard cases, on the first device but the CPU.

`--expected GRID` says instead what to expect of GPUs, from one grid on this CPU: an iteration moves the same
bytes on any device, so at the same share of bandwidth its seconds fall as the bandwidth grows, and a grid
fits where its bytes do.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import subprocess
import sys
from itertools import product

from cranktopo.numerics.precision import double_precision
from tests.benchmarks.solver import (
    Row,
    devices,
    ideal_ns,
    optimisation,
    peak_MiB,
    product_ns,
    stream_GB_s,
)

GRIDS = ("160x80x80", "320x160x160", "640x320x320", "1024x512x256")
ITERATIONS = 4
CPU_CELLS = 9_000_000
AGREES_PERCENT = 0.1
# Memory bandwidth (GB/s) and memory (GB) of the data sheets.
SHEETS = {"GTX 1080 Ti": (484, 11), "A100 80 GB": (2039, 80), "H100 SXM": (3350, 80), "H200": (4800, 141)}


def main() -> None:
    """Measure and print the tables as Markdown."""
    options = _options()
    if options.one:
        print(json.dumps(measure(options.one)))
        return
    if options.expected:
        print("\n".join(expectation(measure(options.expected), options.grids or GRIDS)))
        return
    print("| device | grid | cells | s per iteration | CG | bytes per cell | of bandwidth | compliance |")
    print("|" + "---|" * 8, flush=True)
    rows: list[Row] = []
    for device, grid in product(devices(), options.grids or GRIDS):
        if device != "cpu" or cells_of(grid) <= options.cpu_cells:
            rows.append({"device": device, "grid": grid} | _in_own_process(grid, device))
            print(row_text(rows[-1]), flush=True)
    for grid, percent in differences(rows).items():
        verdict = "agree" if percent <= AGREES_PERCENT else "DIFFER"
        print(f"\n{grid}: the designs of the devices {verdict}, compliances within {percent:.4f} %")
    others = [device for device in devices() if device != "cpu"]
    if others:
        hard = [sys.executable, "-m", "tests.benchmarks.hard_cases"]
        subprocess.run(hard, check=True, env=os.environ | {"JAX_PLATFORMS": others[0]})


def measure(grid: str, iterations: int = ITERATIONS) -> Row:
    """Figures of one grid on the device of this process."""
    with double_precision():
        found, design, model = optimisation(grid, 1, iterations)
        memory = peak_MiB()
        bandwidth = stream_GB_s()
        share = ideal_ns(model, 4, bandwidth) / product_ns(model, design, "float32")
    return found | {"cells": design.size, "peak_MiB": memory, "of_bandwidth": share, "GB_s": bandwidth}


def differences(rows: list[Row]) -> dict[str, float]:
    """Largest difference of the compliances of a grid between devices, percent, where two have it."""
    found: dict[str, list[float]] = {}
    for row in rows:
        if "failure" not in row:
            found.setdefault(row["grid"], []).append(row["compliance"])
    return {grid: 100 * (max(c) / min(c) - 1) for grid, c in found.items() if len(c) > 1}


def expectation(row: Row, grids: tuple[str, ...]) -> list[str]:
    """What to expect of GPUs, as a table, from the bytes that a measured row moves and keeps per cell."""
    bytes_per_cell = row["peak_MiB"] * 2**20 / row["cells"]
    heads = [f"{name}, {bandwidth} GB/s" for name, (bandwidth, _) in SHEETS.items()]
    lines = [f"| cells | {' | '.join(heads)} |", "|---|" + "---|" * len(SHEETS)]
    for cells in map(cells_of, grids):
        told = [
            f"{expected_s(row, cells, bandwidth):.2g} s"
            if cells * bytes_per_cell <= 1e9 * memory
            else "no room"
            for bandwidth, memory in SHEETS.values()
        ]
        lines.append(f"| {cells:,} | {' | '.join(told)} |")
    return lines


def expected_s(row: Row, cells: int, bandwidth_GB_s: float) -> float:
    """Seconds per design iteration that a measured row lets expect at another bandwidth."""
    return float(row["iteration_s"] * cells / row["cells"] * row["GB_s"] / bandwidth_GB_s)


def cells_of(grid: str) -> int:
    """Number of cells of a grid such as 48x24x24."""
    return math.prod(int(n) for n in grid.split("x"))


def row_text(row: Row) -> str:
    """A row of the table, or why there is none."""
    if "failure" in row:
        return (
            f"| {row['device']} | {row['grid']} | {cells_of(row['grid']):,} | {row['failure']} |" + " - |" * 4
        )
    share = (
        f"{row['peak_MiB'] * 2**20 / row['cells']:,.0f} | {row['of_bandwidth']:.0%} of {row['GB_s']:.3g} GB/s"
    )
    cost = f"{row['iteration_s']:.3g} | {row['cg']:g} | {share}"
    return f"| {row['device']} | {row['grid']} | {row['cells']:,} | {cost} | {row['compliance']:.6g} |"


def _in_own_process(grid: str, device: str) -> Row:
    command = [sys.executable, "-m", "tests.benchmarks.gpu", "--one", grid]
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, env=os.environ | {"JAX_PLATFORMS": device}
    )
    if done.returncode:
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        return {"failure": f"exit {done.returncode}: {last[:80].replace('|', '/')}"}
    row: Row = json.loads(done.stdout.splitlines()[-1])
    return row


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("grids", nargs="*", type=str, help="e.g. 160x80x80; default: 1 to 134 million cells")
    parser.add_argument("--cpu-cells", type=int, default=CPU_CELLS, help="largest grid of the CPU")
    parser.add_argument("--expected", metavar="GRID", help="measure it on the CPU, and tell of GPUs")
    parser.add_argument("--one", metavar="GRID", help=argparse.SUPPRESS)
    return parser.parse_args()


if __name__ == "__main__":
    main()
