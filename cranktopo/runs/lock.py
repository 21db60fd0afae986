"""One process per run: an advisory lock that the system drops when its holder ends, however it ends."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from cranktopo.base.errors import CranktopoError
from cranktopo.base.files import unwritable

_NAME = ".lock"


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold a run directory for the length of the block (POSIX `flock`; elsewhere no protection).

    Raises:
        CranktopoError: another process holds it, or the lock file cannot be written.
    """
    try:
        import fcntl
    except ImportError:  # no flock on Windows
        yield
        return
    try:
        file = (folder / _NAME).open("a+", encoding="ascii")
    except OSError as error:
        raise unwritable(folder / _NAME, error) from None
    with file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            file.seek(0)
            raise CranktopoError(
                f"run '{folder}': in use by process {file.read().strip() or 'unknown'}.",
                hint="Wait for it to end, or stop it first.",
            ) from None
        file.truncate(0)
        file.write(str(os.getpid()))
        file.flush()
        yield
