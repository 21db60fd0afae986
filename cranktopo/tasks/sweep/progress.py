"""How far a sweep is, and how long it may still take."""

from __future__ import annotations

import time
from collections import Counter

from cranktopo.tasks.fea.evaluation import Info
from cranktopo.tasks.sweep.result import DONE

_EVERY_S = 5.0


class Progress:
    """Lines of progress, one every few seconds; time left by the pace since the start."""

    def __init__(self, points: int, kept: int, info: Info) -> None:
        self._points, self._done, self._info = points, kept, info
        self._ends: Counter[str] = Counter()
        self._told = time.perf_counter()
        self._first = 0.0
        if kept:
            info(f"{kept} of {points} points need no computing")

    def add(self, status: str) -> None:
        """Count the end of a point."""
        self._done += 1
        self._ends[status] += 1
        now = time.perf_counter()
        self._first = self._first or now
        if now - self._told >= _EVERY_S or self._done == self._points:
            self._told = now
            self._info(self._line(now))

    def _line(self, now: float) -> str:
        bad = [f"{count} {end}" for end, count in sorted(self._ends.items()) if end != DONE]
        return f"{', '.join([f'{self._done} of {self._points} points', *bad])}{self._time_left(now)}"

    def _time_left(self, now: float) -> str:
        """By the points that ended since the first one, which waited for the workers to start."""
        since = self._ends.total() - 1
        if since == 0 or self._done == self._points:
            return ""
        left = (self._points - self._done) * (now - self._first) / since
        return f", about {duration(left)} left"


def duration(seconds: float) -> str:
    """Return a time for people: `40 s`, `12 min`, `3 h 20 min`."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 90 else f"{minutes // 60} h {minutes % 60} min"
