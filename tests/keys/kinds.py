"""Cases of a key: another value of it, and what the program says then."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from tests.keys.scenes import Data


@dataclass(frozen=True)
class Other:
    """Another value of a key, in a scene with these values besides; `also` are those that go with it."""

    value: Any
    beside: Data = field(default_factory=dict)
    also: Data = field(default_factory=dict)


@dataclass(frozen=True)
class Refused:
    """The value is refused with a line that has these words."""

    value: Any
    words: str
    beside: Data = field(default_factory=dict)


@dataclass(frozen=True)
class Told:
    """A line says that the value changes nothing, in a scene with these values besides."""

    value: Any
    beside: Data = field(default_factory=dict)


@dataclass(frozen=True)
class Shown:
    """A test below tests/ shows what the key does: that takes a dear solve."""

    test: str


@dataclass(frozen=True)
class Table:
    """A table of the reference.

    Attributes:
        scene: gives a scene that has it.
        place: key path of the table in that scene.
        reads: readings that may change, the cheapest first.
        keys: other values; those that are not named follow from range, choices and example.
        dear: for the slow tests.
    """

    scene: Callable[[], Data]
    place: str
    reads: str
    keys: Data = field(default_factory=dict)
    dear: bool = False
