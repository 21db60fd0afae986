"""Entry point of the command: it loads nothing before Ctrl-C can end it without a traceback."""

from __future__ import annotations

import _signal  # type: ignore[import-not-found]  # built into Python; `signal` takes milliseconds to load

TYPE_CHECKING = False  # as type checkers know it; `typing` takes as long
if TYPE_CHECKING:
    from typing import NoReturn

_USUAL = {_signal.SIGINT: _signal.default_int_handler, _signal.SIGTERM: _signal.SIG_DFL}
"""Signals that ask the program to end, and what Python does with them if nobody says otherwise."""


def main() -> NoReturn:
    """Let signals end the process at once, with nothing to save yet; then load the program and run it."""
    ours = [number for number, usual in _USUAL.items() if _signal.getsignal(number) == usual]
    for number in ours:
        _signal.signal(number, _signal.SIG_DFL)
    from cranktopo.app.process import run_to_its_end

    run_to_its_end(ours)
