"""From a goal in words to numbers: limits in the units of a model, relative to the original web in it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import degrees

from cranktopo.design.goal.constraint import Constraint, bound_in_model, minimum_scale, scale_of
from cranktopo.design.goal.limit import Goal, Limit
from cranktopo.design.goal.quantities import STIFFNESS_OF, QuantityName
from cranktopo.engine.load_case import LoadCase
from cranktopo.tasks.shape.search_goal import SearchGoal

FOR_SAFETY: QuantityName = "bending"
"""The goal on cells where the fatigue safety is the goal."""


def goal_on_cells(goal: Goal) -> Goal:
    """What stands for a goal where features are chosen: cells know no fatigue.

    A fillet's stress follows the bending of the throw by the gas force, so the most bending stiffness within
    the same limits stands for the most safety; the finish then maximises the safety itself.
    """
    return replace(goal, quantity=FOR_SAFETY) if goal.quantity == "fatigue_safety" else goal


def search_goal_of(
    goal: Goal,
    original: Mapping[str, float],
    true_original: Mapping[str, float],
    cases: tuple[LoadCase, ...],
) -> SearchGoal:
    """A goal as a model states it.

    Args:
        original: quantities of the original web in the model.
        true_original: by the body-fitted evaluation; limits keep their relation to it.
        cases: load cases, for displacement and twist.
    """
    sign = 1.0 if goal.sense == "minimise" else -1.0
    limits = [
        found for limit in goal.limits for found in _search_limits(limit, original, true_original, cases)
    ]
    scale = scale_of(original[goal.quantity], 0.0, minimum_scale(goal.quantity, original))
    return SearchGoal(goal.quantity, sign, scale, tuple(limits))


def _search_limits(
    limit: Limit, original: Mapping[str, float], truth: Mapping[str, float], cases: tuple[LoadCase, ...]
) -> Iterator[Constraint]:
    quantity = STIFFNESS_OF.get(limit.quantity, limit.quantity)
    if quantity not in original:
        return
    own, true = original[quantity], truth[quantity]
    if quantity == limit.quantity:
        sense, required = limit.sense, limit.value / 100 * true if limit.percent else limit.value
    else:
        sense = ">=" if limit.sense == "<=" else "<="
        required = 100 / limit.value * true if limit.percent else _load(quantity, cases) / limit.value
    bound = bound_in_model(quantity, required, own, true)
    yield Constraint(quantity, sense, bound, own, minimum_scale(quantity, original))


def _load(stiffness: str, cases: tuple[LoadCase, ...]) -> float:
    """Load whose ratio to a limit is the stiffness it asks for: N, or N m deg/rad."""
    case = next(case for case in cases if case.name == stiffness)
    return case.radial_N if stiffness == "bending" else degrees(case.torque_Nm)
