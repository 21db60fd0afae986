"""Last words of an interrupted program that cannot come to its own end."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from cranktopo.base.errors import CranktopoError, ExitCode

_open: list[Callable[[], CranktopoError | None]] = []


@contextmanager
def closed_by(close: Callable[[], CranktopoError | None]) -> Iterator[None]:
    """Have `close` called, from another thread, where the block is cut off by the end of the process.

    It removes what the block is still writing, or records the end of its work and returns the message.
    """
    _open.append(close)
    try:
        yield
    finally:
        _open.remove(close)


def cut_off() -> CranktopoError:
    """Close all open blocks, the innermost first; return the message of the outermost."""
    faults = [close() for close in reversed(_open)]
    messages = [CranktopoError("interrupted.", code=ExitCode.INTERRUPTED), *filter(None, faults)]
    return messages[-1]
