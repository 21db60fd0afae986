"""Tables of designs that are the same but for the last digits of their numbers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

_ALIKE = 1e-5
"""Share of a dimension in which webs of two half throws are one; those of triangles are rounded."""


def dumped(table: Any) -> dict[str, Any]:
    """Return a table of a design as plain data, without what is as by default."""
    return dict(table.model_dump(mode="json", exclude_none=True, exclude_defaults=True, by_alias=True))


def alike(one: Any, other: Any) -> bool:
    """Tell whether tables are the same, and their numbers nearly."""
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return one.keys() == other.keys() and all(alike(one[key], other[key]) for key in one)
    if isinstance(one, list | tuple) and isinstance(other, list | tuple):
        tables = all(isinstance(item, Mapping) for item in (*one, *other))
        found = (
            (any(alike(item, twin) for twin in other) for item in one) if tables else map(alike, one, other)
        )
        return len(one) == len(other) and all(found)
    if isinstance(one, float) and isinstance(other, float):
        return abs(one - other) <= _ALIKE * max(abs(one), abs(other), 1.0)
    return bool(one == other)
