"""Long work in parts: results that it keeps so that it can be continued."""

from __future__ import annotations

from collections.abc import Callable, Iterator, MutableMapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from cranktopo.base.files import read_json, write_json

Json = dict[str, Any]


@dataclass(frozen=True)
class Work:
    """Memory of one long work, such as an optimisation of dimensions.

    It stands beside the files of runs, so that whoever does the work need not know where it is kept.

    Attributes:
        kept: results of finished parts by name, plain data; filled as the work goes on. With what an
            interrupted work kept, the same parts are not done again, and the result is the same.
        check: called between parts; raises KeyboardInterrupt where Ctrl-C was pressed.
    """

    kept: MutableMapping[str, Json] = field(default_factory=dict)
    check: Callable[[], None] = lambda: None

    def once(self, name: str, make: Callable[[], Json]) -> Json:
        """Return the result of a part, made only if it is not kept yet."""
        if name not in self.kept:
            self.kept[name] = make()
            self.check()
        return self.kept[name]


class KeptWork(MutableMapping[str, Json]):
    """Results of finished parts by name in a file of a run, written at every one."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._data: dict[str, Json] = read_json(path) if path.is_file() else {}

    def __getitem__(self, key: str) -> Json:
        return self._data[key]

    def __setitem__(self, key: str, value: Json) -> None:
        self._data[key] = value
        write_json(self._path, self._data)

    def __delitem__(self, key: str) -> None:
        del self._data[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._data)

    def __len__(self) -> int:
        return len(self._data)
