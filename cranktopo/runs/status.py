"""A run directory while a process works in it: locked, and its manifest says how it ended."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.runs.directories import RunStore
from cranktopo.runs.interruption import interruptible
from cranktopo.runs.kind import resume_command
from cranktopo.runs.lock import locked


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
