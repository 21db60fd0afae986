"""A second process beside the first, for work that holds the interpreter: Python runs on one core.

It loads its libraries while this process loads others, and does one work after the other, each a function of
a module with what it takes and returns pickled. Where it is missing or has ended, this process does the work.
"""

from __future__ import annotations

import gc
import os
import pickle
import struct
import subprocess
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from importlib import import_module
from typing import IO, Any, TypeVar

from cranktopo.base.child import answer_of, answering, outcome, started
from cranktopo.base.late_modules import load_late
from cranktopo.base.machine import container_memory_left_MiB, usable_cores
from cranktopo.base.notes import detail
from cranktopo.base.side_by_side import LazyFuture

_R = TypeVar("_R")
_START = "from cranktopo.base.companion import serve; serve()"
_SIZE = struct.Struct("<Q")
"""In front of every message: its bytes."""
_ROOM_MIB = 1500.0
"""Memory of a container that must be left: what such processes take together (350 and 850 measured)."""
Work = Callable[[], _R]
"""Gives the result of a work that has begun; raises what it raised."""


class Companion:
    """A second process from the beginning of a `with` block to its end.

    On one core, or with little memory, there is none.

    Args:
        libraries: modules that it loads before its first work.
    """

    def __init__(self, libraries: Sequence[str] = ()) -> None:
        self._libraries = libraries
        self._process: subprocess.Popen[bytes] | None = None
        self._last: LazyFuture[Any] | None = None
        self._left = False

    def __enter__(self) -> Companion:
        if usable_cores() > 1 and container_memory_left_MiB() > _ROOM_MIB:
            watched, self._ours = os.pipe()  # it ends when this process has gone
            try:
                self._process = started(_START, watched, *self._libraries)
            except OSError:  # no memory or no process is left for it
                os.close(self._ours)
            finally:
                os.close(watched)
        return self

    def __exit__(self, *_: object) -> None:
        self._left = True
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            os.close(self._ours)
            for pipe in (self._process.stdin, self._process.stdout):
                with suppress(OSError):
                    assert pipe is not None
                    pipe.close()

    def begin(self, function: Callable[..., _R], *arguments: object) -> Work[_R]:
        """Begin a work, once the one before it has ended, and return what gives its result.

        Without a second process it begins where its result is asked for.
        """
        before, process = self._last, self._process
        if process is None:
            return LazyFuture(lambda: function(*arguments)).result

        def done() -> _R:
            if before is not None:
                before.begin().exception()
            answer = _asked(process, pickle.dumps((function, arguments)))
            if answer:
                return outcome(answer)
            if self._left:
                raise InterruptedError("the block that wanted the work has ended")
            detail("the second process has ended: the first one does its work")
            return function(*arguments)

        work = LazyFuture(done)
        self._last = work
        work.begin()
        return work.result


ALONE = Companion()
"""No second process."""


def _asked(process: subprocess.Popen[bytes], work: bytes) -> bytes:
    """Return what a process answers; nothing where it has ended."""
    assert process.stdin is not None
    assert process.stdout is not None
    try:
        _send(process.stdin, work)
        return _received(process.stdout)
    except (OSError, ValueError):  # ValueError: closed meanwhile
        return b""


def _send(file: IO[bytes], message: bytes) -> None:
    file.write(_SIZE.pack(len(message)) + message)
    file.flush()


def _received(file: IO[bytes]) -> bytes:
    """Return the next message whole; nothing where the other side has ended."""
    head = file.read(_SIZE.size)
    if len(head) < _SIZE.size:
        return b""
    (size,) = _SIZE.unpack(head)
    message = file.read(size)
    return message if len(message) == size else b""


def load_libraries(names: Sequence[str]) -> None:
    """Import modules for works to come, in a second process."""
    gc.disable()  # to look through what stays takes a tenth of the loading
    for name in names:
        import_module(name)
    gc.freeze()
    gc.enable()


def serve() -> None:
    """Load the libraries that the command line names, then do what comes by stdin and answer on stdout."""
    with open(answering(), "wb") as answers:
        load_late()
        load_libraries(sys.argv[2:])
        while message := _received(sys.stdin.buffer):
            function, arguments = pickle.loads(message)
            _send(answers, answer_of(function, arguments))
    os._exit(0)
