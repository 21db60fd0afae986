"""A run directory while a process works in it: locked, interruptible, its end in the manifest."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.runs.destination import locked
from cranktopo.runs.directories import RunStore
from cranktopo.runs.kind import resume_command


@contextmanager
def interruptible() -> Iterator[Callable[[], None]]:
    """A block in which Ctrl-C raises KeyboardInterrupt at once and again at each call of what it yields.

    So does SIGTERM, where it raises KeyboardInterrupt outside the block: batch systems and containers end
    programs with it.

    Python drops a KeyboardInterrupt that is raised inside a callback of compiled code, a destructor or a
    listener: it prints a warning at most, and the work goes on. Long work therefore calls the yielded
    function between its steps. Blocks may be nested. Outside the main thread, and where the signal is
    ignored, nothing is changed.
    """
    pressed = False
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    watched = {number: handler for number, handler in before.items() if callable(handler)}

    def remember(number: int, frame: FrameType | None) -> None:
        nonlocal pressed
        pressed = True
        watched[signal.Signals(number)](number, frame)

    def check() -> None:
        if pressed:
            raise KeyboardInterrupt

    if threading.current_thread() is not threading.main_thread():
        yield check
        return
    for number in watched:
        signal.signal(number, remember)
    try:
        yield check
        check()
    finally:
        for number, handler in watched.items():
            signal.signal(number, handler)


@contextmanager
def working_in(run: RunStore, kept: str) -> Iterator[Callable[[], None]]:
    """Lock a run and record its end; yields what raises KeyboardInterrupt where Ctrl-C was pressed.

    `kept` says what an interruption leaves, for the message.

    Raises:
        CranktopoError: what failed in the block, or interruption (exit code 130).
    """
    with locked(run.path):
        try:
            with interruptible() as check:
                yield check
            run.set_status("done")
        except (KeyboardInterrupt, Exception) as error:
            if not _is_interruption(error):
                run.set_status("failed")
                run.log(f"failed: {error}")
                raise
            run.set_status("interrupted")
            run.log("interrupted")
            raise CranktopoError(
                f"interrupted; {kept} in {run.path}.",
                hint=f"Continue with: {resume_command(run)}",
                code=ExitCode.INTERRUPTED,
            ) from None


def _is_interruption(error: BaseException) -> bool:
    if isinstance(error, CranktopoError):
        return error.code == ExitCode.INTERRUPTED
    return isinstance(error, KeyboardInterrupt)
