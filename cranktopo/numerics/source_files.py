"""Digest of the files that kept machine code is made from, in place of the text that they make each time."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

NUMERICS = Path(__file__).parent


@cache
def digest_of_sources(*folders: Path) -> str:
    """Return SHA-256 (hex) over the Python files in folders, their subfolders included."""
    files = [file for folder in folders for file in sorted(folder.rglob("*.py"))]
    return hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()
