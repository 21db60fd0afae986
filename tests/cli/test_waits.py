"""Waits of a long command: a line tells what runs, and none comes where the work tells its own."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from typing import Any

import pytest

from cranktopo.base.notes import at_work, running
from cranktopo.cli.verbosity import _notes_on_stderr, _Stderr


class _Clock:
    """An event that is never set before some waits have passed, each as long as was asked for."""

    def __init__(self, waits: int, between: Callable[[int], Any] = lambda _: None) -> None:
        self.now, self.waited, self._waits, self._between = 100.0, 0, waits, between

    def wait(self, seconds: float) -> bool:
        self.now += seconds
        self.waited += 1
        self._between(self.waited)
        return self.waited > self._waits


def _told(clock: _Clock, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> list[str]:
    monkeypatch.setattr("cranktopo.cli.verbosity.time.monotonic", lambda: clock.now)
    handler = _Stderr()
    with at_work("mesh"), at_work("solving 3 columns"):
        handler.tell_waits("shape", clock, 3.0)  # type: ignore[arg-type]
    return capsys.readouterr().err.splitlines()


def test_a_wait_is_told_with_what_runs(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    told = _told(_Clock(4), monkeypatch, capsys)
    assert told == [f"solving 3 columns: {seconds} s so far" for seconds in (3, 6, 12, 24)]
    assert running() == ""


def test_work_that_tells_its_own_lines_has_few_others(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    handler: list[_Stderr] = []
    record = logging.LogRecord("cranktopo", logging.INFO, "", 0, "step", (), None)
    monkeypatch.setattr(_Stderr, "__init__", lambda self: (handler.append(self), _init(self))[1])
    clock = _Clock(5, lambda _: handler[0].emit(record))
    assert _told(clock, monkeypatch, capsys) == 6 * ["step"]


def _init(handler: _Stderr) -> None:
    logging.Handler.__init__(handler)
    handler.told = time.monotonic()


def test_the_lines_end_with_the_command(capsys: pytest.CaptureFixture[str]) -> None:
    with _notes_on_stderr(quiet_s=0.01):
        time.sleep(0.2)
    assert capsys.readouterr().err.startswith("at work: 0 s so far\n")
    time.sleep(0.1)
    assert capsys.readouterr().err == ""
