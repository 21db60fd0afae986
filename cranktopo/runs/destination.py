"""Places for outputs: checked before long work, complete when they appear, held by one process."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.files import TEMPORARY, no_link, unwritable
from cranktopo.base.interruption import closed_by

LOCK = ".lock"
"""Name of the file that the process that works in a run holds."""


@contextmanager
def locked(
    folder: Path, what: str = "run", hint: str = "Wait for it to end, or stop it first."
) -> Iterator[None]:
    """Hold a run directory for the length of the block (POSIX `flock`; elsewhere no protection).

    Args:
        what: it is, for the message.
        hint: what to do where another process holds it.

    Raises:
        CranktopoError: another process holds it, or the lock file cannot be written.
    """
    try:
        import fcntl
    except ImportError:  # no flock on Windows
        yield
        return
    try:
        # closed by the `with` below: here only errors of opening are those of a file that cannot be written
        file = open(folder / LOCK, "a+", encoding="ascii", opener=no_link)  # noqa: SIM115
    except OSError as error:
        raise unwritable(folder / LOCK, error) from None
    with file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            file.seek(0)
            raise CranktopoError(
                f"{what} '{folder}': in use by process {file.read().strip() or 'unknown'}.", hint=hint
            ) from None
        file.truncate(0)
        file.write(str(os.getpid()))
        file.flush()
        yield


_MANIFEST = "manifest.json"


@contextmanager
def unfinished_folder(parent: Path) -> Iterator[Path]:
    """Give a hidden folder to work in until it is moved to its place: a kill leaves nothing half-made."""
    try:
        parent.mkdir(parents=True, exist_ok=True)
        folder = Path(tempfile.mkdtemp(prefix=".unfinished-", suffix=TEMPORARY, dir=parent))
        folder.chmod(0o755)
    except OSError as error:
        raise unwritable(parent, error) from None
    try:
        with closed_by(lambda: shutil.rmtree(folder, ignore_errors=True)):
            yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def moved(folder: Path, path: Path) -> Path:
    """Return the folder renamed to a path; an empty folder there gets the files, manifest first.

    With the manifest it is a run that resumes, whatever else a kill keeps back.
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


def check_file(path: Path, what: str, suffixes: Sequence[str] = (), replace: bool = True) -> None:
    """Check that a file can be written; raises CranktopoError.

    Args:
        what: the option that names it, or what it is, for the message.
        suffixes: endings that it may have; any when empty.
        replace: whether it may exist already.
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
    """Check that a folder is there or can be made, with files in it; raises CranktopoError."""
    existing = path
    while not existing.exists():
        existing = existing.parent
    if not existing.is_dir():
        raise CranktopoError(f"output '{path}': '{existing}' is a file.", hint="Choose another --out.")
    if not os.access(existing, os.W_OK | os.X_OK):
        raise unwritable(path, PermissionError(13, f"'{existing}' is not writable"))


def _refused(path: Path, what: str, why: str, hint: str) -> CranktopoError:
    return CranktopoError(f"{what} '{path}'{why}.", hint=hint, code=ExitCode.USAGE)
