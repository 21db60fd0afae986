"""Processes that answer: each does one kind of work, always for the newest question."""

from __future__ import annotations

import asyncio
import gc
import importlib
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import Any

from cranktopo.base.errors import CranktopoError

_GIVE_UP = signal.SIGUSR1
_NICE = 19
"""Of processes in the background, which leave the cores to the drag."""


class AbandonedError(Exception):
    """Nobody wants the answer any more: no error of the design, so that no answer is made of it."""


class Worker:
    """One process that computes; where it was killed, the next question starts another."""

    def __init__(self, *, background: bool = False) -> None:
        self._background = background
        self._pool: ProcessPoolExecutor | None = None
        self._closed = False

    async def ask(self, function: str, *arguments: Any) -> Any:
        """Return what a function says of a design; raises CranktopoError as it, or if its process dies.

        What still waits when the process is closed raises one, too: another process would keep the bench.

        Args:
            function: module of this task and name, such as `live.live_numbers`: the server does not load it.
        """
        for _ in range(2):
            if self._closed:
                break
            pool = self._pool = self._pool or self._started()
            try:
                return await asyncio.get_running_loop().run_in_executor(pool, _answer, function, *arguments)
            except BrokenProcessPool:
                if self._pool is pool:
                    self._pool = None
        raise CranktopoError("The computing process ended twice.", hint="Change the design slightly.")

    def abandon(self) -> None:
        """Have the process give up what it is at, which raises AbandonedError for whoever asked.

        It goes on where it has not answered such a question before: it may be loading libraries.
        """
        for process in list(((self._pool and self._pool._processes) or {}).values()):
            if process.is_alive() and process.pid is not None:
                os.kill(process.pid, _GIVE_UP)

    def close(self) -> None:
        """End the process, whatever it is at, for good."""
        pool, self._pool, self._closed = self._pool, None, True
        if pool is not None:
            processes = list((pool._processes or {}).values())
            pool.shutdown(wait=False, cancel_futures=True)
            for process in processes:
                process.kill()

    def _started(self) -> ProcessPoolExecutor:
        context = multiprocessing.get_context("spawn")
        return ProcessPoolExecutor(1, context, initializer=_begin, initargs=(self._background,))


_answered: set[str] = set()
"""Functions that this process has called before."""
_at: list[str] = []
"""The function that it is at, if it may be given up."""


def _answer(function: str, *arguments: Any) -> Any:
    module, _, name = function.rpartition(".")
    answer = getattr(importlib.import_module(f"{__package__}.{module}"), name)
    _at.extend({function} & _answered)
    try:
        found = answer(*arguments)
    finally:
        _at.clear()
    if function not in _answered:
        _answered.add(function)
        gc.freeze()  # what it loaded stays: to look through it again and again takes longer than an answer
    return found


def _give_up(number: int, frame: object) -> None:
    if _at:
        _at.clear()
        raise AbandonedError("nobody wants this answer any more.")


def _begin(background: bool) -> None:
    """Leave Ctrl-C to the server, and end with it however it ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(_GIVE_UP, _give_up)
    if background:
        os.nice(_NICE)
    parent = multiprocessing.parent_process()
    assert parent is not None
    threading.Thread(target=_end_after, args=(parent.join,), daemon=True).start()


def _end_after(wait: Callable[[], None]) -> None:
    wait()
    os._exit(1)


class Newest:
    """Questions of which only the newest is answered, one after another."""

    def __init__(self, answer: Callable[[Any], Any]) -> None:
        self._answer = answer
        self._waiting: list[Any] = []
        self._task: asyncio.Task[None] | None = None

    @property
    def busy(self) -> bool:
        """True while a question is being answered."""
        return self._task is not None and not self._task.done()

    def put(self, question: Any) -> Any:
        """Ask; return the question that still waited and is forgotten, None if there was none."""
        forgotten = self._waiting.pop() if self._waiting else None
        self._waiting.append(question)
        if not self.busy:
            self._task = asyncio.get_running_loop().create_task(self._work())
        return forgotten

    async def _work(self) -> None:
        while self._waiting:
            await self._answer(self._waiting.pop())
