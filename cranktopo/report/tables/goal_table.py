"""What was wanted and what was reached, as `goal` of metrics.json holds it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cranktopo.report.tables.result_table import Column, ResultTable, tabulate
from cranktopo.scene.goal import QUANTITIES, GoalQuantity

_Entry = Mapping[str, Any]


def goal_line(goal: _Entry, reference: str = "the original web") -> str:
    """The goal and its value: `least mass: 1.407 kg, 88.6 % of the original web`."""
    quantity = quantity_of(goal)
    line = f"{goal_words(goal)}: {value_text(goal['reached'], quantity.unit)}"
    percent = goal["reached_percent"]
    return line if percent is None else f"{line}, {percent:.1f} % of {reference}"


def goal_words(goal: _Entry) -> str:
    """The goal without its value: `least mass`."""
    return f"{'least' if 'minimise' in goal else 'largest'} {quantity_of(goal).label}"


def quantity_of(goal: _Entry) -> GoalQuantity:
    """The quantity that is minimised or maximised."""
    return QUANTITIES[goal.get("minimise") or goal["maximise"]]


def limits_table(goal: _Entry) -> ResultTable:
    """One row per limit: what is required, what was reached, and whether it holds."""
    return tabulate(_COLUMNS, goal["limits"])


def broken_limits(goal: _Entry) -> list[str]:
    """The limits that do not hold, with what was reached."""
    return [
        f"{_limit(entry)}: reached {value_text(entry['reached'], entry['unit'])}"
        for entry in goal["limits"]
        if entry["holds"] is False
    ]


def value_text(value: float | None, unit: str) -> str:
    """A value with its unit, large ones without decimals; a dash for what is not known."""
    if value is None:
        return "-"
    number = f"{value:,.0f}" if abs(value) >= 1e4 else f"{value:.4g}"
    return f"{number} {unit}".rstrip()


def _limit(entry: _Entry) -> str:
    if entry["required"] is None:
        return f"{entry['quantity']} {entry['sense']} {entry['required_percent']:g} %"
    return f"{entry['quantity']} {entry['sense']} {value_text(entry['required'], entry['unit'])}"


def _holds(entry: _Entry) -> str:
    if entry["holds"] is None:
        return "not told"
    return ("yes, decides" if entry["active"] else "yes") if entry["holds"] else "NO"


_COLUMNS: tuple[Column[_Entry], ...] = (
    Column("limit", 0, _limit),
    Column("reached", 0, lambda entry: value_text(entry["reached"], entry["unit"])),
    Column("required_percent", 1, lambda entry: entry["required_percent"]),
    Column("reached_percent", 1, lambda entry: entry["reached_percent"]),
    Column("holds", 0, _holds),
)
