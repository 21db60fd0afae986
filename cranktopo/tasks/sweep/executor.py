"""Jobs on Dask distributed: on this machine, or on a cluster that is there already."""

from __future__ import annotations

import atexit
import contextlib
import logging
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from cranktopo.base.errors import CranktopoError, packages_of
from cranktopo.base.notes import note
from cranktopo.tasks.sweep.job import Job, do_job, point_result
from cranktopo.tasks.sweep.result import FAILED, PointResult

_BATCH = 500
_RETRIES, _DEATHS = 2, 5
"""Further tries of a point after an error of the machine, and after the death of its worker."""
_FIRST_S, _RETURN_S = 10.0, 120.0
"""Seconds for which a scheduler is waited for: at the start, and when it was lost."""
_AFTER_S = 5.0
GONE_S = 30.0
"""Seconds for which workers of our own may all be gone before new ones are started."""
_LOOK_S = 0.5
_SETTINGS = {
    "distributed.scheduler.allowed-failures": _DEATHS,
    "distributed.admin.large-graph-warning-threshold": "1 GiB",
    # Pages of scheduler and workers, which every user of this machine could read.
    "distributed.scheduler.http.routes": [],
    "distributed.worker.http.routes": [],
    "distributed.nanny.pre-spawn-environ.DASK_LOGGING__DISTRIBUTED": "critical",
    # By default a worker gives back all memory that it frees, and waits for the pages of its next array.
    "distributed.nanny.pre-spawn-environ.MALLOC_TRIM_THRESHOLD_": None,
}
_Done = Callable[[Job, PointResult], None]


@dataclass(frozen=True)
class WorkerPool:
    """Processes here, each with so many cores for itself, or the address of a Dask scheduler instead."""

    workers: int = 1
    threads: int = 1
    scheduler: str | None = None


def check_packages() -> None:
    """Check that Dask, for jobs, and pandas with Parquet, for the table, can be loaded."""
    with packages_of("sweep"):
        for name in ("cryptography", "dask", "distributed", "pandas", "pyarrow"):
            import_module(name)


def check_scheduler(address: str) -> None:
    """Check, before anything is written, that a scheduler answers."""
    import distributed

    with _quiet(), _connected(distributed, address, _FIRST_S):
        pass


class _LostError(Exception):
    """The connection to the scheduler broke, or no worker of our own is left."""


def compute(
    jobs: Sequence[Job],
    engine: WorkerPool,
    done: _Done,
    enough: Callable[[], bool] = lambda: False,
) -> None:
    """Compute jobs, telling the end of each as it comes; once `enough` says so, the rest is left.

    A lost scheduler is waited for, workers of our own that are all lost are replaced.

    Raises:
        CranktopoError: no scheduler, or an output that cannot be written.
        KeyboardInterrupt: Ctrl-C; jobs that were told are finished.
    """
    left = {job.point.id: job for job in jobs}
    patience = _FIRST_S

    def finished(job: Job, result: PointResult) -> None:
        del left[job.point.id]
        done(job, result)

    while left and not enough():
        try:
            with _client(engine, patience) as client:
                _submit(client, list(left.values()), finished, enough, own=engine.scheduler is None)
        except _LostError:
            patience = _RETURN_S
            gone = f"the scheduler is lost; waiting up to {_RETURN_S:.0f} s for it to come back"
            note(gone if engine.scheduler else "all workers are gone; starting new ones")
            time.sleep(1.0)


def _submit(
    client: Any, jobs: Sequence[Job], finished: _Done, enough: Callable[[], bool], *, own: bool
) -> None:
    from distributed import KilledWorker, as_completed

    by_key = {f"cranktopo-{job.point.id}": job for job in jobs}
    futures = client.map(do_job, jobs, key=list(by_key), retries=_RETRIES, pure=False, batch_size=_BATCH)
    with _cancelling(client, futures, own=own):
        for future, result in as_completed(futures, loop=client.loop, with_results=True, raise_errors=False):
            job = by_key[future.key]
            if future.status not in ("finished", "error"):
                raise _LostError
            if future.status == "error":
                error = result[1]
                if isinstance(error, CranktopoError):
                    raise error
                reason = f"{type(error).__name__}: {error}"
                if isinstance(error, KilledWorker):
                    reason = f"its worker died more than {_DEATHS} times"
                result = point_result(job, FAILED, reason)
            finished(job, result)
            future.release()
            if enough():
                client.cancel(futures, force=True)
                return


