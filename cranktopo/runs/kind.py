"""Kinds of runs by the command that made them, and a run while a process works in it."""

from __future__ import annotations

import shlex
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any, Literal

from cranktopo.base.errors import CranktopoError, ExitCode, quoted
from cranktopo.base.files import read_json
from cranktopo.base.interruption import closed_by
from cranktopo.runs.destination import locked
from cranktopo.runs.directories import RunStore, delete_folder

RunKind = Literal["optimise", "iterate", "shape", "sweep", "each-web"]
"""Makers of runs: a density optimisation, the loop over many, a shape optimisation, a sweep, a shape
optimisation of every web of a shaft. All but the last are the names of commands."""
LOOP: RunKind = "iterate"
SHAPE: RunKind = "shape"
SWEEP: RunKind = "sweep"
EACH_WEB: RunKind = "each-web"
"""Kinds of runs, and the keys of their settings among the manifest's options."""
RESULT_FILES: dict[RunKind, str] = {
    "optimise": "metrics.json",
    "iterate": "iterate.json",
    "shape": "shape.json",
    "sweep": "sweep.json",
    "each-web": "each-web.json",
}
"""Name of the file that a run of each kind writes last."""
_TAKEN = ("web.stl", "web.step", "web.toml", "history.csv")
"""Names of the files with the web of a run and its course, which other commands take."""


def kind_of(run: RunStore) -> RunKind:
    """Return the command that made a run; raises CranktopoError when its manifest cannot be used."""
    options = run.manifest().options
    return next((kind for kind in (LOOP, SHAPE, SWEEP, EACH_WEB) if kind in options), "optimise")


def read_result(run: RunStore) -> dict[str, Any] | None:
    """Return what a run reached, None before its end; raises CranktopoError when a file cannot be used."""
    return read_json(result_file(run)) if has_result(run) else None


def has_result(run: RunStore) -> bool:
    """Tell whether a run has the file with what it reached; raises CranktopoError."""
    return (run.path / RESULT_FILES[kind_of(run)]).is_file()


@contextmanager
def reading_results(run: RunStore) -> Iterator[None]:
    """Show stored results in the block: what they lack is damage, a CranktopoError, and no defect here."""
    try:
        yield
    except (KeyError, TypeError, IndexError, AttributeError, ValueError) as error:
        raise CranktopoError(
            f"run '{run.path}': its results are damaged ({type(error).__name__}: {quoted(str(error))}).",
            hint="Start a new run.",
        ) from error


def resume_command(run: RunStore) -> str:
    """Return the command line that continues a run; raises CranktopoError for an unusable manifest."""
    return shlex.join(["cranktopo", _command_of(kind_of(run)), "--resume", str(run.path)])


def _command_of(kind: RunKind) -> str:
    return SHAPE if kind == EACH_WEB else kind


def require_kind(run: RunStore, required: RunKind) -> None:
    """Check that the `required` command made a run; raises CranktopoError."""
    found = kind_of(run)
    if found != required:
        show = shlex.join(["cranktopo", "runs", "show", str(run.path)])
        raise CranktopoError(
            f"run '{run.path}': was made by `cranktopo {found}`; this needs one of `cranktopo {required}`.",
            hint=f"See what it holds: {show}; or continue it: {resume_command(run)}",
        )


def result_file(run: RunStore) -> Path:
    """Return the file with what a run reached; raises CranktopoError before its end, or if it was changed."""
    name = RESULT_FILES[kind_of(run)]
    if not has_result(run):
        raise CranktopoError(
            f"run '{run.path}': not finished, {name} is missing.",
            hint=f"Continue it with: {resume_command(run)}",
        )
    return run.unchanged(name)


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

    `kept` says what an interruption leaves, for the message. Input that is refused before anything is found
    leaves nothing, nor does a search that ends without a result, so that the command can be given again.

    Raises:
        CranktopoError: what failed in the block, or interruption (exit code 130).
    """

    def interrupted() -> CranktopoError:
        run.set_status("interrupted")
        run.log("interrupted")
        return CranktopoError(
            f"interrupted; {kept} in {run.path}.",
            hint=f"Continue with: {resume_command(run)}",
            code=ExitCode.INTERRUPTED,
        )

    with locked(run.path):
        try:
            with closed_by(interrupted), interruptible() as check:
                yield check
            run.set_done([RESULT_FILES[kind_of(run)], *_TAKEN])
        except (KeyboardInterrupt, Exception) as error:
            if not _is_interruption(error):
                if _leaves_nothing(run, error):
                    delete_folder(run.path)
                    raise
                run.set_status("failed")
                run.log(f"failed: {error}")
                raise
            raise interrupted() from None


def _leaves_nothing(run: RunStore, error: BaseException) -> bool:
    """Tell whether input was refused at once, or a search came to its end with nothing found."""
    if not isinstance(error, CranktopoError):
        return False
    if error.code == ExitCode.CRITERION_NOT_MET:
        return run.has_searched_only
    return error.code == ExitCode.INVALID_INPUT and run.has_only_begun


def _is_interruption(error: BaseException) -> bool:
    if isinstance(error, CranktopoError):
        return error.code == ExitCode.INTERRUPTED
    return isinstance(error, KeyboardInterrupt)
