"""What limits and rules cost at the optimum, in words: `1 % more torsion costs 0.31 % mass`."""

from __future__ import annotations

from collections.abc import Iterator

from cranktopo.report.result_table import ResultTable
from cranktopo.tasks.shape.result import ShapeResult

_MINIMUM_PERCENT = 5e-4
"""A price below it counts as none."""
_LOOSE_PERCENT = 30.0
"""Part of the goal's gradient that the prices leave unexplained, above which this is said."""
_UNITS = {"mm": "1 mm", "deg": "1 degree", "%": "1 %"}


def multiplier_text(found: ShapeResult) -> list[str]:
    """Return what one percent of each limit costs in the goal, then what a unit of each rule would give."""
    doubt = multiplier_doubt(found)
    return [*(f"{moved} {effect}" for moved, effect in _multipliers(found)), *([doubt] if doubt else [])]


def multiplier_table(found: ShapeResult) -> ResultTable:
    """Return the same as a table, one row each."""
    rows = tuple({"a_move_of": moved, "the_goal": effect} for moved, effect in _multipliers(found))
    return ResultTable({"a_move_of": 0, "the_goal": 0}, rows)


def multiplier_doubt(found: ShapeResult) -> str:
    """Return what is said where the prices do not explain the optimum; empty else."""
    rest = found.prices_remainder_percent
    if rest <= _LOOSE_PERCENT:
        return ""
    return f"prices explain {100 - rest:.0f} % of what the goal still wants: it is not quite the best web"


def _multipliers(found: ShapeResult) -> Iterator[tuple[str, str]]:
    """Yield what is moved, and what the goal makes of it."""
    name = found.goal.quantity.name.replace("_", " ")
    for price in found.prices:
        way, cost = "less" if price.sense == "<=" else "more", price.goal_percent_per_percent
        nothing = "costs nothing: this limit does not decide"
        effect = nothing if cost < _MINIMUM_PERCENT else f"costs {cost:.2f} % {name}"
        yield f"1 % {way} {price.quantity.replace('_', ' ')}", effect
    rules = [rule for rule in found.rule_prices if rule.goal_percent_per_unit >= _MINIMUM_PERCENT]
    better = "less" if found.goal.minimise else "more"
    for rule in sorted(rules, key=lambda rule: (-round(rule.goal_percent_per_unit, 6), rule.name)):
        effect = f"would give {rule.goal_percent_per_unit:.2f} % {better} {name}"
        yield f"{_UNITS[rule.unit]} of '{rule.name}'", effect
