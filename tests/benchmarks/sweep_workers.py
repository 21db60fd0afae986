"""How much faster two workers are than one: python -m tests.benchmarks.sweep_workers [STAGE...].

Seconds for the same points of `mikron-iiic` by one worker on both cores and by two workers with a core each;
the first points of each sweep, which start workers and programs, are left out. Optimisations have cells of 3
mm and 20 iterations, shapes are evaluated on elements of 12 mm.
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
    "evaluate": (10, ["web.width_mm=50:61:12"]),
    "optimise": (4, [*OPTIMISED, "optimise.volume_fraction=0.26:0.36:6"]),
    "shape": (2, ["goal.minimise=mass", "effects.bound=off", "goal.limits.torsion=>= 97:103:4 %"]),
}
"""Points that are measured, two more that warm the workers, by stage."""
SIZES_MM = {"shape": 12.0}
"""Elements of evaluations where they are not those of the default."""


def main(stages: list[str]) -> None:
    """Print the table as Markdown."""
    print("| stage | points | 1 worker, s | 2 workers, s | ratio |\n|---|---|---|---|---|")
    for stage in stages or list(MEASURED):
        points, texts = MEASURED[stage]
        vary: list[Variation] = [read_option(text) for text in texts]
        plan = sweep_plan(["mikron-iiic"], vary, stage=stage, element_size_mm=SIZES_MM.get(stage))
        one, two = (seconds(plan, points, Engine(*engine)) for engine in ((1, 2), (2, 1)))
        print(f"| {stage} | {points} | {one:.1f} | {two:.1f} | {one / two:.2f} |", flush=True)


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
