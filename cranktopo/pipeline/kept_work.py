"""Finished parts of a long work, kept in its run so that a resumed one does not repeat them."""

from __future__ import annotations

from collections.abc import Iterator, MutableMapping
from pathlib import Path
from typing import Any

from cranktopo.shape.work import Json
from cranktopo.store import read_json, write_json


class KeptWork(MutableMapping[str, Json]):
    """Results of finished parts by name in a file, written at every one."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._data: dict[str, Any] = read_json(path) if path.is_file() else {}

    def __getitem__(self, key: str) -> Json:
        found: Json = self._data[key]
        return found

    def __setitem__(self, key: str, value: Json) -> None:
        self._data[key] = value
        write_json(self._path, self._data)

    def __delitem__(self, key: str) -> None:
        del self._data[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._data)

    def __len__(self) -> int:
        return len(self._data)
