"""Standard streams that are closed, full, or cannot show every character end no command in a traceback."""

from __future__ import annotations

import io
import os
import sys
from typing import Any, TextIO


def prepare_streams() -> None:
    """Make the standard streams of this process usable; call it once, when the program starts.

    What is closed leads nowhere (otherwise the next file that is opened would take its number and hold what
    libraries print); notes that stderr cannot take are dropped; characters that a stream cannot show become
    escapes.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the smallest free number: this one
    sys.stdout = _usable(sys.stdout, 1)
    sys.stderr = _Notes(_usable(sys.stderr, 2))


def finish_stdout() -> OSError | None:
    """Write what stdout still holds; where that fails, what the system said, and stdout leads nowhere."""
    try:
        sys.stdout.flush()
    except OSError as error:
        discard(1)
        return error
    return None


def discard(number: int) -> None:
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


class _Notes(io.TextIOBase):
    """stderr: a full disk or a reader that has gone costs the notes, not the command."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        try:
            return self._stream.write(text)
        except OSError:
            discard(2)
            return len(text)

    def flush(self) -> None:
        try:
            self._stream.flush()
        except OSError:
            discard(2)

    def isatty(self) -> bool:
        return self._stream.isatty()

    def fileno(self) -> int:
        return self._stream.fileno()

    @property
    def encoding(self) -> str:  # type: ignore[override]
        return self._stream.encoding
