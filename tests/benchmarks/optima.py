"""Optima of the plain volume problem: where each method ends, and where it goes from the other's end.

    python -m tests.benchmarks.optima [CELL_MM]

Twenty iterations per stage of the projection, so that stages end by their objective. Mass and stiffnesses in
percent of the original; one line per run as Markdown.
"""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np

from cranktopo.design.loading import load_scene
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.density import loop
from cranktopo.tasks.density.assess import assess, assess_original
from cranktopo.tasks.density.build import build_problem
from cranktopo.tasks.density.stage import iterate, prepare
from cranktopo.tasks.density.state import State

METHODS = ("optimality_criteria", "moving_asymptotes")


def main(cell_mm: float = 3.0) -> None:
    """Print the table as Markdown."""
    print("| method | from | steps | mass % | torsion % | bending % |\n|---|---|---|---|---|---|")
    scene = load_scene("mikron-iiic-plain").with_optimise(
        resolution_mm=cell_mm, process="free", stage_iterations=20, max_iterations=300
    )
    ends: dict[str, State] = {}
    with double_precision():
        ready = {method: prepare(scene.with_optimise(method=method)) for method in METHODS}
        problems = {method: build_problem(r.scene, r.domain, r.cases) for method, r in ready.items()}
        for begun in (False, True):
            for method, other in zip(METHODS, reversed(METHODS), strict=True):
                problem, r = problems[method], ready[method]
                state = loop.init(problem)
                if begun:
                    state = replace(state, x=ends[other].x, beta=ends[other].beta)
                state = iterate(problem, state)
                if not begun:
                    ends[method] = state
                design = loop.final_design(problem, state).physical
                found = assess(problem, r.scene, r.domain, design).quantities
                own = assess_original(problem.model, r.scene, r.domain).quantities
                share = [100 * found[name] / own[name] for name in ("mass", "torsion", "bending")]
                told = " | ".join(f"{value:.2f}" for value in np.array(share))
                start = f"the end of {other.replace('_', ' ')}" if begun else "the uniform design"
                print(f"| {method.replace('_', ' ')} | {start} | {len(state.history)} | {told} |", flush=True)


if __name__ == "__main__":
    main(*map(float, sys.argv[1:2]))
