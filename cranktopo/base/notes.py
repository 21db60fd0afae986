"""Lines that long work tells while it goes on: the logger `cranktopo.notes`, shown by the command line.

A script hears them with `logging.basicConfig(level="INFO", format="%(message)s")`.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from contextvars import ContextVar

_LOG = logging.getLogger("cranktopo.notes")
_listener: ContextVar[Callable[[str], None] | None] = ContextVar("listener", default=None)
"""Function that hears the notes in place of the logger."""


def note(line: str) -> None:
    """Tell one line about the work."""
    (_listener.get() or _LOG.info)(line)


def detail(line: str) -> None:
    """Tell one line that only those want to read who asked for more."""
    if _listener.get() is None:
        _LOG.debug(line)


@contextmanager
def redirected(listener: Callable[[str], None]) -> Iterator[None]:
    """Bring the notes of a part of the work to another listener."""
    token = _listener.set(listener)
    try:
        yield
    finally:
        _listener.reset(token)


def silent() -> AbstractContextManager[None]:
    """Keep the notes of a part of the work to itself."""
    return redirected(lambda _: None)


def indented() -> AbstractContextManager[None]:
    """Tell the notes of a part of the work as those of a part."""
    outer = _listener.get() or _LOG.info
    return redirected(lambda line: outer(f"  {line}"))
