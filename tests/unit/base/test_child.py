"""Work in a process of its own: results and errors come back, and its end in any other way is one line."""

from __future__ import annotations

import logging
import os
import signal
import subprocess
import sys
import time
from itertools import count
from pathlib import Path
from types import SimpleNamespace

import pytest

from cranktopo.base import child
from cranktopo.base.child import in_child, tell_read
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import note


def shouted(text: str) -> str:
    os.write(1, b"what a library prints past Python")
    note(f"read {text}")
    return text.upper() * 100_000


def refused(text: str) -> None:
    raise CranktopoError(f"{text}: no.", hint="Ask again.", code=ExitCode.SOLVER)


def defective(text: str) -> None:
    raise ZeroDivisionError(text)


def killed(number: int) -> None:
    os.kill(os.getpid(), number)


def written(file: Path) -> bool:
    return file.exists() and file.read_text() != ""


def endless(file: str, is_read: bool) -> None:
    if is_read:
        tell_read()
    Path(file).write_text(str(os.getpid()))
    time.sleep(600)


def test_results_notes_and_errors_come_back(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO, logger="cranktopo.notes")
    assert in_child("'x'", shouted, "abc") == "ABC" * 100_000
    assert caplog.messages == ["read abc"]
    with pytest.raises(CranktopoError, match=r"x: no\. Ask again\.") as raised:
        in_child("'x'", refused, "x")
    assert raised.value.code == ExitCode.SOLVER
    with pytest.raises(ZeroDivisionError) as defect:
        in_child("'x'", defective, "x")
    assert "in defective" in defect.value.__notes__[0]


@pytest.mark.parametrize("number", [signal.SIGSEGV, signal.SIGKILL, signal.SIGABRT])
def test_a_crash_is_one_line(number: signal.Signals) -> None:
    with pytest.raises(CranktopoError, match=rf"'x\.step': the CAD kernel crashed on it \({number.name}\)"):
        in_child("'x.step'", killed, int(number))


@pytest.mark.parametrize("is_read", [False, True])
def test_what_never_ends_is_ended(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture, is_read: bool
) -> None:
    """Only the limit of what it is doing counts; the clock goes on once the child is at work."""
    caplog.set_level(logging.INFO, logger="cranktopo.notes")
    limits = {"_TELL_S": 0.05, "_READING_S": 1000 if is_read else 60, "_WORKING_S": 60 if is_read else 1000}
    for name, seconds in limits.items():
        monkeypatch.setattr(child, name, seconds)
    pid, asked = tmp_path / "pid", count()
    clock = SimpleNamespace(monotonic=lambda: 62.0 if written(pid) and next(asked) > 1 else 1.0)
    monkeypatch.setattr(child, "time", clock)
    clock.clock_gettime = lambda _: 61.0
    with pytest.raises(CranktopoError, match="has not come to an end with it in 61 s") as raised:
        in_child("'x.step'", endless, str(pid), is_read)
    assert raised.value.code == ExitCode.INVALID_INPUT
    assert caplog.messages[0] == "'x.step': the CAD kernel has been at work on it for 0 s"
    with pytest.raises(ProcessLookupError):
        os.kill(int(pid.read_text()), 0)


def test_waiting_for_a_processor_is_not_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """On a busy machine a sound file was called damaged after a minute; without progress all ends at last."""
    for name, seconds in {"_TELL_S": 0.05, "_READING_S": 60, "_WORKING_S": 60}.items():
        monkeypatch.setattr(child, name, seconds)
    pid, asked = tmp_path / "pid", count()
    clock = SimpleNamespace(monotonic=lambda: 1.0 + 100.0 * next(asked) if written(pid) else 1.0)
    clock.clock_gettime = lambda _: 30.0
    monkeypatch.setattr(child, "time", clock)
    with pytest.raises(CranktopoError, match=r"has not come to an end with it in 1[23]00 s"):
        in_child("'x.step'", endless, str(pid), False)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="clocks of other processes are Linux's")
def test_the_clock_of_a_process_counts_its_work() -> None:
    busy = "import time\nwhile time.process_time() < 0.4: pass\nprint(flush=True)\ntime.sleep(60)"
    with subprocess.Popen([sys.executable, "-S", "-c", busy], stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        process.stdout.readline()
        assert 0.4 <= child.worked_s(process.pid, 1e3) < 2.0
        process.kill()


def test_it_ends_with_the_process_that_waits(tmp_path: Path) -> None:
    file = tmp_path / "pid"
    code = f"from tests.unit.base.test_child import *; in_child('x', endless, {str(file)!r}, True)"
    waiting = subprocess.Popen([sys.executable, "-c", code])
    end = time.monotonic() + 600
    while not written(file) and time.monotonic() < end:
        time.sleep(0.05)
    waiting.kill()
    waiting.wait()
    while Path(f"/proc/{file.read_text()}").exists() and time.monotonic() < end:
        time.sleep(0.05)
    assert time.monotonic() < end
