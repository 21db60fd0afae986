"""The table of where commands spend their time names functions that are there."""

from __future__ import annotations

import importlib
from typing import Any

from tests.benchmarks.command_parts import PARTS


def test_every_part_is_there() -> None:
    missing = list[str]()
    for place, names in (place for places in PARTS.values() for place in places):
        module, _, inner = place.partition(":")
        owner: Any = importlib.import_module(module)
        owner = getattr(owner, inner) if inner else owner
        missing += [f"{place}.{name}" for name in names if not hasattr(owner, name)]
    assert not missing
