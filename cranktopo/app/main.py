"""Entry point: commands loaded late, errors shown in one place, streams that never end in a traceback."""

from __future__ import annotations

import io
import os
import re
import sys
from pathlib import Path
from typing import Any, BinaryIO, TextIO

import click

from cranktopo.base.errors import CranktopoError, ExitCode, lacks_memory, quoted
from cranktopo.base.interruption import cut_off
from cranktopo.base.machine import check_addresses
from cranktopo.base.reproducible import time_of_writing
from cranktopo.cli.group import LazyGroup, found_commands
from cranktopo.cli.output import tell, tell_error


def _prepare_streams() -> None:
    """Make the standard streams of this process usable; call it once, when the program starts.

    What is closed leads nowhere (otherwise the next file that is opened would take its number and hold what
    libraries print); notes that stderr cannot take are dropped; characters that a stream cannot show become
    escapes, and so do those that a terminal would obey.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the smallest free number: this one
    sys.stdout = _Printable(_usable(sys.stdout, 1))
    sys.stderr = _Notes(_on_own_descriptor(_usable(sys.stderr, 2)))


def _finish_stdout() -> OSError | None:
    """Write what stdout still holds; where that fails, what the system said, and stdout leads nowhere."""
    try:
        sys.stdout.flush()
    except OSError as error:
        _discard(1)
        return error
    return None


def _discard(number: int) -> None:
    """Let a standard stream lead nowhere from now on."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, number)
    os.close(nowhere)


