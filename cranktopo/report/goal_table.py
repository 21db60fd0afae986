"""Goal and limits with what was reached, as text and as a table."""

from __future__ import annotations

from collections.abc import Sequence

from cranktopo.base.units import change_text, number_text
from cranktopo.design.goal.constraint import ACTIVE
from cranktopo.design.goal.outcome import (
    GoalEvaluation,
    GoalOutcome,
    GoalWords,
    LimitEvaluation,
    LimitOutcome,
)
from cranktopo.design.goal.quantities import QUANTITIES
from cranktopo.report.result_table import Column, ResultTable, tabulate

_SHORT_PERCENT = 0.005
"""Least miss that is told of a limit: less shows as 0.00 %."""


def goal_line(goal: GoalOutcome, reference: str = "the original web") -> str:
    """Return the goal and its value: `least mass: 1.407 kg, 88.6 % of the original web`."""
    line = f"{goal_words(goal)}: {value_text(goal.reached, goal.quantity.unit)}"
    percent = goal.reached_percent
    line = line if percent is None else f"{line}, {percent:.1f} % of {reference}"
    if goal.evaluation is None:
        return line
    return f"{line}; by the evaluation {_reached(goal.evaluation, goal.unit)}"


def evaluation_note(goal: GoalOutcome) -> str:
    """Return what the evaluated columns of the limits are; empty for a goal that was not evaluated."""
    if goal.evaluation is None:
        return ""
    return (
        f"evaluated: the extracted surface on body-fitted elements of {goal.evaluation.element_size_mm:.3g} "
        "mm, in percent of the original web without fillets, since a density has none; these decide whether "
        "a limit holds"
    )


def goal_words(goal: GoalWords) -> str:
    """Return the goal without its value: `least mass`."""
    return f"{'least' if goal.minimise else 'largest'} {goal.quantity.label}"


def percent_line(goal: GoalOutcome) -> str:
    """Return goal and limits in percent of the original where known: `mass 87.0 %, torsion 100.1 %`."""
    named: list[tuple[str, GoalOutcome | LimitOutcome]] = [(goal.quantity.name, goal)]
    named += [(limit.quantity, limit) for limit in goal.limits]
    texts = (
        f"{name.replace('_', ' ')} {_reached(entry, entry.unit)}"
        for name, entry in named
        if entry.reached is not None
    )
    return ", ".join(dict.fromkeys(texts))


def limits_table(goal: GoalOutcome) -> ResultTable:
    """Return one row per limit: what is required, what was reached, and whether it holds."""
    evaluated = any(limit.evaluation for limit in goal.limits)
    return tabulate((*_COLUMNS[:-1], *_EVALUATED, _COLUMNS[-1]) if evaluated else _COLUMNS, goal.limits)


def violated_limits(goal: GoalOutcome) -> list[str]:
    """Return the limits that do not hold, with what was reached, by the evaluation where there is one."""
    return [f"{_limit(limit)}: reached {_judged(limit)}" for limit in goal.limits if limit.holds is False]


def evaluated_changes(goal: GoalOutcome | None) -> str:
    """Return what the evaluation says of stiffnesses with limits: `by the evaluation torsion -1.8 %`.

    Empty where it says nothing of them.
    """
    changes = [
        f"{limit.quantity} {change_text(limit.evaluation.reached_percent - 100)}"
        for limit in (goal.limits if goal else ())
        if limit.quantity in ("torsion", "bending")
        and limit.evaluation is not None
        and limit.evaluation.reached_percent is not None
    ]
    return f"by the evaluation {', '.join(dict.fromkeys(changes))}" if changes else ""


def unknown_limits(goal: GoalOutcome) -> list[str]:
    """Return the limits of which nobody knows whether they hold: `fatigue_safety >= 95 %`."""
    return [_limit(limit) for limit in goal.limits if limit.holds is None]


