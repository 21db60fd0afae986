"""Processes that answer: one that is closed stays closed."""

from __future__ import annotations

import asyncio
from concurrent.futures import ThreadPoolExecutor

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import design_text
from cranktopo.design.toml_text import parse_toml
from cranktopo.tasks.bench.workers import Worker


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
