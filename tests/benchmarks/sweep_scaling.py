"""Sweeps on 1 to 1000 workers, by a model and by replay: python -m tests.benchmarks.sweep_scaling.

A small sweep of evaluations is recorded. Its durations, scaled to a mean, are then slept through by the
threads of one worker process under a Dask scheduler of its own; results are as large as those of points. The
model knows three things that were measured: how long scheduler, client and the worker's loop need for a task
(empty tasks on 100 threads), what a lone worker loses between two tasks (one thread), and the durations.
"""

from __future__ import annotations

import heapq
import itertools
import random
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cranktopo import sweep

RESULT_LETTERS = 13_000
"""Of a point's result, nearly all of it the picture of its web."""
CASES = (
    (1, 1.0, 12),
    (10, 1.0, 120),
    (100, 1.0, 1000),
    (100, 0.1, 3000),
    (1000, 1.0, 5000),
    (1000, 4.0, 5000),
)
"""Workers, mean duration of a point in s, points."""
_COLUMNS = (
    "workers",
    "point, s",
    "points",
    "model, s",
    "replay, s",
    "points per s",
    "workers busy, %",
    "ms for a task",
    "ms between two",
)


@dataclass(frozen=True)
class Rates:
    """Measured times beside a task's own, s.

    Attributes:
        serial: of whatever takes tasks one after the other: scheduler, client, loop of the worker process.
        gap: between the tasks of a lone worker, `serial` among it.
    """

    serial: float
    gap: float


def modelled_s(durations: Sequence[float], workers: int, rates: Rates) -> float:
    """Time of a sweep: each point waits for a worker, then for its turn, then for the way to the worker."""
    free, turn = [0.0] * workers, 0.0
    for duration in durations:
        turn = max(heapq.heappop(free), turn) + rates.serial
        heapq.heappush(free, turn + max(rates.gap - rates.serial, 0.0) + duration)
    return max(free)


def replayed(number: int, seconds: float) -> dict[str, Any]:
    """A point that takes its time and tells as much as one does."""
    time.sleep(seconds)
    return {"number": number, "view": "x" * RESULT_LETTERS}


@contextmanager
def cluster(threads: int) -> Iterator[Any]:
    """A client of a scheduler and a worker with so many threads, each a process of its own."""
    from distributed import Client

    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        port = taken.getsockname()[1]
    address, dask = f"tcp://127.0.0.1:{port}", [sys.executable, "-m", "dask"]
    place, threaded = ["--host", "127.0.0.1", "--no-dashboard"], ["--nthreads", str(threads)]
    commands = [
        [*dask, "scheduler", "--port", str(port), *place],
        [*dask, "worker", address, "--no-nanny", "--memory-limit", "0", *threaded, *place],
    ]
    with tempfile.TemporaryDirectory() as folder:
        running = [subprocess.Popen(line, cwd=folder, stderr=subprocess.DEVNULL) for line in commands]
        try:
            with Client(address, timeout=30, set_as_default=False) as client:
                client.wait_for_workers(1, timeout=30)
                replay_s(client, [0.0] * 50)  # so that all is loaded
                yield client
        finally:
            for process in running:
                process.kill()
                process.wait()


def replay_s(client: Any, durations: Sequence[float]) -> float:
    """Time of a cluster for points of these durations, submitted and gathered as a sweep does."""
    from distributed import as_completed

    began = time.perf_counter()
    futures = client.map(replayed, range(len(durations)), durations, pure=False, batch_size=500)
    for future, _ in as_completed(futures, loop=client.loop, with_results=True):
        future.release()
    return time.perf_counter() - began


def measured_rates() -> Rates:
    """By empty tasks: on 100 threads the whole is as slow as its slowest part, on one nothing overlaps."""
    with cluster(100) as client:
        serial = replay_s(client, [0.0] * 3000) / 3000
    with cluster(1) as client:
        gap = replay_s(client, [0.0] * 1000) / 1000
    return Rates(serial, gap)


def recorded_s() -> list[float]:
    """Durations of 12 evaluations of different webs, as a sweep on this machine records them."""
    vary = {"web.width_mm": "50:60:4", "web.thickness_mm": "16:22:3"}
    with tempfile.TemporaryDirectory() as folder:
        frame = sweep("mikron-iiic-plain", vary, element_size_mm=9.0, out=Path(folder) / "run")
    return [float(seconds) for seconds in frame["seconds"]]


def drawn(recorded: Sequence[float], mean_s: float, points: int) -> list[float]:
    """So many of the recorded durations in a random order, scaled to a mean."""
    scale, draw = mean_s * len(recorded) / sum(recorded), random.Random(7)
    found = [scale * seconds for seconds in itertools.islice(itertools.cycle(recorded), points)]
    draw.shuffle(found)
    return found


def main() -> None:
    """Print a row for each case, and what was measured for the model."""
    recorded, rates = recorded_s(), measured_rates()
    print(f"evaluations: {min(recorded):.1f} to {max(recorded):.1f} s", file=sys.stderr)
    print(f"| {' | '.join(_COLUMNS)} |\n|{'---|' * len(_COLUMNS)}")
    for workers, mean_s, points in CASES:
        durations = drawn(recorded, mean_s, points)
        with cluster(workers) as client:
            found = replay_s(client, durations)
        model, busy = modelled_s(durations, workers, rates), 100 * sum(durations) / workers / found
        cells = (workers, f"{mean_s:g}", points, f"{model:.1f}", f"{found:.1f}", f"{points / found:.0f}")
        own = (f"{busy:.0f}", f"{1000 * rates.serial:.2f}", f"{1000 * rates.gap:.1f}")
        print(f"| {' | '.join(map(str, (*cells, *own)))} |", flush=True)


if __name__ == "__main__":
    main()
