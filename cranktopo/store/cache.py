"""The user's cache: what may be deleted at any time, and is only made again."""

from __future__ import annotations

import os
from pathlib import Path


def user_cache() -> Path:
    """The folder of cranktopo in the user's cache, `$XDG_CACHE_HOME` or `~/.cache`; it may not exist."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "cranktopo"
