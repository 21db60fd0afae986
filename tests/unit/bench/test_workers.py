"""Processes that answer: one that is closed stays closed."""

from __future__ import annotations

import asyncio
import gc
from concurrent.futures import ThreadPoolExecutor
from unittest.mock import Mock

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import design_text
from cranktopo.design.toml_text import parse_toml
from cranktopo.tasks.bench import workers
from cranktopo.tasks.bench.workers import AbandonedError, Worker


def test_a_question_that_waits_at_the_end_starts_no_other_process() -> None:
    """The bench did not end before a second process had answered what nobody wanted any more."""
    worker = Worker()
    data = parse_toml(design_text("mikron-iiic-plain"), "own")

    async def end() -> None:
        waiting = asyncio.ensure_future(worker.ask("settled.settled_stiffness", data))
        while worker._pool is None or not worker._pool._processes:
            await asyncio.sleep(0.01)
        worker.close()
        with pytest.raises(CranktopoError):
            await waiting
        assert worker._pool is None, "no other was started"

    with ThreadPoolExecutor(1) as pool:  # the thread of a browser's tests has a loop that runs
        pool.submit(asyncio.run, end()).result()


def test_the_background_leaves_the_cores_and_what_was_loaded_is_not_looked_through(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A drag waited for the coarse cells beside it, and for Python to look through all that was imported."""
    steps: list[object] = []
    monkeypatch.setattr(workers.os, "nice", steps.append)
    monkeypatch.setattr(workers.signal, "signal", lambda *_: None)
    monkeypatch.setattr(workers.multiprocessing, "parent_process", Mock())
    monkeypatch.setattr(workers.threading, "Thread", Mock())  # else the process ends with its parent
    for background in (False, True):
        workers._begin(background)
    assert steps == [19], "the least there is"
    monkeypatch.setattr(workers, "_answered", set())
    before = gc.get_freeze_count()
    data = parse_toml(design_text("mikron-iiic-plain"), "own")
    workers._answer("live.violated_rules_of", data)
    assert gc.get_freeze_count() > before
    gc.unfreeze()
    workers._answer("live.violated_rules_of", data)
    assert gc.get_freeze_count() == 0, "once is enough"


@pytest.mark.slow
def test_what_nobody_wants_is_given_up_and_the_process_goes_on() -> None:
    """A release while the design before settled waited until that had, for seconds."""
    worker = Worker()
    data = parse_toml(design_text("mikron-iiic-plain"), "own")

    async def talk() -> None:
        first = await worker.ask("settled.settled_stiffness", data)
        assert worker._pool is not None
        (before,) = worker._pool._processes
        given_up = asyncio.ensure_future(worker.ask("settled.settled_stiffness", data))
        await asyncio.sleep(0.3)
        worker.abandon()
        with pytest.raises(AbandonedError):
            await given_up
        assert not issubclass(AbandonedError, CranktopoError), "no answer is made of it"
        worker.abandon()  # it is idle: nothing happens
        again = await worker.ask("settled.settled_stiffness", data)
        (after,) = worker._pool._processes
        assert after == before, "the same process"
        assert again["gauges"] == first["gauges"]
        worker.close()

    with ThreadPoolExecutor(1) as pool:
        pool.submit(asyncio.run, talk()).result()
