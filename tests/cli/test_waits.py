"""Waits of a long command: a line tells what runs, and none comes where the work tells its own."""

from __future__ import annotations

import ctypes
import logging
import re
import time
from collections.abc import Callable
from typing import Any

import pytest

from cranktopo.base.notes import at_work, running
from cranktopo.cli.verbosity import _notes_on_stderr, _Stderr
from cranktopo.cli.watchdog_process import Watchdog


class _Clock:
    """An event that is never set before some waits have passed, each as long as was asked for."""

    def __init__(self, waits: int, between: Callable[[int], Any] = lambda _: None) -> None:
        self.held = 0.0
        self.now, self.waited, self._waits, self._between = 100.0, 0, waits, between

    def wait(self, seconds: float) -> bool:
        self.now, self.held = self.now + seconds + self.held, 0.0
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
    told = _told(_Clock(9), monkeypatch, capsys)
    times = ("3 s", "6 s", "12 s", "24 s", "48 s", "72 s", "1 min 36 s", "2 min 0 s", "2 min 24 s")
    assert told == [f"solving 3 columns: {seconds} so far" for seconds in times]
    assert running() == ""


def test_a_wait_in_which_no_thread_ran_is_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    clock = _Clock(2)
    clock.held = 30.0
    assert _told(clock, monkeypatch, capsys) == [
        f"solving 3 columns: {seconds} s so far" for seconds in (33, 57)
    ]


def test_work_that_tells_its_own_lines_has_few_others(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    handler: list[_Stderr] = []
    record = logging.LogRecord("cranktopo", logging.INFO, "", 0, "step", (), None)

    def begin(self: _Stderr) -> None:
        logging.Handler.__init__(self)
        self.last_record_s = time.monotonic()
        handler.append(self)

    monkeypatch.setattr(_Stderr, "__init__", begin)
    clock = _Clock(5, lambda _: handler[0].emit(record))
    assert _told(clock, monkeypatch, capsys) == 6 * ["step"]


def test_the_lines_end_with_the_command(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("cranktopo.cli.verbosity._QUIET_S", 0.01)
    with _notes_on_stderr():
        told, end = "", time.monotonic() + 600
        while not told and time.monotonic() < end:
            time.sleep(0.01)
            told = capsys.readouterr().err
    assert re.match(r"at work: \d+ s so far\n", told)
    capsys.readouterr()
    time.sleep(0.1)
    assert capsys.readouterr().err == ""


def test_native_code_that_stops_all_threads_is_told_too(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("cranktopo.cli.verbosity._QUIET_S", 3600.0)  # the other lines
    monkeypatch.setattr("cranktopo.cli.verbosity._LONGEST_S", 1.0)
    locked = ctypes.PyDLL(None)  # unlike CDLL it keeps the interpreter's lock
    with _notes_on_stderr():
        time.sleep(0.6)  # the process that speaks then has started
        with at_work("mesh"):
            time.sleep(0.2)
            locked.usleep(1_500_000)
    told = capfd.readouterr().err.splitlines()
    assert 1 <= len(told) <= 2
    assert all(re.fullmatch(r"mesh: [12] s so far", line) for line in told)


def test_a_watchdog_tells_a_long_wait_as_the_command_does() -> None:
    """`2583 s so far` stood between lines of `43 min so far`, which were the same for a minute."""
    watchdog = Watchdog(24.0)
    watchdog.hear("30.0 2583.0 mesh", 9000.0)
    assert watchdog.line(9006.0) == "mesh: 43 min 9 s so far\n"
    watchdog.hear("30.0 12005.0 mesh", 9030.0)
    assert watchdog.line(9036.0) == "mesh: 3 h 20 min 11 s so far\n"


def test_a_watchdog_is_quiet_while_beats_come() -> None:
    """A mesher that began 1 s after the last line; from 29 s on it holds the lock."""
    watchdog, told = Watchdog(24.0), list[str]()
    for second in range(1, 81):
        if second < 30:
            watchdog.hear(f"{second:.1f} {second - 1:.1f} mesh", 100.0 + second)
        told.append(watchdog.line(100.0 + second))
    assert {second: line for second, line in enumerate(told, 1) if line} == {
        second: f"mesh: {second - 1} s so far\n" for second in (35, 58)
    }
