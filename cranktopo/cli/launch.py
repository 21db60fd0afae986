"""Entry point of the command: a request to end while the program is loaded ends it without a traceback."""

from __future__ import annotations

import signal

_ENDING = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: signal.SIG_DFL}
"""Signals that ask the program to end, and what Python does with them if nobody says otherwise."""


def main() -> int:
    """Load the program, then run it; Ctrl-C and SIGTERM interrupt it alike, so that it saves what it has."""
    ours = [number for number, usual in _ENDING.items() if signal.getsignal(number) is usual]
    for number in ours:
        signal.signal(number, signal.SIG_DFL)
    from cranktopo.cli.main import main as run

    for number in ours:
        signal.signal(number, signal.default_int_handler)
    try:
        return run()
    finally:  # nothing is left to save, only Python's own end
        for number in ours:
            signal.signal(number, signal.SIG_DFL)
