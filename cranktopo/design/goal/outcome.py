"""What became of a goal: each limit as required and as reached, the same for every optimiser."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from cranktopo.design.goal.limit import Goal, Limit
from cranktopo.design.goal.moved import least_size, size_of
from cranktopo.design.goal.quantities import QUANTITIES

Values = Mapping[str, float]
HOLDS = 5e-3
"""Share of its size by which a limit may be missed and still holds."""
ACTIVE = 1e-2
"""Share of its size within which a limit decides the design."""


@dataclass(frozen=True)
class LimitOutcome:
    """A limit and what a web reaches of it, in the quantity's internal unit.

    Attributes:
        reached, original: None where nobody has told it.
        tolerance: share of its size by which the limit may be missed and still holds.
        least_size: of a limit on what may be 0.
    """

    limit: Limit
    reached: float | None
    original: float | None
    tolerance: float = HOLDS
    least_size: float = 0.0

    @property
    def required(self) -> float | None:
        """The limit's value; None for percent of an original that nobody has told."""
        if not self.limit.percent:
            return self.limit.value
        return None if self.original is None else self.limit.value / 100 * self.original

    @property
    def missed(self) -> float | None:
        """Share of its size by which the limit is missed, negative where there is room; None if unknown."""
        if self.required is None or self.reached is None:
            return None
        size = size_of(self.required, self.original or 0.0, self.least_size)
        over = self.reached - self.required
        return (over if self.limit.sense == "<=" else -over) / size

    @property
    def holds(self) -> bool | None:
        """Whether the limit holds; None if unknown."""
        return None if self.missed is None else self.missed <= self.tolerance

    @property
    def active(self) -> bool:
        """Whether the web is at the limit or beyond it."""
        return self.missed is not None and self.missed >= -ACTIVE

    def as_json(self) -> dict[str, Any]:
        """The entry of `limits` in the metrics."""
        limit = self.limit
        return {
            "quantity": limit.quantity,
            "sense": limit.sense,
            "required": self.required,
            "reached": self.reached,
            "unit": QUANTITIES[limit.quantity].unit,
            "required_percent": limit.value if limit.percent else _percent(self.required, self.original),
            "reached_percent": _percent(self.reached, self.original),
            "holds": self.holds,
            "active": self.active,
            "assumed": limit.assumed,
        }


def limit_outcomes(
    goal: Goal, reached: Values, original: Values, tolerance: float = HOLDS
) -> tuple[LimitOutcome, ...]:
    """Every limit of a goal with what was reached.

    Args:
        reached, original: values of a web and of the original in the same model, by quantity, in its internal
            unit; what is not known is left out.
    """
    return tuple(
        LimitOutcome(
            limit,
            reached.get(limit.quantity),
            original.get(limit.quantity),
            tolerance,
            least_size(limit.quantity, original),
        )
        for limit in goal.limits
    )


def goal_json(goal: Goal, reached: Values, original: Values, tolerance: float = HOLDS) -> dict[str, Any]:
    """The entry `goal` of the metrics; arguments as in `limit_outcomes`."""
    name = goal.quantity
    now, before = reached.get(name), original.get(name)
    return {
        goal.sense: name,
        "reached": now,
        "original": before,
        "unit": QUANTITIES[name].unit,
        "reached_percent": _percent(now, before),
        "limits": [outcome.as_json() for outcome in limit_outcomes(goal, reached, original, tolerance)],
    }


def with_evaluation(model: Mapping[str, Any], evaluated: Mapping[str, Any]) -> dict[str, Any]:
    """What became of a goal in the optimiser's model, with the evaluation, which has the last word on limits.

    Args:
        model, evaluated: the same goal as `goal_json` tells it of either.
    """
    pairs = zip(model["limits"], evaluated["limits"], strict=True)
    limits = [
        {
            **own,
            **({} if better["holds"] is None else {key: better[key] for key in ("holds", "active")}),
            "evaluation": {key: better[key] for key in ("required", "reached", "reached_percent")},
        }
        for own, better in pairs
    ]
    total = {key: evaluated[key] for key in ("reached", "original", "reached_percent")}
    return {**model, "limits": limits, "evaluation": total}


def without_evaluation(model: Mapping[str, Any], why: str) -> dict[str, Any]:
    """What became of a goal whose limits were to hold by an evaluation that failed: nobody can tell.

    Args:
        model: the goal as `goal_json` tells it in the optimiser's model.
        why: what failed.
    """
    limits = [{**limit, "holds": None} for limit in model["limits"]]
    return {**model, "limits": limits, "not_evaluated": why}


def _percent(value: float | None, original: float | None) -> float | None:
    """A value in percent of the original's, where that is above 0."""
    return None if value is None or original is None or original <= 0 else 100 * value / original
