"""Files read within sane limits and written atomically: a reader sees the old content or the new one.

Every write goes to a temporary file in the same folder, is flushed to the disk, renamed over the
target, and the folder entry is flushed as well (the rename is atomic by POSIX).
"""

from __future__ import annotations

import errno
import io
import json
import math
import os
import secrets
import shutil
import stat
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path, PurePath
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.errors import CranktopoError, ExitCode, quoted
from cranktopo.base.interruption import closed_by

_MIB = 1024**2
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
        hint: next step, where the size is not what is wrong.
    """
    try:
        found = os.stat(path)
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        raise _refused(name, f"cannot be read: {_reason(error)}", hint) from None
    if not stat.S_ISREG(found.st_mode):
        kind = _SPECIAL.get(stat.S_IFMT(found.st_mode), "is no regular file")
        raise _refused(name, f"{kind}, not a file", hint)
    if found.st_size > limit_MiB * _MIB:
        raise _too_large(name, limit_MiB)
    if not os.access(path, os.R_OK):
        raise _refused(name, "cannot be read: Permission denied", hint)


def read_bytes(path: str | Path, name: str, limit_MiB: float, hint: str = "") -> bytes:
    """Return the content of a file; raises CranktopoError as `check_input`."""
    check_input(path, name, limit_MiB, hint)
    most = int(limit_MiB * _MIB)
    try:
        with open(path, "rb") as file:
            content = file.read(most + 1)  # a file of /proc has more than its size says
    except OSError as error:
        raise _refused(name, f"cannot be read: {_reason(error)}", hint) from None
    if len(content) > most:
        raise _too_large(name, limit_MiB)
    return content


def read_text_file(
    path: str | Path, name: str, limit_MiB: float = _TEXT_LIMIT_MIB, hint: str = "", otherwise: str = ""
) -> str:
    """Return the text of a UTF-8 file, with or without a byte-order mark; raises CranktopoError.

    Args:
        path: of the file.
        name: of the file in the message.
        limit_MiB: largest size.
        hint: as of `check_input`.
        otherwise: encoding of a file that is not in UTF-8; none is refused.
    """
    content = read_bytes(path, name, limit_MiB, hint)
    if b"\0" in content:
        raise _refused(name, "is not text in UTF-8: it holds NUL bytes", "Save it as UTF-8.")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        if otherwise:
            with suppress(UnicodeDecodeError):
                return content.decode(otherwise)
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


TEMPORARY = ".tmp"
"""In the names of files and folders that a process is still writing."""
_JSON_LIMIT_MIB = 64
_MOST_DIGITS = 18
"""Of an integer in a file of the program; longer ones overflow where they are computed with."""
_MOST_LEVELS = 100
_TOO_DEEP = f"it has more than {_MOST_LEVELS} levels"
ARRAYS_LIMIT_MIB = 2048
"""A checkpoint has 8 to 40 bytes per cell: 50 million cells."""


class UnwritableError(CranktopoError):
    """The system refuses an output: the disk is full, or the folder may not be written."""


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give a temporary path beside `path`, suffix in small letters, that becomes it when the block ends well.

    For libraries that insist on writing a file by name. It is made here, by a name that nobody can foresee: a
    link that is put there would lead the writer to another file. When the block fails, `path` keeps what it
    held.
    Raises CranktopoError where the file cannot be written.
    """
    if os.path.exists(path) and not os.path.isfile(path):  # a device would be replaced by a file
        raise unwritable(path, OSError(errno.EINVAL, "it exists and is no regular file"))
    temporary = path.with_name(f".{path.stem}.{secrets.token_hex(8)}{TEMPORARY}{path.suffix.lower()}")
    try:
        temporary.touch(exist_ok=False)
        with closed_by(lambda: temporary.unlink(missing_ok=True)):
            yield temporary
        _flush(temporary)
        os.replace(temporary, path)
        _flush(path.parent)
    except OSError as error:
        raise unwritable(path, error) from None
    finally:
        if temporary.exists():
            temporary.unlink()


def no_link(path: str, flags: int) -> int:
    """Open a file for `open(..., opener=no_link)`; a link in its place may lead to any file of the user."""
    return os.open(path, flags | getattr(os, "O_NOFOLLOW", 0), 0o666)


def unwritable(path: Path, error: OSError) -> UnwritableError:
    """Return the error for an output that the system refuses."""
    reason = error.strerror or str(error)
    return UnwritableError(
        f"output '{path}': cannot be written: {reason}.",
        hint="Choose a writable folder with free space (--out DIR).",
    )


def as_path(path: Path | str) -> Path:
    """Return a path that a script gives as text or path."""
    return Path(path)


def as_path_if_any(path: Path | str | None) -> Path | None:
    """Return a path that a script gives as text or path, or not at all."""
    return None if path is None else Path(path)


def write_bytes(path: Path, content: bytes) -> None:
    """Write a file atomically; raises CranktopoError where it cannot be written."""
    with replacing(path) as temporary:
        temporary.write_bytes(content)


def write_text(path: Path, content: str) -> None:
    """Write a text file atomically as UTF-8."""
    write_bytes(path, text_bytes(content))


def text_bytes(content: str) -> bytes:
    """Return a text as its file holds it; a file name in it that is not UTF-8 is no reason to fail."""
    return content.encode("utf-8", "backslashreplace")


def write_json(path: Path, data: Mapping[str, Any]) -> None:
    """Write an object atomically as JSON; raises CranktopoError where a number is not finite."""
    write_text(path, json_file_text(data, path.name))


