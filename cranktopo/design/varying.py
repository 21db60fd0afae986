"""A scene's data with another value at a key path: what sweeps vary."""

from __future__ import annotations

import re
from typing import Any

from pydantic import ValidationError

from cranktopo.base.errors import CranktopoError, invalid, quoted
from cranktopo.design.messages import explain_unknown
from cranktopo.design.schema import Scene

_PART = re.compile(r"([A-Za-z_]\w*)((?:\[\d+\])*)")


def with_value(data: dict[str, Any], key: str, value: object) -> dict[str, Any]:
    """Return the tables of a scene with a value at a key path such as `web.pocket[0].diameter_mm`.

    A table that is not there yet is made; an entry of an array must be there.

    Raises:
        CranktopoError: no key path, or one through a value that is no table, or an entry that is missing.
    """
    return _changed(data, key_parts(key), value, key)


def value_at(data: Any, key: str) -> Any:
    """Return the value at a key path; None where there is none."""
    for part in key_parts(key):
        if isinstance(part, int):
            data = data[part] if isinstance(data, list) and part < len(data) else None
        else:
            data = data.get(part) if isinstance(data, dict) else None
    return data


def check_keys(data: dict[str, Any], source: str) -> None:
    """Refuse keys that no scene has; values are not looked at.

    Raises:
        CranktopoError: unknown keys, each with the nearest one that there is.
    """
    try:
        Scene.model_validate(data)
    except ValidationError as error:
        unknown = explain_unknown(error, source)
        if unknown is not None:
            raise unknown from None


def key_parts(key: str) -> list[str | int]:
    """Return the names and places of a key path; raises CranktopoError where it is none."""
    parts: list[str | int] = []
    for word in key.split("."):
        found = _PART.fullmatch(word)
        if found is None:
            raise invalid(
                "key", key, "must be names joined by dots, such as throw.radius_mm or web.pocket[0].y_mm"
            )
        parts += [found[1], *(int(place) for place in re.findall(r"\d+", found[2]))]
    return parts


def _changed(data: Any, parts: list[str | int], value: object, key: str) -> Any:
    if not parts:
        return value
    first, *rest = parts
    if isinstance(first, int):
        if not isinstance(data, list) or first >= len(data):
            count = len(data) if isinstance(data, list) else 0
            raise CranktopoError(
                f"{key}: there is no entry [{first}]; the design has {count}.",
                hint="Entries count from 0; add it to the design first.",
            )
        return [_changed(item, rest, value, key) if n == first else item for n, item in enumerate(data)]
    if data is None:
        data = {}
    if not isinstance(data, dict):
        raise CranktopoError(
            f"{key}: '{first}' is asked of {quoted(data)}, which is no table.", hint="Check the key."
        )
    return {**data, first: _changed(data.get(first), rest, value, key)}
