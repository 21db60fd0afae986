"""Seals: the hash of stored data inside its own file, so that data and hash are replaced as one.

What changes while the work goes on has one: a kill between two files could not part them. Files that are
written once have their hashes in the manifest of their run.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.errors import CranktopoError
from cranktopo.base.files import from_json, json_text, read_npz, write_bytes, write_npz
from cranktopo.base.notes import note

_RESULT, _SEAL, _ARRAYS = "result", "sha256", "__sha256__"
_SEAL_BYTES = 32


def seal_of(data: Mapping[str, Any], name: str) -> str:
    """Return SHA-256 (hex) over an object as JSON, keys in their order; raises CranktopoError."""
    return hashlib.sha256(json_text(data, name).encode()).hexdigest()


def sealed(result: Any, name: str) -> dict[str, Any]:
    """Return plain data with its seal, as JSON holds both; raises CranktopoError for no finite number."""
    content = {_RESULT: result}
    return {_SEAL: seal_of(content, name), **from_json(json_text(content, name))}


def unsealed(stored: Any, name: str) -> Any:
    """Return the data of `sealed`; raises ValueError where it is damaged or was changed."""
    if not isinstance(stored, dict) or _RESULT not in stored or stored != sealed(stored[_RESULT], name):
        raise ValueError(f"{name}: changed since it was written")
    return stored[_RESULT]


def write_sealed_bytes(path: Path, content: bytes) -> None:
    """Write bytes atomically behind their seal; raises CranktopoError where they cannot be written."""
    write_bytes(path, hashlib.sha256(content).digest() + content)


def read_sealed_bytes(path: Path) -> bytes | None:
    """Return the bytes of `write_sealed_bytes`; None where the file is missing, damaged or was changed."""
    try:
        found = path.read_bytes()
    except OSError:
        return None
    seal, content = found[:_SEAL_BYTES], found[_SEAL_BYTES:]
    return content if hashlib.sha256(content).digest() == seal else None


def write_arrays(path: Path, arrays: Mapping[str, NDArray[Any]], compressed: bool = False) -> None:
    """Write named arrays atomically as .npz with their seal, every bit kept; raises CranktopoError."""
    seal = np.frombuffer(_digest(arrays), dtype=np.uint8)
    write_npz(path, {**arrays, _ARRAYS: seal}, compressed)


def read_arrays(path: Path, name: str, hint: str) -> dict[str, NDArray[Any]]:
    """Return the arrays of `write_arrays`; raises CranktopoError, with the hint, where any was changed.

    A file of an older version has no seal: a line tells that it was not checked.
    """
    arrays = read_npz(path, name, hint)
    seal = arrays.pop(_ARRAYS, None)
    if seal is None:
        note(f"{name}: holds no hash of its content, so it is not checked for changes")
    elif seal.tobytes() != _digest(arrays):
        raise CranktopoError(f"{name}: changed since it was written.", hint=hint)
    return arrays


def _digest(arrays: Mapping[str, NDArray[Any]]) -> bytes:
    """Return SHA-256 over names, types, shapes and bytes, whatever the order of the arrays."""
    digest = hashlib.sha256()
    for name, array in sorted(arrays.items()):
        digest.update(f"{name} {array.dtype.str} {array.shape}\n".encode())
        digest.update(np.ascontiguousarray(array).reshape(-1).view(np.uint8).data)
    return digest.digest()
