"""Checkpoint of a long computation: arrays and a small state in one file that is whole or absent.

The new file replaces the old one by a rename, so a process killed at any moment leaves one of the two. A
checksum over names, types, shapes and bytes is verified on loading.
"""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.errors import CranktopoError
from cranktopo.store.files import json_text, unwritable, write_npz

SCHEMA_VERSION = 1
_STATE, _CHECKSUM = "__state__", "__sha256__"


@dataclass(frozen=True)
class Checkpoint:
    """What was saved.

    Attributes:
        arrays: by name, bit for bit as they were saved.
        state: plain values.
    """

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
    content[_CHECKSUM] = np.frombuffer(_digest(content), dtype=np.uint8)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise unwritable(path, error) from None
    write_npz(path, content)


def load_checkpoint(path: Path) -> Checkpoint:
    """Load and verify a checkpoint.

    Args:
        path: the .npz file.

    Raises:
        CranktopoError: missing, corrupted, of another version.
    """
    content = _read(path)
    missing = [name for name in (_STATE, _CHECKSUM) if name not in content]
    if missing:
        raise _bad(path, f"incomplete, {', '.join(missing)} missing")
    checksum = content.pop(_CHECKSUM).tobytes()
    if checksum != _digest(content):
        raise _bad(path, "corrupted, its checksum does not match its content")
    saved = json.loads(content.pop(_STATE).tobytes().decode("utf-8"))
    if saved["schema_version"] != SCHEMA_VERSION:
        raise _bad(path, f"schema_version {saved['schema_version']}, this program reads {SCHEMA_VERSION}")
    return Checkpoint(arrays=content, state=saved["state"])


def _read(path: Path) -> dict[str, NDArray[Any]]:
    try:
        content = path.read_bytes()
    except FileNotFoundError:
        raise _bad(path, "missing: the run stopped before its first checkpoint") from None
    except OSError as error:
        raise _bad(path, f"cannot be read: {error.strerror}") from None
    try:
        with np.load(io.BytesIO(content), allow_pickle=False) as file:
            return {name: file[name] for name in file.files}
    except Exception as error:  # zipfile and numpy raise a dozen types on damaged bytes, all meaning this
        raise _bad(path, f"corrupted, cannot be read ({error})") from None


def _bad(path: Path, what: str) -> CranktopoError:
    return CranktopoError(f"checkpoint '{path}': {what}.", hint="Start a new run of the design.")


def _digest(content: Mapping[str, NDArray[Any]]) -> bytes:
    digest = hashlib.sha256()
    for name in sorted(content):
        array = content[name]
        digest.update(f"{name}|{array.dtype.str}|{array.shape}|".encode())
        digest.update(array.tobytes())
    return digest.digest()
