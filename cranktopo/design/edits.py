"""Changes of a design by key path, in its text with the comments kept, and in its plain tables."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping, MutableMapping
from typing import Any

from cranktopo.base.errors import CranktopoError, quoted
from cranktopo.base.units import stem_and_unit
from cranktopo.design.loading import key_parts
from cranktopo.design.toml_text import parse_toml

MOST_CHANGES = 200


def changed_data(data: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return the tables of a design with values at key paths; None takes a key, a table or an entry away.

    An entry right behind the last one of an array is added.
    """
    found: dict[str, Any] = copy.deepcopy(dict(data))
    for key, value in _checked(changes).items():
        _put(found, key, value)
    return found


def changed_text(text: str, changes: Mapping[str, Any], source: str) -> str:
    """Return the text of a design with the same changes; its comments stay."""
    import tomlkit

    document: Any = tomlkit.parse(text)
    changed = changed_data(parse_toml(text, source), changes)
    try:
        for key, value in changes.items():
            _put(document, key, value)
        new = tomlkit.dumps(document)
        if parse_toml(new, source) == changed:
            return new
    except (KeyError, ValueError, TypeError, AttributeError, tomlkit.exceptions.TOMLKitError):
        pass  # a layout of tables that the comment-keeping writer cannot follow
    return tomlkit.dumps(changed)


def difference_words(before: Mapping[str, Any], after: Mapping[str, Any], most: int = 8) -> str:
    """Return what differs between the tables of two designs, key by key; empty where nothing does."""
    pairs = differing_values(before, after)
    lines = [f"{key}: {_value_text(old)} to {_value_text(new)}" for key, (old, new) in pairs.items()]
    return "; ".join([*lines[:most], *([f"and {len(pairs) - most} more"] if len(pairs) > most else [])])


def differing_values(before: Mapping[str, Any], after: Mapping[str, Any]) -> dict[str, tuple[Any, Any]]:
    """Return the values of two designs by each key path at which they differ; None where one has none."""
    old, new = dict(_values(before)), dict(_values(after))
    keys = dict.fromkeys((*old, *new))
    return {key: (old.get(key), new.get(key)) for key in keys if old.get(key) != new.get(key)}


def _values(tables: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield each value of tables with its key path."""
    if isinstance(tables, Mapping):
        for name, value in tables.items():
            yield from _values(value, f"{path}.{name}" if path else name)
    elif isinstance(tables, list) and tables and all(isinstance(entry, Mapping) for entry in tables):
        for number, entry in enumerate(tables):
            yield from _values(entry, f"{path}[{number}]")
    else:
        yield path, tables


def _value_text(value: Any) -> str:
    return "none" if value is None else f"{value:g}" if isinstance(value, float) else str(value)


def _checked(changes: Mapping[str, Any]) -> Mapping[str, Any]:
    if len(changes) > MOST_CHANGES:
        raise CranktopoError(f"{len(changes)} changes at once; at most {MOST_CHANGES}.")
    return changes


def _put(tables: Any, key: str, value: Any) -> None:
    *path, last = key_parts(key)
    for part, after in zip(path, [*path[1:], last] if path else [], strict=True):
        if isinstance(part, str) and part not in tables:
            if value is None:
                return
            tables[part] = [] if isinstance(after, int) else {}
        try:
            tables = tables[part]
        except (IndexError, KeyError, TypeError):
            raise CranktopoError(f"{key}: there is no such entry.", hint="Add it first.") from None
    if value is None:
        _remove(tables, last)
    elif isinstance(last, int):
        if not isinstance(tables, list) or last > len(tables):
            raise CranktopoError(f"{key}: there is no such entry.", hint="Add it first.")
        if last == len(tables):
            tables.append(value)
        else:
            tables[last] = value
    elif not isinstance(tables, MutableMapping):
        raise CranktopoError(f"{key}: is asked of {quoted(tables)}, which is no table.")
    else:
        tables[last] = _as_written(last, value)


def _remove(tables: Any, last: str | int) -> None:
    if isinstance(last, int):
        if isinstance(tables, list) and last < len(tables):
            del tables[last]
    elif isinstance(tables, MutableMapping) and last in tables:
        del tables[last]


def _as_written(name: str, value: Any) -> Any:
    """Return a value with a unit as a number with a point: 20.0, as designs have it."""
    whole = isinstance(value, int) and not isinstance(value, bool)
    return float(value) if whole and stem_and_unit(name)[1] else value
