"""The command's process: requests to end are never shown as a traceback, and never lost."""

from __future__ import annotations

import _thread
import atexit
import gc
import os
import signal
import sys
import threading
import time
from contextlib import suppress
from importlib.machinery import ExtensionFileLoader
from types import FrameType
from typing import Any, NoReturn

_INTERRUPTED = 130
_COLLECTING = 50_000, 20, 100
"""Objects after which Python looks for some that are not used: loading and tracing make many that stay."""
_ONE_THREAD = "OPENBLAS_NUM_THREADS", "1"
"""Small matrices gain nothing by more threads, which then wait busily: a fifth of a run's processor time."""
_ERRORS_ALONE = "TF_CPP_MIN_LOG_LEVEL", "3"
"""XLA tells of a slow compilation, as on a busy machine, in eight lines of its own that ask for a bug report;
what fails it raises, and what ends the process it tells all the same."""
_AGAIN_S = 0.05
_SAVING_S, _TELLING_S = 7.0, 2.0
"""Seconds that the main thread has to end after a signal, and then another one to say so in its place."""


def run_to_its_end(ours: list[int]) -> NoReturn:
    """Load the program, then run it; Ctrl-C and SIGTERM interrupt it alike, so that it saves what it has.

    Args:
        ours: numbers of the signals that nobody else answers; until here each ends the process.
    """
    gc.set_threshold(*_COLLECTING)
    os.environ.setdefault(*_ONE_THREAD)
    os.environ.setdefault(*_ERRORS_ALONE)
    from cranktopo.app.main import main
    from cranktopo.base.late_modules import load_late
    from cranktopo.numerics.precision import compile_quickly

    load_late()
    compile_quickly()
    sys.unraisablehook = _raise_again
    _watch(ours)
    code: int | str | None = 0
    try:  # whatever a handler may raise in
        for number in ours:
            signal.signal(number, interrupt)
        try:
            main()
        except SystemExit as end:
            code = end.code
        _leave(ours)
    except KeyboardInterrupt:  # before the command began, or after its end
        code = code or _INTERRUPTED
        with suppress(KeyboardInterrupt):
            _leave(ours)
    _end(int(code or 0))


def _leave(numbers: list[int]) -> None:
    """Let signals end the process at once: nothing is left to save, only Python's own end."""
    for number in numbers:
        signal.signal(number, _end_at_once)


def _end_at_once(_number: int, _frame: FrameType | None) -> NoReturn:
    """End as interrupted, not by the signal: what the command printed may not be out yet."""
    os._exit(_INTERRUPTED)


def _watch(numbers: list[int]) -> None:
    """End the process in seconds after a signal, whatever native code or lock holds the main thread.

    Python raises KeyboardInterrupt there alone, once native code has returned: meshing, factorising and
    compiling take minutes. What is stored is whole at every moment, as for SIGKILL.
    """
    heard, signalled = os.pipe()
    os.set_blocking(signalled, False)
    signal.set_wakeup_fd(signalled, warn_on_full_buffer=False)
    threading.Thread(target=_cut_off, args=(heard, set(numbers)), daemon=True).start()


def _cut_off(heard: int, numbers: set[int]) -> None:
    from cranktopo.app.main import end_cut_off

    while not numbers.intersection(os.read(heard, 1)):
        pass
    time.sleep(_SAVING_S)
    try:
        at_last = threading.Timer(_TELLING_S, os._exit, [_INTERRUPTED])  # where not even that can be written
        at_last.daemon = True
        at_last.start()
        end_cut_off()
    finally:
        os._exit(_INTERRUPTED)


def _end(code: int) -> NoReturn:
    """End the process: Python would take apart for half a second what the system gets back anyway.

    A thread that still gets something ready, after an interruption, is not waited for.
    """
    from cranktopo.numerics.precision import skip_clean_up

    skip_clean_up()
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError):  # the command has told it
            stream.flush()
    os._exit(code)


def interrupt(_number: int, frame: FrameType | None) -> None:
    """Raise KeyboardInterrupt; where a native module is loaded, after that: some end the process by it."""
    if _loads_native(frame):
        _later()
    else:
        raise KeyboardInterrupt


def _loads_native(frame: FrameType | None) -> bool:
    while frame is not None:
        if isinstance(frame.f_locals.get("self"), ExtensionFileLoader):
            return True
        frame = frame.f_back
    return False


def _later() -> None:
    again = threading.Timer(_AGAIN_S, _thread.interrupt_main)
    again.daemon = True
    again.start()


def _raise_again(dropped: Any) -> None:
    """Interrupt once more where a KeyboardInterrupt fell into a destructor or callback, which drops it."""
    if dropped.exc_type is KeyboardInterrupt:
        _later()
    else:
        sys.__unraisablehook__(dropped)
