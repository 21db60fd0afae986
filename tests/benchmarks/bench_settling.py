"""Seconds of the settled answers of the bench: python -m tests.benchmarks.bench_settling [DESIGN...].

A drag of the web's thickness as a person makes it, by 1 % of itself and then by another: in a process of its
own for each answer, as in the bench, but one after the other, so that each has both cores. The first web has
a new mesh for its safety, the next ones have that mesh moved.
"""

from __future__ import annotations

import os
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

from cranktopo.base.notes import silent
from cranktopo.design.loading import load_scene
from cranktopo.tasks.bench.settled import settled_safety, settled_stiffness

DESIGNS = ("mikron-iiic", "car-diesel", "industrial-gas")
THICKER = (1.0, 1.01, 1.02)
ANSWERS = {"stiffness": settled_stiffness, "safety": settled_safety}


def thickened(design: str, factor: float) -> dict[str, Any]:
    """Return a design as plain data, its web so many times as thick."""
    data = load_scene(design).model_dump(mode="json", exclude_none=True)
    data["web"]["thickness_mm"] *= factor
    return data


def timed(answer: str, data: dict[str, Any]) -> tuple[float, float]:
    """Return wall and processor seconds of an answer about a design as plain data."""
    wall, cpu = time.perf_counter(), time.process_time()
    with silent():
        ANSWERS[answer](data)
    return time.perf_counter() - wall, time.process_time() - cpu


def main(designs: tuple[str, ...]) -> None:
    """Print the table as Markdown."""
    os.environ["OPENBLAS_NUM_THREADS"] = "1"  # as the program has it
    heads = [f"{answer}, {100 * (f - 1):.0f} % thicker" for answer in ANSWERS for f in THICKER]
    print(f"| s (processor s) | {' | '.join(heads)} |\n|{'---|' * (1 + len(heads))}")
    for design in designs:
        cells = []
        for answer in ANSWERS:
            with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as process:
                for factor in THICKER:
                    wall, cpu = process.submit(timed, answer, thickened(design, factor)).result()
                    cells.append(f"{wall:.1f} ({cpu:.1f})")
        print(f"| `{design}` | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main(tuple(sys.argv[1:]) or DESIGNS)
