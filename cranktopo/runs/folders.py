"""Folders that appear only when they are complete."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from cranktopo.base.files import TEMPORARY, unwritable

_MANIFEST = "manifest.json"


@contextmanager
def unfinished_folder(parent: Path) -> Iterator[Path]:
    """A hidden folder to work in until it is moved to its place: a kill before that leaves nothing half-made.

    Raises:
        CranktopoError: `parent` cannot be made or written.
    """
    try:
        parent.mkdir(parents=True, exist_ok=True)
        folder = Path(tempfile.mkdtemp(prefix=".unfinished-", suffix=TEMPORARY, dir=parent))
        folder.chmod(0o755)
    except OSError as error:
        raise unwritable(parent, error) from None
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def moved(folder: Path, path: Path) -> Path:
    """The folder renamed to a path; an empty folder there keeps its place and gets the files, manifest first.

    With the manifest it is a run that resumes, whatever else a kill keeps back.

    Raises:
        CranktopoError: the path is taken, or cannot be written.
    """
    try:
        if path.is_dir():
            for name in sorted(os.listdir(folder), key=lambda name: name != _MANIFEST):
                os.replace(folder / name, path / name)
        else:
            os.rename(folder, path)
    except OSError as error:
        raise unwritable(path, error) from None
    return path
