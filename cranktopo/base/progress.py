"""Long work in parts: results that it keeps so that it can be continued."""

from __future__ import annotations

from collections.abc import Callable, Iterator, MutableMapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from cranktopo.base.errors import CranktopoError
from cranktopo.base.files import read_json, write_json
from cranktopo.base.notes import note
from cranktopo.base.result import Result
from cranktopo.base.seals import sealed, unsealed

Json = dict[str, Any]
Kept = TypeVar("Kept", bound=Result)


_NAME = "work"


@dataclass(frozen=True)
class StageMemory:
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

    def once_as(self, kind: type[Kept], name: str, make: Callable[[], Kept]) -> Kept:
        """Return the result of a part as `once`, as what is its own JSON."""
        return kind.of_json(self.once(name, lambda: make().as_json()), f"part '{name}'")


class StageCache(MutableMapping[str, Json]):
    """Results of finished parts by name in a file of a run, each with its digest, written at every one.

    What was damaged meanwhile is left out, so that it is done again.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._data: dict[str, Json] = {}
        try:
            stored = read_json(path) if path.is_file() else {}
        except CranktopoError:
            stored = None
        for name, part in (stored or {}).items():
            with suppress(ValueError, CranktopoError):
                self._data[name] = unsealed(part, _NAME)
        if stored is None or len(self._data) < len(stored):
            note(f"'{path}': damaged; what is missing is done again")

    def __getitem__(self, key: str) -> Json:
        return self._data[key]

    def __setitem__(self, key: str, value: Json) -> None:
        self._data[key] = value
        write_json(self._path, {name: sealed(result, _NAME) for name, result in self._data.items()})

    def __delitem__(self, key: str) -> None:
        del self._data[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._data)

    def __len__(self) -> int:
        return len(self._data)


def resumable_memory(path: Path, check: Callable[[], None]) -> StageMemory:
    """Return the memory of a long work that keeps its parts in a file."""
    return StageMemory(StageCache(path), check)
