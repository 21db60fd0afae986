"""What limits and rules cost at the optimum, in words: `1 % more torsion costs 0.31 % mass`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cranktopo.report.tables.result_table import ResultTable

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
    goal = data["goal"]
    name = (goal.get("minimise") or goal["maximise"]).replace("_", " ")
    costs = [_limit_words(price, name) for price in data["prices"]]
    gives = [f"{_UNITS[r['unit']]} of {_quoted(r)} would give {_gain(r, goal, name)}" for r in _rules(data)]
    rest = data.get("prices_remainder_percent", 0.0)
    doubt = f"prices explain {100 - rest:.0f} % of what the goal still wants: it is not quite the best web"
    return [*costs, *gives, *([doubt] if rest > _LOOSE_PERCENT else [])]


def rule_prices_table(data: Mapping[str, Any]) -> ResultTable:
    """What a unit of each rule or bound that holds the web would give in the goal."""
    columns = {"rule_or_bound": 0, "unit": 0, "goal_percent_per_unit": 3}
    rows = tuple(
        {"rule_or_bound": r["name"], "unit": r["unit"], "goal_percent_per_unit": r["goal_percent_per_unit"]}
        for r in _rules(data)
    )
    return ResultTable(columns, rows)


def _rules(data: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    found = [r for r in data.get("rule_prices", ()) if r["goal_percent_per_unit"] >= _LEAST_PERCENT]
    return sorted(found, key=lambda r: (-round(r["goal_percent_per_unit"], 6), r["name"]))


def _quoted(rule: Mapping[str, Any]) -> str:
    return f"'{rule['name']}'"


def _limit_words(price: Mapping[str, Any], goal: str) -> str:
    quantity, cost = price["quantity"].replace("_", " "), price["goal_percent_per_percent"]
    way = "less" if price.get("sense") == "<=" else "more"
    if cost < _LEAST_PERCENT:
        return f"1 % {way} {quantity} costs nothing: this limit does not decide"
    return f"1 % {way} {quantity} costs {cost:.2f} % {goal}"


def _gain(rule: Mapping[str, Any], goal: Mapping[str, Any], name: str) -> str:
    way = "less" if "minimise" in goal else "more"
    return f"{rule['goal_percent_per_unit']:.2f} % {way} {name}"
