"""The user's cache: what may be deleted at any time, and is only made again."""

from __future__ import annotations

import os
import stat
import tempfile
from contextlib import suppress
from pathlib import Path

_OURS_ALONE = 0o700


def user_cache() -> Path:
    """Return the folder of cranktopo in the user's cache, `$XDG_CACHE_HOME` or `~/.cache`; it may not exist.

    A user without a home, as in a container, has it among the temporary files.
    """
    return _lasting_cache() or Path(tempfile.gettempdir()) / f"cranktopo-{os.getuid()}"


def private_cache(name: str) -> Path | None:
    """Return a folder in the user's cache that nobody else can read or write, made if it is not there.

    What is run may come from nowhere else. None where it cannot be had: the folder is another user's, others
    may use it, it is a link, or the cache would be among the temporary files, which all users share.
    """
    cache = _lasting_cache()
    if cache is None:
        return None
    folder = cache / name
    try:
        cache.mkdir(parents=True, exist_ok=True)
        with suppress(FileExistsError):
            folder.mkdir(mode=_OURS_ALONE)
        found = folder.lstat()
    except OSError:
        return None
    ours = stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid()
    return folder if ours and found.st_mode & 0o777 == _OURS_ALONE else None


def _lasting_cache() -> Path | None:
    """Return the folder in `$XDG_CACHE_HOME` or the user's home, None where there is neither."""
    given = os.environ.get("XDG_CACHE_HOME", "")
    if os.path.isabs(given):  # a relative one is to be ignored (XDG Base Directory Specification)
        return Path(given) / "cranktopo"
    try:
        return Path.home() / ".cache" / "cranktopo"
    except RuntimeError:
        return None