def json_file_text(data: Mapping[str, Any], name: str) -> str:
    """Return an object as a JSON file holds it; raises CranktopoError where a number is not finite."""
    return json_text(data, name, indent=2) + "\n"


def write_npz(path: Path, arrays: Mapping[str, NDArray[Any]], compressed: bool = False) -> None:
    """Write named arrays atomically as .npz, every bit kept."""
    save = np.savez_compressed if compressed else np.savez
    with replacing(path) as temporary, temporary.open("wb") as file:
        save(file, allow_pickle=False, **dict(arrays))


def json_text(data: Mapping[str, Any], name: str, indent: int | None = None) -> str:
    """Return an object as JSON, keys in the given order; raises CranktopoError for a number not finite."""
    key = _not_finite(data)
    if key is not None:
        raise CranktopoError(
            f"{name}: {key} is not a finite number.",
            hint="A solve diverged or a value is undefined: check the log of the run.",
            code=ExitCode.SOLVER,
        )
    return json.dumps(data, indent=indent, allow_nan=False, default=_plain)


def read_json(path: Path) -> dict[str, Any]:
    """Return the object in a JSON file; raises CranktopoError where there is none."""
    if not os.path.lexists(path):
        raise CranktopoError(f"'{path}': no such file.", hint="Check the path of the run.")
    text = read_text_file(path, f"'{path}'", _JSON_LIMIT_MIB, "Start a new run.")
    try:
        data = from_json(text)
    except ValueError as error:
        raise CranktopoError(
            f"'{path}': corrupted, cannot be read: {quoted(str(error))}.", hint="Start a new run."
        ) from None
    if not isinstance(data, dict):
        raise CranktopoError(f"'{path}': corrupted, not a JSON object.", hint="Start a new run.")
    return data


def from_json(text: str) -> Any:
    """Return what JSON holds; raises ValueError for a number that no computer number is, as NaN or 1e999.

    What lies deeper than anything that we write is refused too: what walks it would not come to its end.
    """
    try:
        data = json.loads(text, parse_constant=_no_number, parse_int=_integer, parse_float=_finite)
    except RecursionError:
        raise ValueError(_TOO_DEEP) from None
    level = [data]
    for _ in range(_MOST_LEVELS):
        nested = [one for one in level if isinstance(one, dict | list)]
        level = [value for one in nested for value in (one.values() if isinstance(one, dict) else one)]
        if not level:
            return data
    raise ValueError(_TOO_DEEP)


def inside(folder: Path, name: str) -> Path:
    """Return the file of a folder that a stored name means; raises CranktopoError where it leads out."""
    if not is_inside(name):
        raise CranktopoError(
            f"'{folder}': names {quoted(name)}, which is no file in it.",
            hint="It was changed by hand: make it again.",
        )
    return folder / name


def is_inside(name: str) -> bool:
    """Tell whether a name is that of a file in a folder or below it."""
    parts = PurePath(name).parts
    return bool(parts) and name.isprintable() and not PurePath(name).is_absolute() and ".." not in parts


def read_npz(path: Path, name: str, hint: str) -> dict[str, NDArray[Any]]:
    """Return the named arrays of an .npz file; raises CranktopoError, with the hint, for a damaged one."""
    content = io.BytesIO(read_bytes(path, name, ARRAYS_LIMIT_MIB, hint))
    try:
        with zipfile.ZipFile(content) as packed:
            size_MiB = sum(part.file_size for part in packed.infolist()) / _MIB
        if size_MiB <= ARRAYS_LIMIT_MIB:
            with np.load(content, allow_pickle=False) as file:
                return {key: file[key] for key in file.files}
    except Exception as error:  # zipfile and numpy raise a dozen types on damaged bytes, all meaning this
        what = f"{name}: corrupted, cannot be read ({quoted(str(error))})."
        raise CranktopoError(what, hint=hint) from None
    what = f"{name}: unpacks to {size_MiB:.0f} MiB; a run holds at most {ARRAYS_LIMIT_MIB:g} MiB."
    raise CranktopoError(what, hint=hint)


def sweep_temporaries(folder: Path) -> None:
    """Remove what killed processes left unfinished in `folder` and the folders below it."""
    for path in list(folder.rglob(f".*{TEMPORARY}*")):
        if path.is_dir():
            shutil.rmtree(path, ignore_errors=True)
        else:
            path.unlink(missing_ok=True)


def _flush(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def _no_number(word: str) -> float:
    raise ValueError(f"{word} is no number")


def _finite(word: str) -> float:
    return float(word) if math.isfinite(float(word)) else _no_number(word)


def _integer(word: str) -> int:
    return int(word) if len(word) <= _MOST_DIGITS else int(_no_number(quoted(word)))


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, Path):
        return str(value)
    raise TypeError(f"{type(value).__name__} has no JSON form")


def _not_finite(value: Any, key: str = "") -> str | None:
    """Key path of the first NaN or infinity in nested data."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, float | np.floating):
        return None if math.isfinite(value) else f"{key} = {float(value)}"
    children: list[tuple[str, Any]] = []
    if isinstance(value, Mapping):
        children = [(f"{key}.{name}" if key else str(name), child) for name, child in value.items()]
    elif isinstance(value, list | tuple):
        children = [(f"{key}[{index}]", child) for index, child in enumerate(value)]
    found = (_not_finite(child, name) for name, child in children)
    return next((bad for bad in found if bad is not None), None)
