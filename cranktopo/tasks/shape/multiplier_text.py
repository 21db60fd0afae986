"""What limits and rules cost at the optimum, in words: `1 % more torsion costs 0.31 % mass`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from cranktopo.report.result_table import ResultTable

_LEAST_PERCENT = 5e-4
"""A price below it counts as none."""
_LOOSE_PERCENT = 30.0
"""Part of the goal's gradient that the prices leave unexplained, above which this is said."""
_UNITS = {"mm": "1 mm", "deg": "1 degree", "%": "1 %"}


def price_sentences(data: Mapping[str, Any]) -> list[str]:
    """What one percent of each limit costs in the goal, then what a unit of each rule or bound would give.

    Args:
        data: as shape.json holds it.
    """
    doubt = prices_doubt(data)
    return [*(f"{moved} {worth}" for moved, worth in _prices(data)), *([doubt] if doubt else [])]


def prices_table(data: Mapping[str, Any]) -> ResultTable:
    """The same as a table, one row each."""
    rows = tuple({"a_move_of": moved, "the_goal": worth} for moved, worth in _prices(data))
    return ResultTable({"a_move_of": 0, "the_goal": 0}, rows)


def prices_doubt(data: Mapping[str, Any]) -> str:
    """Said where the prices do not explain the optimum; empty else."""
    rest = data.get("prices_remainder_percent", 0.0)
    if rest <= _LOOSE_PERCENT:
        return ""
    return f"prices explain {100 - rest:.0f} % of what the goal still wants: it is not quite the best web"


def _prices(data: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """What is moved, and what the goal makes of it."""
    goal = data["goal"]
    name = (goal.get("minimise") or goal["maximise"]).replace("_", " ")
    for price in data["prices"]:
        way, cost = "less" if price.get("sense") == "<=" else "more", price["goal_percent_per_percent"]
        nothing = "costs nothing: this limit does not decide"
        worth = nothing if cost < _LEAST_PERCENT else f"costs {cost:.2f} % {name}"
        yield f"1 % {way} {price['quantity'].replace('_', ' ')}", worth
    rules = [r for r in data.get("rule_prices", ()) if r["goal_percent_per_unit"] >= _LEAST_PERCENT]
    better = "less" if "minimise" in goal else "more"
    for rule in sorted(rules, key=lambda r: (-round(r["goal_percent_per_unit"], 6), r["name"])):
        worth = f"would give {rule['goal_percent_per_unit']:.2f} % {better} {name}"
        yield f"{_UNITS[rule['unit']]} of '{rule['name']}'", worth
