"""Ctrl-C, and the system's request to end, that cannot be lost."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType


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
