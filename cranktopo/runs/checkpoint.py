"""Checkpoint of a long computation: arrays and a small state in one file that is whole or absent.

The new file replaces the old one by a rename, so a process killed at any moment leaves one of the two. The
zip format's own checksums are verified on loading.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.errors import CranktopoError, quoted
from cranktopo.base.files import json_text, read_npz, unwritable, write_npz

SCHEMA_VERSION = 1
_HINT = "Start a new run of the design."
_STATE = "__state__"


@dataclass(frozen=True)
class Checkpoint:
    """What was saved: arrays by name, bit for bit, and a state of plain values."""

    arrays: dict[str, NDArray[Any]]
    state: dict[str, Any]


def save_checkpoint(path: Path, arrays: Mapping[str, NDArray[Any]], state: Mapping[str, Any]) -> None:
    """Save arrays and a plain state; the previous file stays until the new one is complete.

    Args:
        path: the .npz file; its folder is made when missing.
        arrays: by name, any shape, numbers or booleans, kept bit for bit.
        state: plain values with a JSON form, all finite.

    Raises:
        CranktopoError: a state value is not finite, or the file cannot be written.
    """
    text = json_text({"schema_version": SCHEMA_VERSION, "state": dict(state)}, path.name)
    content = {name: np.asarray(array, order="C") for name, array in arrays.items()}
    content[_STATE] = np.frombuffer(text.encode("utf-8"), dtype=np.uint8)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise unwritable(path, error) from None
    write_npz(path, content)


def load_checkpoint(path: Path) -> Checkpoint:
    """Load and verify a checkpoint.

    Raises:
        CranktopoError: missing, corrupted, of another version.
    """
    if not path.exists():
        raise _bad(path, "missing: the run stopped before its first checkpoint")
    content = read_npz(path, f"checkpoint '{path}'", _HINT)
    if _STATE not in content:
        raise _bad(path, f"incomplete, {_STATE} missing")
    try:
        saved = json.loads(content.pop(_STATE).tobytes().decode("utf-8"))
        version, state = saved["schema_version"], dict(saved["state"])
    except (ValueError, KeyError, TypeError):
        raise _bad(path, f"corrupted, {_STATE} cannot be read") from None
    if version != SCHEMA_VERSION:
        raise _bad(path, f"schema_version {quoted(version)}, this program reads {SCHEMA_VERSION}")
    return Checkpoint(arrays=content, state=state)


def _bad(path: Path, what: str) -> CranktopoError:
    return CranktopoError(f"checkpoint '{path}': {what}.", hint=_HINT)
