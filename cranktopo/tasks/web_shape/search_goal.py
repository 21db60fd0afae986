"""A goal and its limits as numbers that a search can use: one objective, relative limits, their gradients."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from math import degrees

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.goal.constraint import Constraint, bound_in_model, minimum_scale, scale_of, with_error
from cranktopo.design.goal.limit import Goal, Limit
from cranktopo.design.goal.quantities import QUANTITIES, STIFFNESS_OF, QuantityName, quantity_named
from cranktopo.engine.load_case import LoadCase


@dataclass(frozen=True)
class Quantities:
    """Quantities of a web by name, in the units of the goal's limits.

    Attributes:
        gradients: of those that were asked for, each (parameters,), per mm or degree.
    """

    values: dict[str, float]
    gradients: dict[str, Array]


@dataclass(frozen=True)
class SearchGoal:
    """Objective and constraints of a search.

    Attributes:
        sign: 1 minimises the quantity, -1 maximises it.
        scale: its value for the original web, which makes the objective one.
        shift: by how much a model overrates a quantity that may be 0.
    """

    quantity: str
    sign: float
    scale: float
    limits: tuple[Constraint, ...]
    shift: float = 0.0

    def objective(self, values: Mapping[str, float]) -> float:
        """Return the goal, smaller is better; 1 or -1 for the original web."""
        return self.sign * (values[self.quantity] - self.shift) / self.scale

    def objective_gradient(self, gradients: Mapping[str, Array]) -> Array:
        """Return its gradient, (parameters,)."""
        return self.sign * gradients[self.quantity] / self.scale

    def violations(self, values: Mapping[str, float]) -> Array:
        """Return how far each limit is missed over its size, kept where <= 0."""
        return np.array([limit.violation(values[limit.quantity]) for limit in self.limits])

    def violation_gradients(self, gradients: Mapping[str, Array], parameters: int) -> Array:
        """Return their gradients (limits, parameters)."""
        rows = [limit.factor * gradients[limit.quantity] for limit in self.limits]
        return np.array(rows).reshape(len(rows), parameters)

    def sensitivity_by_cell(self, by_cell: Mapping[str, Array], limits: Array) -> Array:
        """Return what the goal gains by emptying each cell, with the limits paid for at their prices.

        Args:
            by_cell: gradients of the quantities by the fill.
            limits: change of the goal per relative change of each limit.
        """
        result = self.sign * by_cell[self.quantity] / self.scale
        for price, limit in zip(limits, self.limits, strict=True):
            result = result + price * limit.factor * by_cell[limit.quantity]
        return np.asarray(result)

    @property
    def quantities(self) -> tuple[str, ...]:
        """Every quantity that it speaks of."""
        return (self.quantity, *(limit.quantity for limit in self.limits))

    def corrected(self, errors: Mapping[str, float]) -> SearchGoal:
        """Return the same for a model that overrates quantities by known errors, as of `model_error`."""
        found = replace(self, limits=tuple(limit.corrected(errors) for limit in self.limits))
        if self.quantity not in errors:
            return found
        if quantity_named(self.quantity).signed:
            return replace(found, shift=self.shift + errors[self.quantity])
        return replace(found, scale=with_error(self.quantity, self.scale, errors[self.quantity]))

    def reserved(self, share: float, quantities: Collection[str] | None = None) -> SearchGoal:
        """Return the same with limits, or those of some quantities, tighter by a share of their scales."""
        moved = tuple(
            limit.tightened(share) if quantities is None or limit.quantity in quantities else limit
            for limit in self.limits
        )
        return replace(self, limits=moved)


def quantity_on_cells(goal: Goal) -> QuantityName:
    """Return the quantity that stands for the goal's where features are chosen: cells have no fillets.

    A fillet's stress follows the bending of the throw by the gas force, so the most bending stiffness within
    the same limits stands for the most safety; the finish then maximises the safety itself.
    """
    return "bending" if goal.quantity == "fatigue_safety" else goal.quantity


def goal_on_cells(
    goal: Goal, original: Mapping[str, float], judged: Callable[[], Mapping[str, float]]
) -> Goal:
    """Return what stands for a goal where features are chosen.

    A least safety is there the same share of the original's bending stiffness, and of its torsional stiffness
    where neither goal nor limits speak of that, and a largest stress the inverse share; the finish then keeps
    safety and stress themselves.

    Args:
        original: quantities of the original web.
        judged: tells them with its stresses, which are waited for where a limit is no percentage of them.
    """
    of_stress = tuple(limit for limit in goal.limits if QUANTITIES[limit.quantity].of_stress)
    names: tuple[QuantityName, ...] = ("bending",) if "torsion" in goal.load_cases else ("bending", "torsion")
    known = tuple(limit for limit in goal.limits if limit not in of_stress)
    found = Goal(goal.sense, quantity_on_cells(goal), known)
    percents = [
        _stiffness_percent(limit, judged)
        for limit in of_stress
        if (limit.sense == ">=") == (QUANTITIES[limit.quantity].better == "high")
    ]
    for name in names if percents else ():
        found = _at_least(found, name, max(percents), original[name])
    return found


def _stiffness_percent(limit: Limit, judged: Callable[[], Mapping[str, float]]) -> float:
    """Return the stiffness, in percent of the original's, that stands for a limit of the stresses."""
    percent = limit.value if limit.percent else 100 * limit.value / judged()[limit.quantity]
    return percent if limit.sense == ">=" else 100 * 100 / percent


def _at_least(goal: Goal, name: QuantityName, percent: float, original: float) -> Goal:
    """Return the goal with a stiffness of so many percent of the original's, if it does not ask for more."""
    own = [limit for limit in goal.limits_of(name) if limit.sense == ">="]
    most = max((100 * (limit.required(original) or 0.0) / original for limit in own), default=0.0)
    if QUANTITIES[goal.quantity].load_case == name or most >= percent:
        return goal
    kept = tuple(limit for limit in goal.limits if limit not in own)
    return replace(goal, limits=(*kept, Limit(name, ">=", percent, percent=True, assumed=True)))


def search_goal_of(
    goal: Goal,
    original: Mapping[str, float],
    true_original: Mapping[str, float],
    cases: tuple[LoadCase, ...],
) -> SearchGoal:
    """Return a goal as a model states it.

    Args:
        original: quantities of the original web in the model.
        true_original: by the body-fitted evaluation; limits keep their relation to it.
        cases: for displacement and twist.
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
    """Return the load whose ratio to a limit is the stiffness it asks for: N, or N m deg/rad."""
    case = next(case for case in cases if case.name == stiffness)
    return case.radial_N if stiffness == "bending" else degrees(case.torque_Nm)
