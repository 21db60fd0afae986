"""Work of native code on foreign files, in a process of its own: it may crash there, or never end.

A fresh interpreter, since a process that has threads cannot be copied safely. What the work notes, returns
or raises comes back; that it ended in another way is a CranktopoError.
"""

from __future__ import annotations

import os
import pickle
import select
import signal
import subprocess
import sys
import threading
import time
import traceback
from collections.abc import Callable
from typing import Any, TypeVar

from cranktopo.base.errors import CranktopoError
from cranktopo.base.notes import at_work, note, redirected

_R = TypeVar("_R")
_READING_S, _WORKING_S = 60.0, 1200.0
"""Seconds of a processor that a file may take to be read, and that the work with it may take after that."""
_IDLE = 20.0
"""Waiting time over these at which a process without progress is given up, on a busy machine too."""
_CPU_CLOCK = 2
_TELL_S = 25.0
_READ = b"r"
_START = "from cranktopo.base.child import serve; serve()"
_answers: list[int] = []
"""In a child: the number of the file that its answers go to."""


def in_child(what: str, function: Callable[..., _R], *arguments: object, by: str = "CAD kernel") -> _R:
    """Return what a function of a module returns for a foreign file, run in a process of its own.

    Args:
        what: the file in messages, such as `'web.step'`.
        by: what works on it, in messages.

    Raises:
        CranktopoError: as the function, or the process crashed or did not end in time.
    """
    ours, watched = os.pipe()  # the child ends when this process has gone
    try:
        process = started(_START, ours)
        with process:
            try:
                with at_work(f"{by}: {what}"):
                    answer = _answer(process, pickle.dumps((function, arguments)), what, by)
            finally:
                process.kill()
    finally:
        os.close(ours)
        os.close(watched)
    if not answer:
        raise _unreadable(what, f"the {by} crashed on it{_signal(process.returncode)}")
    return outcome(answer)


def started(code: str, watched: int, *arguments: str) -> subprocess.Popen[bytes]:
    """Return a fresh interpreter that runs a line of code, with pipes to its stdin and from its stdout.

    Args:
        watched: number of the file that ends the process when this one has gone, see `answering`.
    """
    return subprocess.Popen(
        [sys.executable, "-c", code, str(watched), *arguments],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        pass_fds=[watched],
        start_new_session=True,  # a terminal sends Ctrl-C to all; this process alone decides
        env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
    )


def outcome(answer: bytes) -> Any:
    """Tell the notes of a work that a child has done, and return what it returned; raises what it raised."""
    lines, result, error = pickle.loads(answer)
    for line in lines:
        note(line)
    if error is not None:
        raise error
    return result


def _answer(process: subprocess.Popen[bytes], task: bytes, what: str, by: str) -> bytes:
    """Return what a process answers, nothing where it crashed; tell from time to time that it is at work."""
    assert process.stdin is not None
    assert process.stdout is not None
    try:
        process.stdin.write(task)
        process.stdin.close()
    except BrokenPipeError:
        return b""
    answer, began, limit_s = b"", time.monotonic(), _READING_S
    while True:
        if select.select([process.stdout], [], [], _TELL_S)[0]:
            part = os.read(process.stdout.fileno(), 1 << 20)
            if not part:
                process.wait()
                return answer.removeprefix(_READ)
            limit_s, answer = _WORKING_S, answer + part
            continue
        seconds = time.monotonic() - began
        if min(worked_s(process.pid, seconds), seconds) > limit_s or seconds > _IDLE * limit_s:
            raise _unreadable(what, f"the {by} has not come to an end with it in {seconds:.0f} s")
        note(f"{what}: the {by} has been at work on it for {seconds:.0f} s")


def worked_s(process: int, otherwise_s: float) -> float:
    """Return the processor time of a process, s: waiting alone is no sign of a damaged file.

    By the process's clock of Linux (`man 3 clock_getcpuclockid`); elsewhere another value.
    """
    if not sys.platform.startswith("linux"):
        return otherwise_s
    try:
        return time.clock_gettime((~process << 3) | _CPU_CLOCK)
    except OSError:  # it has ended
        return otherwise_s


def _unreadable(what: str, why: str) -> CranktopoError:
    return CranktopoError(
        f"{what}: {why}.", hint="The file is damaged, or its solid is: repair it in CAD and export it again."
    )


def _signal(code: int | None) -> str:
    return f" ({signal.Signals(-code).name})" if code is not None and code < 0 else ""


def tell_read() -> None:
    """Tell the process that waits, once, that the file is read and long work begins; nothing elsewhere."""
    while _answers:
        os.write(_answers.pop(), _READ)


def serve() -> None:
    """Do the work that stdin describes and answer on stdout."""
    answers = answering()
    function, arguments = pickle.load(sys.stdin.buffer)
    _answers.append(answers)
    with open(answers, "wb") as file:
        file.write(answer_of(function, arguments))
    os._exit(0)


def answering() -> int:
    """Return the number of the file for answers: native code prints to stdout, so it is put aside.

    The process ends from now on when the one that started it has gone.
    """
    watched, answers = int(sys.argv[1]), os.dup(1)
    os.dup2(2, 1)
    threading.Thread(target=_end_with, args=(watched,), daemon=True).start()
    return answers


def answer_of(function: Callable[..., object], arguments: tuple[object, ...]) -> bytes:
    """Return what a function notes, and returns or raises, for `outcome` in another process."""
    lines: list[str] = []
    result: Any = None
    error: Exception | None = None
    with redirected(lines.append):
        try:
            result = function(*arguments)
        except Exception as found:
            found.add_note("".join(traceback.format_exception(found)))
            error = found.with_traceback(None)
    return pickle.dumps((lines, result, error))


def _end_with(watched: int) -> None:
    os.read(watched, 1)
    os._exit(1)
