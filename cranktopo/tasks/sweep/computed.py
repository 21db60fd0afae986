"""The results of a sweep's points: kept or computed now, all at full accuracy or coarse first."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from cranktopo.base.machine import usable_cores
from cranktopo.base.notes import duration_text, note
from cranktopo.bodies.memory import (
    available_memory_MiB,
    mesh_memory_MiB,
    meshed_volume_mm3,
    optimiser_memory_MiB,
)
from cranktopo.design.halves import default_element_size_mm
from cranktopo.design.schema import Scene
from cranktopo.tasks.sweep.executor import WorkerPool, compute
from cranktopo.tasks.sweep.front import worth_refining
from cranktopo.tasks.sweep.job import Job, PointFunction, keep_result, kept_result, point_result
from cranktopo.tasks.sweep.plan import Stage, SweepPlan
from cranktopo.tasks.sweep.points import SweepPoint
from cranktopo.tasks.sweep.result import COARSE, DONE, FAILED, FULL, IMPOSSIBLE, VIEW, PointResult

_EVERY_S = 5.0


class _Progress:
    """Lines of progress, one every few seconds; time left by the pace since the start."""

    def __init__(self, points: int, kept: int) -> None:
        self._points, self._done = points, kept
        self._ends: Counter[str] = Counter()
        self._last_note_s = time.perf_counter()
        self._first = 0.0
        if kept:
            note(f"{kept} of {points} points need no computing")

    def add(self, status: str) -> None:
        """Count the end of a point."""
        self._done += 1
        self._ends[status] += 1
        now = time.perf_counter()
        self._first = self._first or now
        if now - self._last_note_s >= _EVERY_S or self._done == self._points:
            self._last_note_s = now
            bad = [f"{count} {end}" for end, count in sorted(self._ends.items()) if end != DONE]
            note(", ".join([f"{self._done} of {self._points} points", *bad, *self._time_left(now)]))

    def _time_left(self, now: float) -> list[str]:
        """Count the points that ended since the first one, which waited for the workers to start."""
        since, left = self._ends.total() - 1, self._points - self._done
        return [f"about {duration_text(left * (now - self._first) / since)} left"] if since and left else []


_PROGRAM_MIB = 500.0
"""Of a worker that has loaded everything and computes nothing."""
_REFINED = 2.0
"""An estimate leaves out what is refined at fillets."""


def _point_memory_MiB(scene: Scene, stage: Stage, element_size_mm: float | None) -> float:
    size = element_size_mm or default_element_size_mm(scene)
    evaluation = _PROGRAM_MIB + _REFINED * mesh_memory_MiB(meshed_volume_mm3(scene), size)
    if stage in ("evaluate", "fatigue") or scene.envelope is None:
        return evaluation
    cells = optimiser_memory_MiB(scene, scene.optimise.resolution_mm, quarter=False, cases=2)
    return max(evaluation, cells)


@dataclass(frozen=True)
class Workplace:
    """The place where points of a sweep are computed; by default all cores of this machine.

    Attributes:
        scheduler: address of a Dask scheduler, in place of workers of this machine.
        function: in place of the stages: numbers of a scene, by name.
    """

    workers: int | None = None
    scheduler: str | None = None
    function: PointFunction | None = None

    @property
    def settings(self) -> dict[str, str]:
        """Settings that results depend on beside the plan."""
        function = self.function
        return {} if function is None else {"function": f"{function.__module__}.{function.__qualname__}"}


ALL_CORES = Workplace()


@dataclass(frozen=True)
class Computed:
    """The row of every point in order, what they are compared with, and what the page shows of webs, by id.

    `undecided` are ids of points that may be on the front, for which the budget left no time.
    """

    rows: tuple[PointResult, ...]
    original: PointResult
    webs: Mapping[str, str]
    undecided: tuple[str, ...] = ()


@dataclass(frozen=True)
class Session:
    """All that computing the points of a sweep takes; `root` is its directory, absolute."""

    root: str
    plan: SweepPlan
    place: Workplace

    def computed(
        self, points: Sequence[SweepPoint], looks: Sequence[SweepPoint], original: SweepPoint
    ) -> Computed:
        """Return all rows; `looks` are the same points as a first look computes them, none without one."""
        if looks:
            return self._front_refined(points, looks, original)
        found = self._results([*points, original])
        rows = tuple(_row(point, found[point.id]) for point in points)
        return Computed(rows, _row(original, found[original.id]), _webs(found))

    def _front_refined(
        self, points: Sequence[SweepPoint], looks: Sequence[SweepPoint], original: SweepPoint
    ) -> Computed:
        """Compute rounds of full accuracy until no other point may be on the front, or the time is used."""
        note("first look: all points, coarse")
        coarse = self._results([*looks, original])
        pairs = [(point, coarse[look.id]) for point, look in zip(points, looks, strict=True)]
        full = {point.id: row for point, row in pairs if point.reason}
        reference = coarse[original.id]
        end = time.monotonic() + (self.plan.budget_s or float("inf"))
        while todo := worth_refining(pairs, full, reference):
            if time.monotonic() >= end:
                break
            note(f"full accuracy: {len(todo)} points that may be on the front")
            full |= self._results(todo, end)
        rows = [
            _row(point, full.get(point.id, look), accuracy=FULL if point.id in full else COARSE)
            for point, look in pairs
        ]
        names = {point.id: look.id for point, look in pairs}
        undecided = tuple(names[point.id] for point in todo)
        return Computed(tuple(rows), _row(original, reference), _webs({**coarse, **full}), undecided)

    def _results(self, points: Sequence[SweepPoint], end: float = float("inf")) -> dict[str, PointResult]:
        """Return the result of every point by its id: kept, impossible from the start, or computed now.

        At `end` of the monotonic clock the rest is left.
        """
        jobs = [Job(point, self.root, self.place.function) for point in {p.id: p for p in points}.values()]
        found: dict[str, PointResult] = {}
        for job in jobs:
            kept = point_result(job, IMPOSSIBLE, job.point.reason) if job.point.reason else kept_result(job)
            if kept is not None:
                found[job.point.id] = kept
        progress = _Progress(len(jobs), len(found))

        def done(job: Job, result: PointResult) -> None:
            if result.status != FAILED or result.number("seconds") is not None:
                keep_result(job, result)
            found[job.point.id] = result
            progress.add(result.status)

        left = [job for job in jobs if job.point.id not in found]
        if left:
            compute(left, self._engine(len(left)), done, lambda: time.monotonic() >= end)
        return found

    def _engine(self, points: int) -> WorkerPool:
        plan, place = self.plan, self.place
        if place.scheduler is not None:
            return WorkerPool(scheduler=place.scheduler)
        cores, scene = usable_cores(), plan.original
        workers_that_fit = place.workers
        if workers_that_fit is None:
            memory = max(_point_memory_MiB(scene, stage, plan.element_size_mm) for stage in plan.stages)
            workers_that_fit = min(cores, int(available_memory_MiB() / memory))
        workers = max(1, min(workers_that_fit, points))
        return WorkerPool(workers, max(1, cores // workers))


def _webs(results: Mapping[str, PointResult]) -> dict[str, str]:
    return {one: view for one, result in results.items() if (view := result.number(VIEW))}


def _row(point: SweepPoint, result: PointResult, **more: str) -> PointResult:
    """Return the result as of this point; `original` and a point of the same scene share one."""
    kept = {name: value for name, value in result.as_json().items() if name != VIEW}
    return PointResult(**{**kept, "varied": dict(point.varied), "design": point.design, **more})
