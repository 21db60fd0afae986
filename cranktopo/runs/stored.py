"""Files in run directories by their paths: recorded in the manifest when written, checked when read."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Sequence
from pathlib import Path

from cranktopo.base.errors import CranktopoError
from cranktopo.base.files import text_bytes, write_bytes
from cranktopo.base.notes import note
from cranktopo.runs.directories import MANIFEST, RunStore
from cranktopo.runs.manifest import file_hash

_DEPTH = 2
"""Levels of folders between a file and its run, at most: `points/ID`."""


def unchanged(path: Path) -> Path:
    """Return the path of a file; raises CranktopoError where a run wrote it and it was changed since."""
    if path.is_file() and (owner := _owner(path)):
        run, name = owner
        run.recorded(name)
    return path


def told_where_changed(path: Path) -> Path:
    """Return the path of a design that is asked for itself; a line tells where a run wrote another text."""
    try:
        unchanged(path)
    except CranktopoError:
        note(f"'{path}': changed since its run wrote it, taken as it is now; the run is what it was")
    return path


def unchanged_result(path: Path) -> Path:
    """Return the path of a file that a run wrote, as `unchanged`; a line tells where it has no hash of it."""
    if owner := _owner(path):
        run, name = owner
        run.unchanged(name)
    return path


def write_recorded(path: Path, text: str, beside: Sequence[str] = ()) -> None:
    """Write a text file of a run; one that is in no run is written as any other.

    The manifest has the hash first: a kill in between leaves no file that is not recorded, and whoever
    resumes writes the missing one again.

    Args:
        beside: names of files of the same folder, there already, that are recorded with it.

    Raises:
        CranktopoError: a file cannot be written, or one beside it cannot be read.
    """
    content = text_bytes(text)
    if owner := _owner(path):
        run, name = owner
        folder = name[: -len(path.name)]
        digests = {f"{folder}{other}": file_hash(path.with_name(other)) for other in beside}
        run.record({**digests, name: hashlib.sha256(content).hexdigest()})
    write_bytes(path, content)


def record_folder(folder: Path, place: Path) -> None:
    """Record the files of a folder in the run that has its place, to which it is moved next.

    A place in no run is left alone.
    """
    files = [file for file in sorted(folder.rglob("*")) if file.is_file()]
    if files and (owner := _owner(place / "file")):
        run, name = owner
        top = name[: -len("file")]
        run.record({f"{top}{file.relative_to(folder).as_posix()}": file_hash(file) for file in files})


def _owner(path: Path) -> tuple[RunStore, str] | None:
    """Return the run that a file belongs to, and the file's name in it; None where there is none.

    A manifest that cannot be used is that of another program, or of a run that no command opens.
    """
    place = Path(os.path.realpath(path))
    for folder in place.parents[: _DEPTH + 1]:
        if (folder / MANIFEST).is_file():
            try:
                RunStore(folder).manifest()
            except CranktopoError:
                return None
            return RunStore(folder), place.relative_to(folder).as_posix()
    return None