@contextmanager
def _cancelling(client: Any, futures: Sequence[Any], *, own: bool) -> Iterator[None]:
    """Cancel what is left at the end, and all of it once workers of our own are gone.

    Dask starts a worker again that died, but not one whose start took too long; it would wait for ever.
    """
    over = threading.Event()
    watch = threading.Thread(target=_cancel_without_workers, args=(client, futures, over), daemon=True)
    if own:
        watch.start()
    try:
        yield
    except BaseException:
        with contextlib.suppress(Exception):
            client.cancel(futures, force=True)
        raise
    finally:
        over.set()


def _cancel_without_workers(client: Any, futures: Sequence[Any], over: threading.Event) -> None:
    seen = time.monotonic()
    while not over.wait(_LOOK_S):
        if client.scheduler_info().get("workers"):  # none is known before the first report or after the last
            seen = time.monotonic()
        elif time.monotonic() - seen > GONE_S:
            client.cancel(futures, force=True)
            return


@contextmanager
def _client(engine: WorkerPool, patience_s: float) -> Iterator[Any]:
    import dask
    import distributed

    with dask.config.set(_SETTINGS), _quiet(), contextlib.ExitStack() as stack:
        atexit.unregister(distributed.deploy.spec.close_clusters)
        atexit.register(_close_clusters)
        if engine.scheduler is None:
            # without a limit of memory, because the number of workers was chosen by it
            cluster = distributed.LocalCluster(
                n_workers=engine.workers,
                threads_per_worker=1,
                memory_limit=0,
                dashboard_address="127.0.0.1:0",
                scheduler_kwargs={"dashboard": False},
                security=distributed.Security.temporary(),  # else every user of this machine could run code
                silence_logs=logging.CRITICAL,
            )
            stack.enter_context(_closing(cluster))
            client = stack.enter_context(_closing(distributed.Client(cluster, set_as_default=False)))
            client.register_plugin(_pinning(distributed, engine))
        else:
            client = stack.enter_context(_connected(distributed, engine.scheduler, patience_s))
        known = engine.scheduler and "dashboard" in client.scheduler_info().get("services", {})
        dashboard = f", dashboard: {client.dashboard_link}" if known else ""
        note(f"scheduler: {client.scheduler.address}{dashboard}")
        yield client


def _close_clusters() -> None:
    """Close at the end of the process what was interrupted while it began; Dask would show why it cannot."""
    import distributed

    with _quiet(), contextlib.suppress(Exception):
        distributed.deploy.spec.close_clusters()


@contextmanager
def _quiet() -> Iterator[None]:
    """Silence what Dask logs of connections that break; what it means is told by the sweep."""
    names = "distributed", "distributed.client", "asyncio", "tornado.application"
    loggers = [logging.getLogger(name) for name in names]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)


def _pinning(distributed: Any, engine: WorkerPool) -> Any:
    """Return a plugin that gives every worker cores of its own; made here because Dask is loaded late."""

    class Pinned(distributed.WorkerPlugin):  # type: ignore[misc]
        name = "cranktopo-cores"

        def setup(self, worker: Any) -> None:
            """Take the cores; leave Ctrl-C, which a terminal sends to all, to the process that asked."""
            _pin(int(worker.name), engine.threads)
            if threading.current_thread() is threading.main_thread():
                signal.signal(signal.SIGINT, signal.SIG_IGN)

    return Pinned()


def _pin(number: int, threads: int) -> None:
    """Let this process run on the cores of worker `number` alone, where the system can do that."""
    if not hasattr(os, "sched_setaffinity"):
        return
    cores = sorted(os.sched_getaffinity(0))
    own = {cores[(number * threads + n) % len(cores)] for n in range(threads)}
    for thread in os.listdir("/proc/self/task"):
        with contextlib.suppress(OSError):  # it has ended meanwhile
            os.sched_setaffinity(int(thread), own)


@contextmanager
def _connected(distributed: Any, address: str, patience_s: float) -> Iterator[Any]:
    """Return a client of a scheduler that may still be coming up."""
    try:
        client = distributed.Client(address, timeout=patience_s, set_as_default=False)
    except (OSError, ValueError) as error:
        raise CranktopoError(
            f"--scheduler {address}: cannot be reached: {error}.",
            hint="Start one with 'dask scheduler', or leave --scheduler out; finished points are kept.",
        ) from None
    with _closing(client):
        yield client


@contextmanager
def _closing(part: Any) -> Iterator[Any]:
    """Return a client or a cluster that ends with the block; a worker in long work does not hold that up.

    Workers end with this process in any case, and what they leave is continued by the next one.
    """
    try:
        yield part
    finally:
        with contextlib.suppress(Exception):
            part.close(timeout=_AFTER_S)
