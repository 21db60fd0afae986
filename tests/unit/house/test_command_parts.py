"""The tables of where and when commands spend their time name functions that are there."""

from __future__ import annotations

import importlib
from typing import Any

from tests.benchmarks import command_timeline
from tests.benchmarks.command_parts import PARTS


def test_every_part_is_there() -> None:
    missing = list[str]()
    parts = (place for places in PARTS.values() for place in places)
    for place, names in (*parts, *command_timeline.PARTS.items()):
        module, _, inner = place.partition(":")
        owner: Any = importlib.import_module(module)
        owner = getattr(owner, inner) if inner else owner
        missing += [f"{place}.{name}" for name in names if not hasattr(owner, name)]
    assert not missing
