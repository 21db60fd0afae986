"""Share of an iteration that the optimiser's own step takes: least mass by moving asymptotes, both engines.

    python -m tests.benchmarks.step_share [CELL_MM]

The step is everything from the slopes of goal and limits to the next design; solve, filter and slopes count
to the iteration. Medians over the iterations, without those that compile; one line per engine as Markdown.
"""

from __future__ import annotations

import sys
import time
from statistics import median
from typing import Any
from unittest.mock import patch

import jax

from cranktopo.design.goal.scene_goal import with_goal
from cranktopo.design.loading import load_scene
from cranktopo.numerics.optimisers.mma import MmaStep, mma_step
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.density import loop, proposals
from cranktopo.tasks.density.build import build_problem
from cranktopo.tasks.density.stage import iterate, prepare

ENGINES = ("mikron-iiic-plain", "opposed-piston")


def main(cell_mm: float = 1.5) -> None:
    """Print the table as Markdown."""
    print("| engine | design cells | iteration s | step s | share % |\n|---|---|---|---|---|")
    for engine in ENGINES:
        seconds: list[float] = []

        def timed(*given: Any, seconds: list[float] = seconds) -> MmaStep:
            jax.block_until_ready(given)
            began = time.perf_counter()
            taken: MmaStep = jax.block_until_ready(mma_step(*given))
            seconds.append(time.perf_counter() - began)
            return taken

        scene = load_scene(engine).with_optimise(resolution_mm=cell_mm, process="free", max_iterations=12)
        ready = prepare(with_goal(scene, minimise="mass", maximise=None, limits=()))
        with double_precision(), patch.object(proposals, "mma_step", timed):
            problem = build_problem(ready.scene, ready.domain, ready.cases)
            state = iterate(problem, loop.init(problem))
        whole, step = median(row.seconds for row in state.history[2:]), median(seconds[2:])
        cells = int((ready.domain.design_fraction > 0).sum())
        print(f"| {engine} | {cells} | {whole:.3f} | {step:.4f} | {100 * step / whole:.1f} |", flush=True)


if __name__ == "__main__":
    main(*map(float, sys.argv[1:2]))
