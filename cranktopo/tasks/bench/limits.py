"""Limits of a design as the page shows them at its gauges."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic_core import PydanticCustomError

from cranktopo.design.goal.limit import read_limits
from cranktopo.design.goal.quantities import QUANTITIES


def gauge_limits(data: Mapping[str, Any]) -> dict[str, list[dict[str, Any]]]:
    """Return the limits of `[goal.limits]` by quantity, two for a range; none that cannot be read.

    Each has its text as it is written, `sense`, and `value` in the internal unit of the quantity, or in
    percent of the original where `percent` is true.
    """
    table = (data.get("goal") or {}).get("limits") or {}
    found = {name: _readable_limits(name, table[name]) for name in QUANTITIES if name in table}
    return {name: limits for name, limits in found.items() if limits}


def _readable_limits(name: Any, value: Any) -> list[dict[str, Any]]:
    texts = value if isinstance(value, list | tuple) else [value]
    try:
        limits = read_limits(QUANTITIES[name], value)
    except PydanticCustomError:
        return []  # the form says what is wrong with it
    return [
        {"text": text.strip(), "sense": limit.sense, "value": limit.value, "percent": limit.percent}
        for text, limit in zip(texts, limits, strict=False)
    ]
