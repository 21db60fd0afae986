"""How much faster two workers are than one: python -m tests.benchmarks.sweep_workers [STAGE...].

Seconds for the same points of `mikron-iiic-plain` by one worker on one core, by one on both, and by two with
a core each. The first points of each sweep, which start workers and programs, are left out, but for shapes,
beside which that is little. Optimisations have cells of 3 mm and 20 iterations, shapes are evaluated on
elements of 12 mm.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from cranktopo.base.files import write_json
from cranktopo.tasks.sweep.executor import WorkerPool, compute
from cranktopo.tasks.sweep.job import Job
from cranktopo.tasks.sweep.plan import SweepPlan, sweep_plan
from cranktopo.tasks.sweep.points import points_of
from cranktopo.tasks.sweep.result import PointResult
from cranktopo.tasks.sweep.variation import Variation, read_option

OPTIMISED = ["optimise.resolution_mm=3", "optimise.max_iterations=20", "effects.bound=off"]
ENGINES = (WorkerPool(1, 1), WorkerPool(1, 2), WorkerPool(2, 1))
MEASURED: dict[str, tuple[int, int, list[str]]] = {
    "evaluate": (2, 10, ["web.width_mm=50:61:12"]),
    "optimise": (2, 4, [*OPTIMISED, "optimise.volume_fraction=0.26:0.36:6"]),
    "shape": (0, 2, ["goal.minimise=mass", "effects.bound=off", "goal.limits.torsion=>= 97:103:2 %"]),
}
"""Points that warm the workers and points that are measured, by stage."""
SIZES_MM = {"shape": 12.0}
"""Elements of evaluations where they are not those of the default."""


def main(stages: list[str]) -> None:
    """Print the table as Markdown."""
    heads = "1 worker, 1 core, s | 1 worker, both cores, s | 2 workers, s | ratio to 1 core | to both cores"
    print(f"| stage | points | {heads} |\n|{'---|' * 7}")
    for stage in stages or list(MEASURED):
        warming, points, texts = MEASURED[stage]
        vary: list[Variation] = [read_option(text) for text in texts]
        plan = sweep_plan(["mikron-iiic-plain"], vary, stage=stage, element_size_mm=SIZES_MM.get(stage))
        one, both, two = (seconds(plan, warming, points, engine) for engine in ENGINES)
        shown = f"{one:.1f} | {both:.1f} | {two:.1f} | {one / two:.2f} | {both / two:.2f}"
        print(f"| {stage} | {points} | {shown} |", flush=True)


def seconds(plan: SweepPlan, warming: int, points: int, engine: WorkerPool) -> float:
    """From the end of the warming points, or else from the start, to the end of all others."""
    ends: list[float] = [time.perf_counter()]

    def done(job: Job, result: PointResult) -> None:
        assert result.status == "done", result.reason
        ends.append(time.perf_counter())

    with tempfile.TemporaryDirectory() as folder:
        manifest: dict[str, Any] = {}
        write_json(Path(folder) / "manifest.json", manifest)
        jobs = [Job(point, folder) for point in points_of(plan)]
        assert len(jobs) == warming + points
        compute(jobs, engine, done)
    return ends[-1] - ends[warming]


if __name__ == "__main__":
    main(sys.argv[1:])
