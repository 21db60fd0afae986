"""Lines that long work tells while it goes on: the logger `cranktopo.notes`, shown by the command line.

A script hears them with `logging.basicConfig(level="INFO", format="%(message)s")`.
"""

from __future__ import annotations

import logging
import re
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from contextvars import ContextVar

_LOG = logging.getLogger("cranktopo.notes")
_listener: ContextVar[Callable[[str], None] | None] = ContextVar("listener", default=None)
"""Function that hears the notes in place of the logger."""
_pace_listener: ContextVar[Callable[[str], None] | None] = ContextVar("pace_listener", default=None)
"""Function that hears how far silent work is."""


def note(line: str) -> None:
    """Tell one line about the work."""
    (_listener.get() or _LOG.info)(line)


def warn(line: str) -> None:
    """Tell that a result may be wrong or is not what was meant: heard where notes are not wanted, too."""
    (_listener.get() or _LOG.warning)(f"warning: {line}")


def detail(line: str) -> None:
    """Tell one line that only those want to read who asked for more."""
    if _listener.get() is None:
        _LOG.debug(line)


@contextmanager
def redirected(listener: Callable[[str], None]) -> Iterator[None]:
    """Bring the notes of a part of the work to another listener."""
    token = _listener.set(listener)
    try:
        yield
    finally:
        _listener.reset(token)


@contextmanager
def silent() -> Iterator[None]:
    """Keep the notes of a part of the work to itself, but for the lines of its pace."""
    token = _pace_listener.set(_pace_listener.get() or _listener.get() or _LOG.info)
    try:
        with redirected(lambda _: None):
            yield
    finally:
        _pace_listener.reset(token)


def indented() -> AbstractContextManager[None]:
    """Tell the notes of a part of the work as those of a part."""
    outer = _listener.get() or _LOG.info
    return redirected(lambda line: outer(f"  {line}"))


QUIET_S = 3.0
"""Seconds that work may take without a line about how far it is."""
_BAR = 12
_at_work: list[str] = []
"""Parts of the work that run now, in any thread, the newest last."""


@contextmanager
def at_work(part: str) -> Iterator[None]:
    """Name a part of the work while it runs, for whoever waits for it."""
    _at_work.append(part)
    try:
        yield
    finally:
        _at_work.remove(part)


def running() -> str:
    """Return the newest part of the work that runs now; empty where none has a name."""
    return next(reversed(_at_work.copy()), "")


class Pace:
    """Lines of work in parts: a bar, which part of how many, and the time left by the pace so far.

    Parts that follow each other fast have a line together, so that short work has none.
    """

    def __init__(self, work: str, parts: int, *, at_most: bool = False, quiet_s: float = QUIET_S) -> None:
        self._work, self._parts, self._done, self._quiet_s = work, max(parts, 1), 0, quiet_s
        self._most = "at most " if at_most else ""
        self._began = self._last_note_s = time.perf_counter()

    def begin(self, part: str = "", parts: int | None = None) -> None:
        """Tell that the next part begins, unless the last line is new.

        Args:
            part: its name.
            parts: how many there are, where that has changed.
        """
        self._parts = self._parts if parts is None else max(parts, 1)
        now = time.perf_counter()
        if now - self._last_note_s >= self._quiet_s:
            self._last_note_s = now
            line = ", ".join([f"{self._where()}{part and f', {part}'}", *self._left(now)])
            (_pace_listener.get() or note)(line)
        self._done += 1

    def _where(self) -> str:
        parts = max(self._parts, self._done + 1)
        return f"{self._work}: {bar(self._done, self._parts)} {self._done + 1} of {self._most}{parts}"

    def _left(self, now: float) -> list[str]:
        left = self._parts - self._done
        if not self._done or left <= 0:
            return []
        return [f"{self._most or 'about '}{duration_text(left * (now - self._began) / self._done)} left"]


def bar(done: float, parts: float) -> str:
    """Return a bar that shows how much of the work is done."""
    full = int(min(_BAR * done // parts, _BAR))
    return f"[{'#' * full}{'-' * (_BAR - full)}]"


_PACE = re.compile(r"\[[#-]+\] (\d+) of (?:at most )?(\d+)(?:,.*?((?:about|at most) [\dhmins ]+) left)?")
_BUDGET = re.compile(r"\[[#-]+\] (\d+) of ([\d.]+) s:")


def pace_of(line: str) -> tuple[float, str] | None:
    """Return the share that is done and the time left by a line with a bar; None for any other line.

    The line counts parts, as those of a `Pace` do, or the seconds of a budget.
    """
    if budget := _BUDGET.search(line):
        spent_s, budget_s = map(float, budget.groups())
        return min(spent_s / budget_s, 1.0), f"about {duration_text(max(budget_s - spent_s, 0.0))}"
    found = _PACE.search(line)
    return found and ((int(found[1]) - 1) / int(found[2]), found[3] or "")


def duration_text(seconds: float) -> str:
    """Return a time for people: `40 s`, `12 min`, `3 h 20 min`."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 90 else f"{minutes // 60} h {minutes % 60} min"
