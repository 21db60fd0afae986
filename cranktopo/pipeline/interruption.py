"""Ctrl-C that cannot be lost."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType


@contextmanager
def interruptible() -> Iterator[Callable[[], None]]:
    """A block in which Ctrl-C raises KeyboardInterrupt at once and again at each call of what it yields.

    Python drops a KeyboardInterrupt that is raised inside a callback of compiled code, a destructor or a
    listener: it prints a warning at most, and the work goes on. Long work therefore calls the yielded
    function between its steps. Blocks may be nested. Outside the main thread, and where the signal is
    ignored, nothing is changed.
    """
    pressed = False
    before = signal.getsignal(signal.SIGINT)

    def remember(number: int, frame: FrameType | None) -> None:
        nonlocal pressed
        pressed = True
        if callable(before):
            before(number, frame)

    def check() -> None:
        if pressed:
            raise KeyboardInterrupt

    if not callable(before) or threading.current_thread() is not threading.main_thread():
        yield check
        return
    signal.signal(signal.SIGINT, remember)
    try:
        yield check
        check()
    finally:
        signal.signal(signal.SIGINT, before)
