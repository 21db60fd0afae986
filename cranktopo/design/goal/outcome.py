"""Outcome of a goal: each limit as required and as reached, the same for every optimiser."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from pydantic import Field

from cranktopo.base.result import UNLESS_NONE, Result
from cranktopo.design.goal.constraint import TOLERANCE, LimitSense
from cranktopo.design.goal.limit import Goal, Limit
from cranktopo.design.goal.quantities import QUANTITIES, GoalQuantity, QuantityName

Values = Mapping[str, float]


class StatedLimit(Result):
    """A limit before anything is reached, as `bound --json` has it."""

    quantity: QuantityName
    sense: LimitSense
    value: float
    """In the quantity's unit, or in percent of the original web."""
    percent: bool
    assumed: bool
    unit: str


class LimitEvaluation(Result):
    """A limit by the evaluation of the extracted surface."""

    required: float | None
    reached: float | None
    reached_percent: float | None


class LimitOutcome(Result):
    """A limit and what a web reaches of it, in the quantity's internal unit.

    It is what JSON has of a `Constraint`, which judges `holds`, `active` and `violation`.
    """

    quantity: QuantityName
    sense: LimitSense
    required: float | None
    """None for percent of an original that is unknown."""
    reached: float | None
    unit: str
    required_percent: float | None
    reached_percent: float | None
    holds: bool | None
    """None where required or reached is unknown."""
    active: bool
    """True where the web is at the limit or beyond it."""
    assumed: bool
    evaluation: LimitEvaluation | None = UNLESS_NONE
    violation: float | None = Field(default=None, exclude=True)
    """Share of its scale by which the limit is broken, negative where there is room; no part of the JSON."""


class LimitRound(Result):
    """Bounds of the limits in the cells as they were moved after an iteration."""

    iteration: int
    bounds: tuple[float, ...]


class GoalEvaluation(Result):
    """A goal by the evaluation of the extracted surface."""

    reached: float | None
    original: float | None
    reached_percent: float | None
    fillets: bool
    element_size_mm: float
    error_estimate_percent: dict[str, float]
    rounds: tuple[LimitRound, ...]


class GoalWords(Result):
    """Sense and quantity of a goal: one of both is there."""

    minimise: QuantityName | None = UNLESS_NONE
    maximise: QuantityName | None = UNLESS_NONE

    @property
    def quantity(self) -> GoalQuantity:
        """The quantity that is minimised or maximised."""
        found = self.minimise or self.maximise
        assert found is not None
        return QUANTITIES[found]


class StatedGoal(GoalWords):
    """A goal before anything is reached, as `bound --json` has it."""

    limits: tuple[StatedLimit, ...]


class GoalOutcome(GoalWords):
    """The entry `goal` of the metrics."""

    reached: float | None
    original: float | None
    unit: str
    reached_percent: float | None
    limits: tuple[LimitOutcome, ...]
    evaluation: GoalEvaluation | None = UNLESS_NONE
    not_evaluated: str | None = UNLESS_NONE
    """Why the evaluation that decides whether limits hold failed."""

    def with_evaluation(self, evaluated: GoalOutcome, **how: Any) -> GoalOutcome:
        """Return the outcome with the evaluation, made as `how` says, whose word on limits is the last."""
        pairs = zip(self.limits, evaluated.limits, strict=True)
        limits = tuple(own.model_copy(update=_evaluated(own, better)) for own, better in pairs)
        total = GoalEvaluation(
            reached=evaluated.reached,
            original=evaluated.original,
            reached_percent=evaluated.reached_percent,
            **how,
        )
        return self.model_copy(update={"limits": limits, "evaluation": total})

    def without_evaluation(self, why: str) -> GoalOutcome:
        """Return the outcome where the limits were to hold by an evaluation that failed: nobody can tell."""
        limits = tuple(limit.model_copy(update={"holds": None}) for limit in self.limits)
        return self.model_copy(update={"limits": limits, "not_evaluated": why})


def stated_goal(goal: Goal) -> StatedGoal:
    """Return a goal as JSON has it before anything is reached."""
    limits = tuple(StatedLimit(**asdict(limit), unit=limit.unit) for limit in goal.limits)
    return StatedGoal(**{goal.sense: goal.quantity}, limits=limits)


def goal_outcome(goal: Goal, reached: Values, original: Values, tolerance: float = TOLERANCE) -> GoalOutcome:
    """Return what became of a goal.

    Args:
        reached, original: of a web and of the original in the same model, by quantity, in its internal unit;
            what is not known is left out.
        tolerance: share of its scale by which a limit may be violated and still holds.
    """
    name = goal.quantity
    now, before = reached.get(name), original.get(name)
    senses: dict[str, Any] = {goal.sense: name}
    return GoalOutcome(
        **senses,
        reached=now,
        original=before,
        unit=QUANTITIES[name].unit,
        reached_percent=_percent(now, before),
        limits=tuple(limit_outcome(limit, reached, original, tolerance) for limit in goal.limits),
    )


def limit_outcome(
    limit: Limit, reached: Values, original: Values, tolerance: float = TOLERANCE
) -> LimitOutcome:
    """Return a limit with what was reached; arguments as in `goal_outcome`."""
    name = limit.quantity
    now, before = reached.get(name), original.get(name)
    constraint = limit.constraint(original)
    required = None if constraint is None else constraint.bound
    own_percentage = limit.unit == "%" and not limit.percent  # which has no second one of the original
    share_of = None if own_percentage else before
    judged: dict[str, Any] = {"holds": None, "active": False}
    if constraint is not None and now is not None:
        judged = {"holds": constraint.satisfied(now, tolerance), "active": constraint.active(now)}
        judged["violation"] = constraint.violation(now)
    return LimitOutcome(
        quantity=name,
        sense=limit.sense,
        required=required,
        reached=now,
        unit=QUANTITIES[name].unit,
        required_percent=limit.value if limit.percent else _percent(required, share_of),
        reached_percent=_percent(now, share_of),
        assumed=limit.assumed,
        **judged,
    )


def _evaluated(own: LimitOutcome, better: LimitOutcome) -> dict[str, Any]:
    evaluation = LimitEvaluation(
        required=better.required, reached=better.reached, reached_percent=better.reached_percent
    )
    judged = own if better.holds is None else better
    return {"holds": judged.holds, "active": judged.active, "evaluation": evaluation}


def _percent(value: float | None, original: float | None) -> float | None:
    return None if value is None or original is None or original <= 0 else 100 * value / original
