"""Faults that pydantic finds in data, as values with names."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

UNKNOWN_KEY, MISSING = "extra_forbidden", "missing"
"""Kinds of a fault: a key that a model does not know, and a required one that is not there."""


@dataclass(frozen=True)
class Fault:
    """One fault in data.

    Attributes:
        kind: its name in pydantic, such as `missing`.
        place: keys and positions that lead to it.
        message: what pydantic says of it.
        value: what stands there.
        context: what else belongs to it, by names that depend on the kind.
    """

    kind: str
    place: tuple[int | str, ...]
    message: str
    value: Any
    context: Mapping[str, Any]

    def __str__(self) -> str:
        return f"{'.'.join(map(str, self.place))}: {self.message.lower()}"


def faults_of(error: ValidationError) -> list[Fault]:
    """Return the faults that a validation error lists, in its order."""
    return [
        Fault(found["type"], found["loc"], found["msg"], found["input"], found.get("ctx", {}))
        for found in error.errors(include_url=False)
    ]