def _usable(stream: Any, number: int) -> Any:
    """Return the stream, or one that leads nowhere in place of a closed one."""
    if stream is None:
        stream = open(number, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    if isinstance(stream, io.TextIOWrapper):
        stream.reconfigure(errors="backslashreplace")
    return stream


def _on_own_descriptor(stream: Any) -> Any:
    """Return the same stream by another descriptor.

    mmgpy points the usual one at a file while it remeshes, to read what MMG says: lines that other threads
    wrote meanwhile were lost.
    """
    own = os.dup(stream.fileno())
    return open(own, "w", buffering=1, encoding=stream.encoding, errors="backslashreplace")


_OBEYED = re.compile(r"\x1b(?!\[[0-9;]*m)|[\x00-\x08\x0b\x0c\x0e-\x1a\x1c-\x1f\x80-\x9f]")
"""Characters that begin a command to a terminal, but for colours."""


def _escaped(found: re.Match[str]) -> str:
    return f"\\x{ord(found[0]):02x}"


class _Printable(io.TextIOBase):
    """A stream of text: names from files cannot move the cursor, rewrite lines or rename the window."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        return self._stream.write(_OBEYED.sub(_escaped, text))

    def flush(self) -> None:
        self._stream.flush()

    def isatty(self) -> bool:
        return self._stream.isatty()

    def fileno(self) -> int:
        return self._stream.fileno()

    @property
    def buffer(self) -> BinaryIO:
        return self._stream.buffer

    @property
    def encoding(self) -> str:  # type: ignore[override]
        return self._stream.encoding


class _Notes(_Printable):
    """stderr: a full disk or a reader that has gone costs the notes, not the command."""

    def write(self, text: str) -> int:
        try:
            return super().write(text)
        except OSError:
            _discard(self.fileno())
            return len(text)

    def flush(self) -> None:
        try:
            super().flush()
        except OSError:
            _discard(self.fileno())


_SHOWN_FIRST = (
    "optimise",
    "plan",
    "loads",
    "balance",
    "evaluate",
    "compare",
    "accuracy",
    "report",
    "fatigue",
    "shaft",
    "film",
    "vibration",
    "modes",
    "bolts",
    "rod",
    "balancer",
    "extract",
    "remodel",
    "shape",
    "bound",
    "iterate",
    "sweep",
    "export",
    "designs",
    "runs",
    "doctor",
    "completion",
    "bench",
)
"""Order of the commands in the help; one that is not named comes after these."""
COMMANDS = found_commands(Path(__file__).parents[1] / "tasks", _SHOWN_FIRST)

_EPILOG = (
    "Exit codes: 0 done; 1 internal error; 2 wrong use; 3 invalid design or input; 4 solver failure; "
    "5 not converged, best result saved; 6 a requested criterion not met; 7 a package, a library or a device "
    "is missing: see 'cranktopo doctor'; 130 interrupted, checkpoint saved."
)


_LEAST_MIB = 700.0
"""Addresses without which nothing begins: with few, the libraries that every command loads abort or hang."""


@click.group(
    cls=LazyGroup,
    entries=COMMANDS,
    package="cranktopo.tasks",
    epilog=_EPILOG,
    context_settings={"help_option_names": ["-h", "--help"]},
)
@click.version_option(package_name="cranktopo")
def cli() -> None:
    """Topology and shape optimisation of crankshaft webs.

    A DESIGN is a TOML file or the name of a built-in design; without one, mikron-iiic is used.

    Example: cranktopo optimise mikron-iiic --volume-fraction 0.3
    """
    check_addresses("cranktopo", _LEAST_MIB)
    time_of_writing()  # a bad date is refused here, before libraries that read it, too, fail on it


def main(args: list[str] | None = None) -> int:
    """Run the command line, by default the process's own, and return its exit code (the console script)."""
    if args is not None:
        return _run(args)
    _prepare_streams()
    code = _run(sys.argv[1:])
    unwritten = _finish_stdout()
    if unwritten is not None and not isinstance(unwritten, BrokenPipeError) and code == ExitCode.DONE:
        code = _report(_system_error(unwritten), [])
    sys.exit(code)


def _run(arguments: list[str]) -> int:
    try:
        _check_words(arguments)
        result: Any = cli.main(arguments, prog_name="cranktopo", standalone_mode=False)
        return int(result) if isinstance(result, int) else ExitCode.DONE
    except CranktopoError as error:
        return _report(error, arguments)
    except click.UsageError as error:
        where = error.ctx.command_path if error.ctx else "cranktopo"
        hint = f"See '{where} --help'."
        message = f"{error.format_message().removesuffix('.')}."
        return _report(CranktopoError(message, hint=hint, code=ExitCode.USAGE), arguments)
    except click.ClickException as error:
        return _report(CranktopoError(error.format_message(), code=ExitCode.USAGE), arguments)
    except (click.Abort, KeyboardInterrupt):
        return _report(_INTERRUPTED, arguments)
    except (BrokenPipeError, SystemExit):  # click turns the first into the second
        return ExitCode.DONE
    except OSError as error:  # a file or stream that the system refuses in the middle of the work
        return _report(_NO_MEMORY if lacks_memory(error) else _system_error(error), arguments)
    except Exception as error:
        if _wraps_interruption(error):
            return _report(_INTERRUPTED, arguments)
        return _report(_NO_MEMORY, arguments) if lacks_memory(error) else _internal(error, arguments)


_INTERRUPTED = CranktopoError("interrupted.", code=ExitCode.INTERRUPTED)
_NO_MEMORY = CranktopoError(
    "not enough memory.", hint="Take larger cells or elements, or allow more memory.", code=ExitCode.SOLVER
)


def _wraps_interruption(error: BaseException | None) -> bool:
    """Tell whether an interruption became this error on its way, as in the making of a class by an import."""
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__ or error.__context__
    return error is not None


def end_cut_off() -> None:
    """Record and tell, from another thread, that the interrupted work of the main one is cut off."""
    _report(cut_off(), sys.argv[1:])


def _check_words(arguments: list[str]) -> None:
    """No word of a command line may be empty: it comes from a variable that was never set."""
    for before, word in zip(["", *arguments], arguments, strict=False):
        option, equals, value = word.partition("=")
        if not word.strip() or (equals and option.startswith("--") and not value.strip()):
            name = option if equals else before
            where = f"{name} is empty" if name.startswith("-") else "an argument is empty"
            raise click.UsageError(f"{where}.")
        if "\0" in word:
            raise click.UsageError(f"{quoted(word)} holds a NUL character.")


def _system_error(error: OSError) -> CranktopoError:
    where = f"'{error.filename}'" if error.filename else "output"
    return CranktopoError(
        f"{where}: cannot be used: {error.strerror or error}.",
        hint="Check its folder, rights and free space.",
    )


def _report(error: CranktopoError, arguments: list[str]) -> int:
    if "--json" in arguments:
        try:
            tell(error.as_json(), indent=None)
        except OSError:
            _discard(1)
    tell_error(str(error))
    return int(error.code)


def _internal(error: Exception, arguments: list[str]) -> int:
    import tempfile
    import traceback

    with tempfile.NamedTemporaryFile("w", prefix="cranktopo-crash-", suffix=".log", delete=False) as log:
        traceback.print_exception(error, file=log)
    message = f"internal error: {type(error).__name__}: {error}."
    hint = f"This is a defect of cranktopo; the details are in {log.name}."
    return _report(CranktopoError(message, hint=hint, code=ExitCode.INTERNAL), arguments)
