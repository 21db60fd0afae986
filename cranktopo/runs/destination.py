"""Can an output go where the user wants it? Asked, writing nothing, before the long work."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.files import unwritable


def check_file(path: Path, what: str, suffixes: Sequence[str] = (), replace: bool = True) -> None:
    """Check that a file can be written.

    Args:
        what: the option that names it, or what it is, for the message.
        suffixes: endings that it may have; any when empty.
        replace: whether it may exist already.

    Raises:
        CranktopoError: another ending, no such folder, a folder itself, not writable, or it exists.
    """
    if suffixes and path.suffix.lower() not in suffixes:
        *most, last = suffixes
        endings = f"{', '.join(most)} or {last}" if most else last
        raise _refused(path, what, f": must end in {endings}", f"Name it {path.stem or what}{suffixes[0]}.")
    if not path.parent.is_dir():
        raise _refused(path, what, ": its folder does not exist", "Make the folder, or name another one.")
    if path.is_dir():
        raise _refused(path, what, ": is a folder", "Name a file in it.")
    if path.exists() and not replace:
        raise _refused(path, what, " exists", "Give --force to replace it.")
    if not os.access(path.parent, os.W_OK | os.X_OK):
        raise unwritable(path, PermissionError(13, f"'{path.parent}' is not writable"))


def check_folder(path: Path) -> None:
    """Check that a folder is there or can be made, with files in it.

    Raises:
        CranktopoError: it or what it lies in is a file or not writable.
    """
    existing = path
    while not existing.exists():
        existing = existing.parent
    if not existing.is_dir():
        raise CranktopoError(f"output '{path}': '{existing}' is a file.", hint="Choose another --out.")
    if not os.access(existing, os.W_OK | os.X_OK):
        raise unwritable(path, PermissionError(13, f"'{existing}' is not writable"))


def _refused(path: Path, what: str, why: str, hint: str) -> CranktopoError:
    return CranktopoError(f"{what} '{path}'{why}.", hint=hint, code=ExitCode.USAGE)