def short_percent(limit: LimitOutcome) -> float:
    """Return what is missing of a limit, percent of it; 0 where that does not show or it is a limit of 0."""
    judged = limit.evaluation or limit
    if not judged.required or judged.reached is None:
        return 0.0
    missing = judged.required - judged.reached
    short = 100 * (missing if limit.sense == ">=" else -missing) / abs(judged.required)
    return short if short >= _SHORT_PERCENT else 0.0


def missed_words(quantities: Sequence[str], excess_percent: Sequence[float]) -> str:
    """Return by how much limits are missed, `mass by 0.40 %, torsion by 0.03 %`; empty where none shows.

    Args:
        quantities: one for each limit.
        excess_percent: how far each limit is missed; 0 or less is kept.
    """
    missed = zip(quantities, excess_percent, strict=True)
    found = {name: f"{name} by {excess:.2f} %" for name, excess in missed if excess >= _SHORT_PERCENT}
    return ", ".join(found.values())


def unjudged_line(goal: GoalOutcome | None) -> str:
    """Return which limits could not be judged and why, where an evaluation of them failed; else empty."""
    if goal is None or goal.not_evaluated is None:
        return ""
    limits = ", ".join(_limit(limit) for limit in goal.limits if limit.reached is not None)
    return (
        f"not judged: {limits}: the evaluation failed, {goal.not_evaluated.rstrip('.')}; "
        "the limits hold in the cells only"
    )


def value_text(value: float | None, unit: str) -> str:
    """Return a value with its unit, large ones without decimals; a dash for what is not known."""
    if value is None:
        return "-"
    return f"{number_text(value)} {unit}".rstrip()


def _judged(limit: LimitOutcome) -> str:
    """Return what was reached of a limit, in percent where that is how it is told."""
    judged = limit.evaluation or limit
    return _reached(judged, limit.unit) if _shares(limit) else value_text(judged.reached, limit.unit)


def _shares(limit: LimitOutcome) -> bool:
    """Tell whether a limit is a share of the original, of which either model has a value of its own.

    A share of what may be negative says nothing of its sense: such a limit is told by its value.
    """
    if QUANTITIES[limit.quantity].signed:
        return False
    return limit.evaluation is not None and limit.evaluation.required != limit.required


def _limit(limit: LimitOutcome) -> str:
    required = (limit.evaluation or limit).required
    if required is None or _shares(limit):
        return f"{limit.quantity} {limit.sense} {limit.required_percent:g} %"
    return f"{limit.quantity} {limit.sense} {value_text(required, limit.unit)}"


def _reached(entry: GoalOutcome | GoalEvaluation | LimitOutcome | LimitEvaluation, unit: str) -> str:
    percent = entry.reached_percent
    return value_text(entry.reached, unit) if percent is None else f"{percent:.1f} %"


def _required_percent(limit: LimitOutcome) -> float | None:
    """Return what is required as a share of the original; None beside what may be negative and is."""
    negative = QUANTITIES[limit.quantity].signed and (limit.required or 0.0) < 0
    return None if negative else limit.required_percent


def _holds(limit: LimitOutcome) -> str:
    if limit.holds is None:
        return "unknown"
    if not limit.holds:
        return "NO"
    if short := short_percent(limit):
        return f"yes, {short:.2f} % short"
    return f"yes, by less than {100 * ACTIVE:g} %" if limit.active else "yes"


def _evaluated(limit: LimitOutcome) -> LimitEvaluation:
    assert limit.evaluation is not None
    return limit.evaluation


_COLUMNS: tuple[Column[LimitOutcome], ...] = (
    Column("limit", 0, _limit),
    Column("reached", 0, lambda limit: value_text(limit.reached, limit.unit)),
    Column("required_percent", 1, _required_percent),
    Column("reached_percent", 1, lambda limit: limit.reached_percent),
    Column("holds", 0, _holds),
)
_EVALUATED: tuple[Column[LimitOutcome], ...] = (
    Column("evaluated", 0, lambda limit: value_text(_evaluated(limit).reached, limit.unit)),
    Column("evaluated_percent", 1, lambda limit: _evaluated(limit).reached_percent),
)
