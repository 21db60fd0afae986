"""One hostile case, run in this process: its exit code, and what must never happen."""

from __future__ import annotations

import contextlib
import io
import os
import signal
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from unittest.mock import patch

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError, ExitCode
from tests.hostile.commands import Case

LIMIT_S = 10.0
"""Seconds of the processor that a case may take; of the clock 30 times as many: others use the machine."""
# Where the work starts that a valid input would do: it ends there instead.
WORK = (
    "gmsh.initialize",
    "cranktopo.tasks.optimise.stage.build_problem",
    "cranktopo.tasks.bound.stage.bound_model",
    "cranktopo.runs.directories.new_manifest",
    "cranktopo.runs.directories.RunStore.resume",
)


class Hang(BaseException):
    """A case took longer than the limit."""


@dataclass(frozen=True)
class Outcome:
    """What a case ended in; `faults` is empty when it behaved."""

    code: int
    seconds: float
    stdout: str
    stderr: str
    faults: tuple[str, ...]


def run_case(case: Case, folder: Path) -> Outcome:
    """Run a case in an empty folder of its own."""
    case.lay_out(folder)
    before = _tree(folder)
    out, err = io.StringIO(), io.StringIO()
    began = time.perf_counter()
    code, faults = 1, []
    with _inside(folder), _limited(), contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            code = main(case.arguments)
        except Hang:
            faults.append(f"hangs: more than {LIMIT_S:g} s of the processor, or 30 times that")
        except BaseException as error:
            faults.append(f"raises {type(error).__name__}: {error}")
    if code not in set(ExitCode) or code == ExitCode.INTERNAL:
        faults.append(f"exit code {code}")
    if "Traceback" in out.getvalue() + err.getvalue():
        faults.append("shows a traceback")
    resumed = "--resume" in case.arguments  # says in the run's log why it ended
    if code != ExitCode.DONE and not resumed and _tree(folder) != before:
        faults.append(f"writes {sorted(set(_tree(folder)) - set(before))}")
    if code != ExitCode.DONE and not err.getvalue().strip():
        faults.append("says nothing")
    return Outcome(code, time.perf_counter() - began, out.getvalue(), err.getvalue(), tuple(faults))


def stubbed() -> contextlib.ExitStack:
    """Context in which no long work is done: it ends in a solver failure."""
    stack = contextlib.ExitStack()
    for target in WORK:
        stack.enter_context(patch(target, side_effect=CranktopoError("no work here.", code=ExitCode.SOLVER)))
    return stack


def _tree(folder: Path) -> dict[str, int]:
    """Names and sizes of everything below a folder; locks of run directories are no result."""
    paths = (path for path in folder.rglob("*") if path.name != ".lock")
    return {str(path.relative_to(folder)): path.lstat().st_size if path.is_file() else -1 for path in paths}


@contextlib.contextmanager
def _inside(folder: Path) -> Iterator[None]:
    before = Path.cwd()
    os.chdir(folder)
    logs = set(Path(tempfile.gettempdir()).glob("cranktopo-crash-*.log"))
    try:
        yield
    finally:
        os.chdir(before)
        for log in set(Path(tempfile.gettempdir()).glob("cranktopo-crash-*.log")) - logs:
            log.unlink(missing_ok=True)


@contextlib.contextmanager
def _limited() -> Iterator[None]:
    def stop(*_: object) -> None:
        raise Hang

    timers = {signal.SIGPROF: (signal.ITIMER_PROF, 1), signal.SIGALRM: (signal.ITIMER_REAL, 30)}
    before = {number: signal.signal(number, stop) for number in timers}
    for timer, times in timers.values():
        signal.setitimer(timer, times * LIMIT_S)
    try:
        yield
    finally:
        for timer, _ in timers.values():
            signal.setitimer(timer, 0)
        for number, handler in before.items():
            signal.signal(number, handler)
