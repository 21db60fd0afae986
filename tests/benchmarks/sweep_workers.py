"""How much faster two workers are than one: python -m tests.benchmarks.sweep_workers [STAGE...].

Seconds for the same points of `mikron-iiic` on one core, by one worker on both cores, and by two workers with
a core each; the first points of each sweep, which start workers and programs, are left out. Optimisations
have cells of 3 mm and 20 iterations.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from cranktopo.pipeline.sweep.engine import Engine, compute
from cranktopo.pipeline.sweep.job import Job
from cranktopo.pipeline.sweep.plan import SweepPlan, sweep_plan
from cranktopo.pipeline.sweep.points import points_of
from cranktopo.pipeline.sweep.variation import Variation, read_option
from cranktopo.store import Json, write_json

OPTIMISED = ["optimise.resolution_mm=3", "optimise.max_iterations=20", "effects.bound=off"]
MEASURED: dict[str, tuple[int, list[str]]] = {
    "evaluate": (10, ["web.width_mm=46:57:12"]),
    "optimise": (4, [*OPTIMISED, "optimise.volume_fraction=0.26:0.36:6"]),
    "shape": (2, ["goal.minimise=mass", "effects.bound=off", "goal.limits.torsion=>= 97:103:4 %"]),
}
"""Points that are measured, two more that warm the workers, by stage."""


def main(stages: list[str]) -> None:
    """Print the table as Markdown."""
    print("| stage | points | 1 core, s | 2 cores, s | 2 workers, s | ratio to 1 core | to 2 cores |")
    print(f"|{'---|' * 7}")
    for stage in stages or list(MEASURED):
        points, texts = MEASURED[stage]
        vary: list[Variation] = [read_option(text) for text in texts]
        plan = sweep_plan(["mikron-iiic"], vary, stage=stage)
        one, both, two = (seconds(plan, points, Engine(*engine)) for engine in ((1, 1), (1, 2), (2, 1)))
        times = f"{one:.1f} | {both:.1f} | {two:.1f} | {one / two:.2f} | {both / two:.2f}"
        print(f"| {stage} | {points} | {times} |", flush=True)


def seconds(plan: SweepPlan, points: int, engine: Engine) -> float:
    """From the end of the warming points to the end of all others."""
    ends: list[float] = []

    def done(job: Job, result: Json) -> None:
        assert result["status"] == "done", result["reason"]
        ends.append(time.perf_counter())

    with tempfile.TemporaryDirectory() as folder:
        manifest: dict[str, Any] = {}
        write_json(Path(folder) / "manifest.json", manifest)
        jobs = [Job(point, folder) for point in points_of(plan)]
        assert len(jobs) == points + 2
        compute(jobs, engine, done)
    return ends[-1] - ends[1]


if __name__ == "__main__":
    main(sys.argv[1:])
