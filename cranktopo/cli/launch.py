"""Entry point of the command: Ctrl-C while the program is still being loaded ends it without a traceback."""

from __future__ import annotations

import signal


def main() -> int:
    """Load the program, then run it with its own answer to Ctrl-C."""
    watched = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if watched:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    from cranktopo.cli.main import main as run

    if watched:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    return run()
