"""The solve on several devices: `python -m tests.benchmarks.devices [GRID] [--expected GRID]`.

The processor's cores stand in for devices, so seconds mean nothing here: the displacements of two lopsided
load cases against those of one device, and the memory that the compiler sets aside on each.

`--expected GRID` says instead what to expect of real devices, from one grid on this CPU: each computes its
share of the cells at the same share of its bandwidth, and swaps a plane of nodes with its neighbours after
every product.
"""

from __future__ import annotations

import argparse
import math

from cranktopo.numerics.grid.conjugate_gradients import partition_of
from cranktopo.numerics.grid.equilibrium import METHODS
from cranktopo.numerics.grid.lattice import Cells, Lattice
from cranktopo.numerics.grid.multigrid import build_tables, smoothing_steps
from tests.benchmarks.gpu import GRIDS, SHEETS, cells_of, expected_s, measure
from tests.benchmarks.solver import Row
from tests.studies.cantilever import halvings
from tests.studies.parts import in_own_process

GRID = "64x64x128"
PARTS = (1, 2, 4, 8)
DEVICE = "H100 SXM"
# One way, GB/s, of the data sheets: NVLink of the H100, and PCI Express 5 with 16 lanes.
LINKS = {"NVLink": 450.0, "PCIe": 63.0}
# Assumed: what a message waits before its first byte, and the sums over all devices in an iteration.
WAIT_S, SUMS = 20e-6, 8


def main() -> None:
    """Measure or estimate, and print the table as Markdown."""
    options = _options()
    if options.expected:
        print("\n".join(expectation(measure(options.expected), GRIDS)))
        return
    cells = cells_of(options.grid)
    print("| devices | levels cut | iterations | difference | residual | bytes per cell on each |")
    print("|" + "---|" * 6)
    for row in in_own_process(options.grid, PARTS):
        levels = row["levels"] if row["parts"] > 1 else "-"
        told = f"{row['difference']:.1e} | {row['residual']:.1e} | {row['device_bytes'] / cells:.0f}"
        print(f"| {row['parts']} | {levels} | {row['iterations']} | {told} |")


def expectation(row: Row, grids: tuple[str, ...]) -> list[str]:
    """Seconds per design iteration on one device and its multiples, by link, as a table."""
    heads = [f"{parts} by {link}" for link in LINKS for parts in PARTS[1:]]
    lines = [f"| cells | 1 {DEVICE} | {' | '.join(heads)} |", "|---|" + "---|" * (len(heads) + 1)]
    bandwidth, _ = SHEETS[DEVICE]
    for grid in grids:
        one = expected_s(row, cells_of(grid), bandwidth)
        told = [
            f"{one / parts + row['cg'] * messages_s(grid, parts, link):.2g} s"
            for link in LINKS.values()
            for parts in PARTS[1:]
        ]
        lines.append(f"| {cells_of(grid):,} | {one:.2g} s | {' | '.join(told)} |")
    return lines


def messages_s(grid: str, parts: int, link_GB_s: float) -> float:
    """Seconds of all messages of one iteration of conjugate gradients, one load case, none of them hidden."""
    length, width, height = (int(n) for n in grid.split("x"))
    sent = exchanged_bytes((width, height, length), parts)
    return sum(WAIT_S + size / link_GB_s / 1e9 for size in sent) + SUMS * WAIT_S


def exchanged_bytes(cells: Cells, parts: int) -> list[int]:
    """What a device sends to a neighbour in each message of an iteration, one load case."""
    lattice = Lattice(cells, 1.0, 1.0, (1.0,) * cells[2], 0.3)
    coarsenings = lattice.coarsenings(halvings(cells))
    cut = partition_of(build_tables(lattice, halvings(cells)), parts).levels
    grids = [cells, *(_coarse(cells, factors) for factors in coarsenings[: cut - 1])]
    nodes = math.prod(lattice.nodes)
    products = [2 * smoothing_steps(METHODS[0].degree, level, nodes) for level in range(cut)]
    smoothed = [4 * _plane(grid) for grid, count in zip(grids, products, strict=True) for _ in range(count)]
    restricted = [4 * _plane(grid) for grid in grids[1:]]
    # What the last level that is cut leaves goes to every device.
    joined = 4 * _plane(grids[-1]) * grids[-1][2]
    # Of conjugate gradients themselves: the product in float64, and one correction for both sides.
    outside = [8 * _plane(cells), 4 * _plane(cells)]
    return [*outside, *smoothed, *restricted, joined]


def _coarse(cells: Cells, factors: Cells) -> Cells:
    return cells[0] // factors[0], cells[1] // factors[1], cells[2] // factors[2]


def _plane(cells: Cells) -> int:
    """Numbers of a plane of nodes."""
    return 3 * (cells[0] + 1) * (cells[1] + 1)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("grid", nargs="?", default=GRID, help=f"default {GRID}")
    parser.add_argument("--expected", metavar="GRID", help="measure it on the CPU, and tell of GPUs")
    return parser.parse_args()


if __name__ == "__main__":
    main()
