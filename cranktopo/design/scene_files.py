"""Files that a scene names, relative to its own: found, made absolute, named anew from another folder."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from cranktopo.design.crank import OWN_THROW
from cranktopo.design.schema import Scene

FILE_KEYS = (
    ("engine", "gas", "indicator_csv"),
    ("engine", "gas", "map", "file"),
    ("envelope", "file"),
    ("envelope", "frozen", "file"),
    ("envelope", "removable", "file"),
    ("original", "file"),
    ("original", "second_file"),
    ("crank", "throws"),
    ("crank", "end", "step", "file"),
)
"""Keys of a scene that name a file, or several; lists on the way are gone through."""


def with_resolved_files(data: dict[str, Any], folder: Path) -> dict[str, Any]:
    """The tables of a scene with file names made absolute; data of a wrong type is left for validation."""
    for keys in FILE_KEYS:
        data = _replaced(data, keys, lambda name: os.path.realpath(folder / name))
    return data


def _replaced(data: Any, keys: tuple[str, ...], change: Callable[[str], str]) -> Any:
    if isinstance(data, list):
        return [_replaced(item, keys, change) for item in data]
    if not keys:
        return change(data) if isinstance(data, str) and "\0" not in data and data != OWN_THROW else data
    if not isinstance(data, dict) or keys[0] not in data:
        return data
    return {**data, keys[0]: _replaced(data[keys[0]], keys[1:], change)}


def input_files(scene: Scene | Mapping[str, Any]) -> dict[str, Path]:
    """Files that a scene, or its plain tables, refers to, by dotted key."""
    found = (pair for keys in FILE_KEYS for pair in _files(scene, keys, ""))
    return {key: Path(name) for key, name in found}


def _files(value: Any, keys: tuple[str, ...], path: str) -> Iterator[tuple[str, str]]:
    if isinstance(value, tuple | list):
        for index, item in enumerate(value):
            yield from _files(item, keys, f"{path}[{index}]")
    elif keys:
        below = value.get(keys[0]) if isinstance(value, Mapping) else getattr(value, keys[0], None)
        yield from _files(below, keys[1:], f"{path}.{keys[0]}".lstrip("."))
    elif isinstance(value, str) and value != OWN_THROW:
        yield path, value


def name_from(document: Any, source: Path, target: Path) -> None:
    """Make the file names of a TOML document absolute that do not mean the same in another folder."""
    for keys in FILE_KEYS:
        _name_from(document, keys, source, target)


def _name_from(document: Any, keys: tuple[str, ...], source: Path, target: Path) -> None:
    key, *rest = keys
    value = document.get(key)
    items = value if isinstance(value, list) else [] if value is None else [value]
    for index, item in enumerate(items):
        if rest:
            _name_from(item, tuple(rest), source, target)
        elif item != OWN_THROW and (source / item).resolve() != (target / item).resolve():
            absolute = str((source / item).resolve())
            if isinstance(value, list):
                value[index] = absolute
            else:
                document[key] = absolute
