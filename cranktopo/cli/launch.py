"""Entry point of the command: requests to end are never shown as a traceback, and never lost."""

from __future__ import annotations

import _thread
import signal
import sys
import threading
from typing import Any

_ENDING = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: signal.SIG_DFL}
"""Signals that ask the program to end, and what Python does with them if nobody says otherwise."""
_INTERRUPTED = 130
_AGAIN_S = 0.05


def main() -> int:
    """Load the program, then run it; Ctrl-C and SIGTERM interrupt it alike, so that it saves what it has."""
    ours = [number for number, usual in _ENDING.items() if signal.getsignal(number) is usual]
    for number in ours:
        signal.signal(number, signal.SIG_DFL)
    from cranktopo.cli.main import main as run

    sys.unraisablehook = _raise_again
    for number in ours:
        signal.signal(number, signal.default_int_handler)
    try:
        return run()
    except KeyboardInterrupt:
        sys.exit(_INTERRUPTED)
    finally:  # nothing is left to save, only Python's own end
        for number in ours:
            signal.signal(number, signal.SIG_DFL)


def _raise_again(dropped: Any) -> None:
    """Interrupt once more where a KeyboardInterrupt fell into a destructor or callback, which drops it."""
    if dropped.exc_type is KeyboardInterrupt:
        again = threading.Timer(_AGAIN_S, _thread.interrupt_main)
        again.daemon = True
        again.start()
    else:
        sys.__unraisablehook__(dropped)
