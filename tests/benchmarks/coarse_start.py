"""What a start from larger cells saves, and costs: `python -m tests.benchmarks.coarse_start [MM]`.

The Mikron at volume fraction 0.3 on fine cells, forged as it is built in and with a free topology: from a
uniform start, and from the optimised design of cells twice as large with the last one to five stages of the
projection repeated. The objective is the weighted compliance, over the first of the uniform start.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence

import numpy as np

from cranktopo.design.loading import load_scene
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.density import loop, stage
from cranktopo.tasks.density.build import build_problem
from cranktopo.tasks.density.problem import DensityProblem
from cranktopo.tasks.density.stage import Prepared, first_state, iterate, prepare
from cranktopo.tasks.density.state import State


def main() -> None:
    """Print the table as Markdown; the first row of large cells of each process compiles their programs."""
    cell_mm = float(sys.argv[1]) if len(sys.argv) > 1 else 1.0
    print("| web | fine cells from β | iterations before | s | iterations on fine cells | s | objective % |")
    print("|---|---|---|---|---|---|---|", flush=True)
    for process, draft_deg in (("forged", None), ("free", 0.0)):
        scene = load_scene("mikron-iiic-plain").with_optimise(process=process, draft_deg=draft_deg)
        _rows(process, prepare(scene.with_optimise(resolution_mm=cell_mm, volume_fraction=0.3)))


def _rows(process: str, prepared: Prepared) -> None:
    """The rows of one process."""
    with double_precision():
        problem = build_problem(prepared.scene, prepared.domain, prepared.cases)
        uniform = loop.init(problem)
        first = loop.step(problem, uniform).initial_N_mm
        least = _row(process, problem, uniform, first)
        for softer in range(5):
            _row(process, problem, _begun(problem, prepared, softer), first, least)


def _begun(problem: DensityProblem, prepared: Prepared, softer: int) -> State:
    """A start from larger cells, the projection of the fine ones so many doublings softer than the last."""
    stage._SOFTER = softer
    return first_state(problem, prepared.scene, prepared.domain, prepared.cases)


def _row(
    process: str, problem: DensityProblem, start: State, first: Sequence[float], least: float | None = None
) -> float:
    """Print a row; the objective reached."""
    began = time.perf_counter()
    state = iterate(problem, start)
    seconds = time.perf_counter() - began
    objective = float(np.mean(np.divide(state.last.compliance_N_mm, first)))
    told = state.coarse_start
    before = f"{told.iterations} | {told.seconds:.1f}" if told else "- | -"
    cells = [process, f"{start.beta:g}", before, f"{len(state.history)} | {seconds:.1f}"]
    print(f"| {' | '.join(cells)} | {100 * (objective / (least or objective) - 1):+.2f} |", flush=True)
    return objective


if __name__ == "__main__":
    main()
