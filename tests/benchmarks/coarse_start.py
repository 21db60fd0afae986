"""What larger cells for the first stages save, and cost: `python -m tests.benchmarks.coarse_start [MM]`.

The Mikron at volume fraction 0.3 on fine cells, from a uniform start and with one to four stages of the
projection on cells twice as large. The objective is the weighted compliance, over the first of the uniform
start.
"""

from __future__ import annotations

import sys
import time

import numpy as np

from cranktopo.fem.precision import double_precision
from cranktopo.optimise import coarse_start, loop
from cranktopo.optimise.build import build_problem
from cranktopo.optimise.coarse_start import first_state
from cranktopo.optimise.stage import iterate, prepare
from cranktopo.scene import load_scene


def main() -> None:
    """Print the table as Markdown; the first row of large cells compiles their programs."""
    cell_mm = float(sys.argv[1]) if len(sys.argv) > 1 else 1.0
    prepared = prepare(load_scene("mikron-iiic").with_optimise(resolution_mm=cell_mm, volume_fraction=0.3))
    print("| stages on large cells | iterations there | s | iterations on fine cells | s | objective % |")
    print("|---|---|---|---|---|---|", flush=True)
    with double_precision():
        problem = build_problem(prepared.scene, prepared.domain, prepared.cases)
        uniform, least = loop.init(problem), 0.0
        first = np.array(loop.step(problem, uniform).initial_N_mm)
        for stages in range(5):
            coarse_start._STAGES = stages
            known = problem, prepared.scene, prepared.domain, prepared.cases
            start = first_state(*known) if stages else uniform
            began = time.perf_counter()
            state = iterate(problem, start)
            seconds = time.perf_counter() - began
            objective = float(np.mean(np.array(state.last.compliance_N_mm) / first))
            least = least or objective
            told = state.coarse_start
            before = f"{told.iterations} | {told.seconds:.1f}" if told else "- | -"
            cells = [f"{stages} | {before} | {len(state.history)}", f"{seconds:.1f}"]
            print(f"| {' | '.join(cells)} | {100 * (objective / least - 1):+.2f} |", flush=True)


if __name__ == "__main__":
    main()
