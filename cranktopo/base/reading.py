"""The one boundary for what comes in: files that can be read, of a sane size, and text that is text."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from cranktopo.base.errors import CranktopoError

MIB = 1024**2
_TEXT_LIMIT_MIB = 16
"""Designs, tables, manifests and metrics; the largest that the program writes has 2 MiB."""
GEOMETRY_LIMIT_MIB = 1024
"""STL and STEP: 20 million triangles."""
_SPECIAL = {
    stat.S_IFDIR: "is a folder",
    stat.S_IFIFO: "is a pipe",
    stat.S_IFCHR: "is a device",
    stat.S_IFBLK: "is a device",
    stat.S_IFSOCK: "is a socket",
}


def check_input(path: str | Path, name: str, limit_MiB: float, hint: str = "") -> None:
    """Check that a file can be read: it exists, is a regular file, and is neither empty nor too large.

    Args:
        name: of the file in the message, such as `design 'x.toml'`.
        limit_MiB: the largest size.
        hint: what to do next, where the size is not what is wrong.

    Raises:
        CranktopoError: the file cannot be used.
    """
    try:
        found = os.stat(path)
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        raise _refused(name, f"cannot be read: {_reason(error)}", hint) from None
    if not stat.S_ISREG(found.st_mode):
        kind = _SPECIAL.get(stat.S_IFMT(found.st_mode), "is no regular file")
        raise _refused(name, f"{kind}, not a file", hint)
    if found.st_size > limit_MiB * MIB:
        raise _too_large(name, limit_MiB)
    if not os.access(path, os.R_OK):
        raise _refused(name, "cannot be read: Permission denied", hint)


def read_bytes(path: str | Path, name: str, limit_MiB: float, hint: str = "") -> bytes:
    """Content of a file.

    Args:
        name: of the file in the message, such as `design 'x.toml'`.
        limit_MiB: the largest size.
        hint: what to do next, where the size is not what is wrong.

    Raises:
        CranktopoError: as `check_input`.
    """
    check_input(path, name, limit_MiB, hint)
    most = int(limit_MiB * MIB)
    try:
        with open(path, "rb") as file:
            content = file.read(most + 1)  # a file of /proc has more than its size says
    except OSError as error:
        raise _refused(name, f"cannot be read: {_reason(error)}", hint) from None
    if len(content) > most:
        raise _too_large(name, limit_MiB)
    return content


def read_text_file(path: str | Path, name: str, limit_MiB: float = _TEXT_LIMIT_MIB, hint: str = "") -> str:
    """Text of a UTF-8 file, with or without a byte-order mark.

    Args:
        name: of the file in the message, such as `design 'x.toml'`.
        limit_MiB: the largest size.
        hint: what to do next, where neither the size nor the encoding is wrong.

    Raises:
        CranktopoError: as `check_input`, or it is not text.
    """
    content = read_bytes(path, name, limit_MiB, hint)
    if b"\0" in content:
        raise _refused(name, "is not text in UTF-8: it holds NUL bytes", "Save it as UTF-8.")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        raise _refused(name, f"is not text in UTF-8: line {line}", "Save it as UTF-8.") from None


def _reason(error: OSError | ValueError) -> str:
    if isinstance(error, OSError):
        return error.strerror or str(error)
    return "no file name may hold a NUL character"


def _too_large(name: str, limit_MiB: float) -> CranktopoError:
    return _refused(name, f"is larger than {limit_MiB:g} MiB", "Give a smaller file.")


def _refused(name: str, why: str, hint: str) -> CranktopoError:
    return CranktopoError(f"{name}: {why}.", hint=hint)
