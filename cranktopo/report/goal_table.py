"""What was wanted and what was reached, as `goal` of metrics.json holds it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cranktopo.design.goal.outcome import ACTIVE
from cranktopo.design.goal.quantities import QUANTITIES, GoalQuantity
from cranktopo.report.result_table import Column, ResultTable, tabulate

_Entry = Mapping[str, Any]


def goal_line(goal: _Entry, reference: str = "the original web") -> str:
    """The goal and its value: `least mass: 1.407 kg, 88.6 % of the original web`."""
    line = f"{goal_words(goal)}: {value_text(goal['reached'], quantity_of(goal).unit)}"
    percent = goal["reached_percent"]
    line = line if percent is None else f"{line}, {percent:.1f} % of {reference}"
    better = {**goal, **goal["evaluation"]} if "evaluation" in goal else None
    return (
        line if better is None else f"{line}; by the evaluation {_reached({**better, 'unit': goal['unit']})}"
    )


def evaluation_note(goal: _Entry) -> str:
    """What the evaluated columns of the limits are; empty for a goal that was not evaluated."""
    if "evaluation" not in goal:
        return ""
    size = goal["evaluation"]["element_size_mm"]
    return (
        f"evaluated: the extracted surface on body-fitted elements of {size:.3g} mm, in percent of the "
        "original web without fillets, since a density has none; these decide whether a limit holds"
    )


def goal_words(goal: _Entry) -> str:
    """The goal without its value: `least mass`."""
    return f"{'least' if 'minimise' in goal else 'largest'} {quantity_of(goal).label}"


def quantity_of(goal: _Entry) -> GoalQuantity:
    """The quantity that is minimised or maximised."""
    return QUANTITIES[goal.get("minimise") or goal["maximise"]]


def percent_line(goal: _Entry) -> str:
    """Goal and limits in percent of the original where that is known: `mass 87.0 %, torsion 100.1 %`."""
    own = {**goal, "quantity": quantity_of(goal).name}
    told = [entry for entry in (own, *goal["limits"]) if entry["reached"] is not None]
    texts = (f"{entry['quantity'].replace('_', ' ')} {_reached(entry)}" for entry in told)
    return ", ".join(dict.fromkeys(texts))


def limits_table(goal: _Entry) -> ResultTable:
    """One row per limit: what is required, what was reached, and whether it holds."""
    evaluated = any("evaluation" in entry for entry in goal["limits"])
    return tabulate((*_COLUMNS[:-1], *_EVALUATED, _COLUMNS[-1]) if evaluated else _COLUMNS, goal["limits"])


def broken_limits(goal: _Entry) -> list[str]:
    """The limits that do not hold, with what was reached, by the evaluation where there is one."""
    broken = ({**entry, **entry.get("evaluation", {})} for entry in goal["limits"] if entry["holds"] is False)
    return [f"{_limit(entry)}: reached {value_text(entry['reached'], entry['unit'])}" for entry in broken]


def unjudged_line(goal: _Entry) -> str:
    """Which limits could not be judged and why, where an evaluation of them failed; else empty."""
    if "not_evaluated" not in goal:
        return ""
    limits = ", ".join(_limit(entry) for entry in goal["limits"] if entry["reached"] is not None)
    return (
        f"not judged: {limits}: the evaluation failed, {goal['not_evaluated'].rstrip('.')}; "
        "the limits hold in the cells only"
    )


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


def _reached(entry: _Entry) -> str:
    percent = entry["reached_percent"]
    return value_text(entry["reached"], entry["unit"]) if percent is None else f"{percent:.1f} %"


def _holds(entry: _Entry) -> str:
    if entry["holds"] is None:
        return "not told"
    return (f"yes, within {100 * ACTIVE:g} %" if entry["active"] else "yes") if entry["holds"] else "NO"


_COLUMNS: tuple[Column[_Entry], ...] = (
    Column("limit", 0, _limit),
    Column("reached", 0, lambda entry: value_text(entry["reached"], entry["unit"])),
    Column("required_percent", 1, lambda entry: entry["required_percent"]),
    Column("reached_percent", 1, lambda entry: entry["reached_percent"]),
    Column("holds", 0, _holds),
)
_EVALUATED: tuple[Column[_Entry], ...] = (
    Column("evaluated", 0, lambda entry: value_text(entry["evaluation"]["reached"], entry["unit"])),
    Column("evaluated_percent", 1, lambda entry: entry["evaluation"]["reached_percent"]),
)
