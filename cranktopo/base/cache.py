"""The user's cache: what may be deleted at any time, and is only made again."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path


def user_cache() -> Path:
    """The folder of cranktopo in the user's cache, `$XDG_CACHE_HOME` or `~/.cache`; it may not exist.

    A user without a home, as in a container, has it among the temporary files.
    """
    given = os.environ.get("XDG_CACHE_HOME", "")
    if os.path.isabs(given):  # a relative one is to be ignored (XDG Base Directory Specification)
        return Path(given) / "cranktopo"
    try:
        return Path.home() / ".cache" / "cranktopo"
    except RuntimeError:
        return Path(tempfile.gettempdir()) / f"cranktopo-{os.getuid()}"
