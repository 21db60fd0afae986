"""Messages of a long command on stderr: --quiet and --verbose."""

from __future__ import annotations

import logging
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext, suppress
from functools import partial, wraps
from pathlib import Path
from typing import Any

import click

from cranktopo.base.notes import QUIET_S as _QUIET_S
from cranktopo.base.notes import running
from cranktopo.cli.output import tell
from cranktopo.cli.watchdog_process import waited

_LEVEL = "cranktopo.verbosity"
_LONGEST_S = 24.0
"""Between two lines of long work: after half a minute without one people ask whether it hangs."""
_BEAT = 1 / 12
"""Between two signs of life for the process that speaks while native code stops all threads of this one, over
the longest time without a line."""
QUIET, NORMAL, VERBOSE = -1, 0, 1
_LOGGED = {QUIET: logging.WARNING, NORMAL: logging.INFO, VERBOSE: logging.DEBUG}


def verbosity_options(function: Any) -> Any:
    """Add --quiet and --verbose to a long command, whose notes go to stderr as they say."""
    options = (
        ("-v", "--verbose", VERBOSE, "More detail on stderr."),
        ("-q", "--quiet", QUIET, "No progress or notes on stderr; results, warnings and errors only."),
    )
    for short, long, its_level, text in options:
        function = click.option(
            short, long, is_flag=True, expose_value=False, callback=partial(_set, its_level), help=text
        )(function)

    @wraps(function)
    def command(*arguments: Any, **options: Any) -> Any:
        with _notes_on_stderr():
            return function(*arguments, **options)

    return command


class _Stderr(logging.Handler):
    """Write a record as one line on stderr, above a progress bar where there is one.

    Attributes:
        told: when the last record was written.
        spoken: when the last line was written, of a record or about a wait.
    """

    def __init__(self) -> None:
        super().__init__()
        self.last_record_s = self.last_line_s = time.monotonic()

    def emit(self, record: logging.LogRecord) -> None:
        self.last_record_s = self.last_line_s = time.monotonic()
        bars = sys.modules.get("tqdm")
        with bars.tqdm.external_write_mode(file=sys.stderr) if bars else nullcontext():
            tell(record.getMessage(), err=True)

    def tell_waits(self, command: str, ended: threading.Event, quiet_s: float) -> None:
        """Tell what runs when no line has come for some seconds, then after twice the time, up to a limit."""
        last, wait = self.last_record_s, quiet_s
        while not ended.wait(max(last + wait - time.monotonic(), 0.0)):
            if self.last_record_s != last:
                last, wait = self.last_record_s, quiet_s
                continue
            took = time.monotonic() - last
            if not _has_progress_bar():
                self.last_line_s = time.monotonic()
                tell(f"{running() or command}: {waited(took)} so far", err=True)
            wait = took + min(took, _LONGEST_S)

    def beat(self, command: str, ended: threading.Event) -> None:
        """Keep a process that tells a line where no thread of this one can; none for a short command."""
        if ended.wait(_BEAT * _LONGEST_S / 2):
            return
        program = [sys.executable, "-I", "-S", str(Path(__file__).with_name("watchdog_process.py"))]
        with (
            suppress(OSError),  # no process can be started, or it has gone: there is no such line then
            subprocess.Popen(
                [*program, str(_LONGEST_S)],
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=sys.stderr,  # not the usual descriptor, which a mesher may have taken away
                bufsize=0,
                start_new_session=True,  # a terminal sends Ctrl-C to all
            ) as process,
        ):
            assert process.stdin is not None
            while True:
                now, name = time.monotonic(), "" if _has_progress_bar() else running() or command
                process.stdin.write(
                    f"{now - self.last_line_s:.1f} {now - self.last_record_s:.1f} {name}\n".encode()
                )
                if ended.wait(_BEAT * _LONGEST_S):
                    break


def _has_progress_bar() -> bool:
    """Tell whether a progress bar shows that the work goes on."""
    bars: Any = sys.modules.get("tqdm")
    return bool(getattr(getattr(bars, "tqdm", None), "_instances", None))  # or it is being imported


@contextmanager
def _notes_on_stderr() -> Iterator[None]:
    logger, handler, ended = logging.getLogger("cranktopo"), _Stderr(), threading.Event()
    before = logger.level
    logger.addHandler(handler)
    logger.setLevel(_LOGGED[level()])
    command = _command()
    threads = [
        threading.Thread(target=handler.tell_waits, args=(command, ended, _QUIET_S), daemon=True),
        threading.Thread(target=handler.beat, args=(command, ended), daemon=True),
    ]
    if level() == QUIET:
        ended.set()
    for thread in threads:
        thread.start()
    try:
        yield
    finally:
        ended.set()
        for thread in threads:
            thread.join()
        logger.removeHandler(handler)
        logger.setLevel(before)


def _command() -> str:
    context = click.get_current_context(silent=True)
    return (context and context.info_name) or "at work"


def level() -> int:
    """Return the level that the running command was given."""
    context = click.get_current_context(silent=True)
    return NORMAL if context is None else int(context.meta.get(_LEVEL, NORMAL))


def _set(level: int, context: click.Context, parameter: click.Parameter, value: bool) -> None:
    if value and context.meta.get(_LEVEL, level) != level:
        raise click.UsageError("--quiet and --verbose exclude each other.", context)
    if value:
        context.meta[_LEVEL] = level
