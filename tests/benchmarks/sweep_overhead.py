"""What a point of a sweep costs beside its work: python -m tests.benchmarks.sweep_overhead WORKERS [POINTS].

Empty points, from the plan to the page; 10 000 by default.
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

from cranktopo.tasks.sweep.computed import Workplace
from cranktopo.tasks.sweep.front import front_of
from cranktopo.tasks.sweep.page import sweep_html
from cranktopo.tasks.sweep.plan import SweepPlan, sweep_plan
from cranktopo.tasks.sweep.points import points_of
from cranktopo.tasks.sweep.run import SweptRun, run_sweep
from cranktopo.tasks.sweep.text import write_tables
from cranktopo.tasks.sweep.variation import read_option
from tests.sweep_cases import empty


def plan_of(points: int) -> SweepPlan:
    """So many webs, all of which can be."""
    vary = [read_option("web.width_mm=50:60"), read_option("throw.radius_mm=44:52")]
    return sweep_plan(["mikron-iiic-plain"], vary, sampling="latin", samples=points)


def timed(work: Callable[[], object]) -> float:
    """Seconds that some work takes."""
    began = time.perf_counter()
    work()
    return time.perf_counter() - began


def written(done: SweptRun, folder: Path) -> None:
    """Front, table and page of a finished sweep once more."""
    front_of([row for row in done.result.points if row.status == "done"])
    write_tables(done.frame, folder, "again")
    sweep_html(done.result, {})


def main(workers: int, points: int) -> None:
    """Print the whole and its parts."""
    plan = plan_of(points)
    with tempfile.TemporaryDirectory() as folder:
        began = time.perf_counter()
        done = run_sweep(plan, Workplace(workers, function=empty), Path(folder) / "run")
        whole = time.perf_counter() - began
        told = timed(partial(written, done, Path(folder)))
    planned = timed(lambda: points_of(plan))
    parts = (whole, planned, whole - planned - told, told)
    print("| workers | points | all, s | ms a point | of them plan | Dask and files | table and page |")
    print("|---|---|---|---|---|---|---|")
    print(f"| {workers} | {points} | {whole:.0f} | {' | '.join(f'{1000 * s / points:.1f}' for s in parts)} |")


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]) if sys.argv[2:] else 10_000)
