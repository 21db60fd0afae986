"""What the effects of a scene cost: design iterations with and without them, timed in one run.

Run with `python -m tests.benchmarks.effects_cost`. Ratios are to the built-in scene (bending and torsion with
the lateral mirror); the planned ratio is that of cells times load cases.
"""

from __future__ import annotations

import math
import time
from statistics import median
from typing import Any

from cranktopo.fem.precision import double_precision
from cranktopo.optimise import loop, stage
from cranktopo.scene import load_scene
from tests.benchmarks.effects_truth import changed

SCENES: dict[str, dict[str, dict[str, Any]]] = {
    "bending and torsion": {},
    "torsion only": {"effects": {"bending": "off"}},
    "bending only": {"effects": {"torsion": "off"}},
    "with tangential": {"effects": {"tangential": "on"}},
    "with centrifugal": {"optimise": {"weights": {"centrifugal": 0.5}}, "effects": {"centrifugal": "on"}},
    "without the mirror": {"effects": {"lateral_symmetry": "off"}},
    "without bores": {"effects": {"bores": "off"}},
}
TIMED = 6


def iteration(changes: dict[str, dict[str, Any]]) -> tuple[int, int, float]:
    """Cells, load cases and median seconds of the design iterations after the first two."""
    with double_precision():
        ready = stage.prepare(changed(load_scene("mikron-iiic"), **changes))
        problem = loop.build_problem(ready.scene, ready.domain, ready.cases)
        state, seconds = loop.init(problem), []
        for _ in range(TIMED + 2):
            began = time.perf_counter()
            state = loop.step(problem, state)
            seconds.append(time.perf_counter() - began)
    return math.prod(ready.domain.grid.cells), len(ready.cases), median(seconds[2:])


def main() -> None:
    """Print the table as Markdown."""
    print("| scene | cells | load cases | s per iteration | ratio | planned |")
    print("|---|---|---|---|---|---|")
    reference: tuple[float, float] | None = None
    for name, changes in SCENES.items():
        cells, cases, seconds = iteration(changes)
        reference = reference or (seconds, cells * cases)
        ratios = f"{seconds / reference[0]:.2f} | {cells * cases / reference[1]:.2f}"
        print(f"| {name} | {cells:,} | {cases} | {seconds:.2f} | {ratios} |", flush=True)


if __name__ == "__main__":
    main()
