"""The web nearest to its limits by the slopes at an evaluated web: a linear programme in place of cells.

Cells as well as slopes tell what a step of a finish does to stiffness; of a safety both know the slopes
alone. Quadratic programming on cells may stand still between rules that bend; a linear programme does not.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial

from cranktopo.base.arrays import Array
from cranktopo.design.goal.constraint import model_error
from cranktopo.design.schema import Scene
from cranktopo.numerics.optimisers.dimension_search import KEPT_MM, PRICE
from cranktopo.numerics.optimisers.linear_programmes import Penalties, linear_steps
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.web_shape.refining import Step, merit
from cranktopo.tasks.web_shape.rules import EnvelopeClearance, rules_of
from cranktopo.tasks.web_shape.search import HELD, refused, worst_violation
from cranktopo.tasks.web_shape.search_goal import Quantities, SearchGoal

_TRIES = 4
_LONGER = 1.5
_PENALTIES = Penalties(PRICE, 10.0)
"""A millimetre of a rule costs more than all that a millimetre changes."""


def nearest_web(
    scene: Scene, web: ParametricWeb, at: Array, exact: Quantities, goal: SearchGoal, reach: float
) -> Step:
    """Return the web that misses the limits least by slopes; of those that keep them the best by the goal.

    The web at hand where the best one breaks a rule.

    Args:
        exact: quantities of the web with the parameters `at`, and their gradients.
        reach: of every parameter, mm or degrees.
    """
    low, high = web.bounds
    by_slopes = partial(_by_slopes, exact, at)

    def limits(values: Array) -> tuple[Array, Array]:
        found = goal.violations(by_slopes(values).values)
        return found, goal.violation_gradients(exact.gradients, len(at))

    rules = partial(rules_of, web, EnvelopeClearance(scene))
    bounds = low.clip(min=at - reach), high.clip(max=at + reach)
    values = linear_steps(goal.objective_gradient(exact.gradients), limits, rules, bounds, at, _PENALTIES)
    violated = rules(values)[0].max(initial=0.0) >= KEPT_MM
    found = at if violated or refused(scene, web.layout, values) else values
    return Step(found, by_slopes(found), merit(goal, by_slopes(found).values), 0)


def _by_slopes(exact: Quantities, at: Array, values: Array) -> Quantities:
    """Return the quantities of a web by the slopes of another."""
    by_name = {
        name: value + float(exact.gradients[name] @ (values - at)) if name in exact.gradients else value
        for name, value in exact.values.items()
    }
    return Quantities(by_name, exact.gradients)


def search_with_corrections(
    goal: SearchGoal, search: Callable[[SearchGoal], Step], known: Callable[[Array], Mapping[str, float]]
) -> Step:
    """Return the web of a search whose limits hold by what is known of it, else the nearest of some tries.

    Each limit that does not hold is asked for with what the search overrates there, from both its sides: a
    window between two limits stays as wide as it is.

    Args:
        known: some quantities of the web with some parameters, better than the search tells them.
    """
    corrected_goal, found = goal, list[Step]()
    for _ in range(_TRIES):
        step = search(corrected_goal)
        better = known(step.values)
        corrected = Quantities({**step.quantities.values, **better}, step.quantities.gradients)
        found.append(replace(step, quantities=corrected))
        over = {
            limit.quantity
            for limit in goal.limits
            if limit.quantity in better
            and limit.violation(better[limit.quantity]) > HELD
            and limit.violation(better[limit.quantity])
            > limit.violation(step.quantities.values[limit.quantity]) + HELD
        }
        if not over:
            return replace(found[-1], solved=sum(one.solved for one in found))
        corrected_goal = goal.corrected(
            {name: model_error(name, step.quantities.values[name], better[name]) for name in over}
        )
    nearest = min(found, key=lambda one: worst_violation(goal, one.quantities))
    return replace(nearest, solved=sum(one.solved for one in found))


def nearest_of(
    limits: SearchGoal,
    goal: SearchGoal,
    within: Callable[[float], Step],
    first: Step,
    reach: tuple[float, float],
) -> Step:
    """Return a web that keeps all limits, of the shortest reach that has one; else the nearest of all.

    Args:
        goal: the same limits with what is to be kept in reserve.
        first: a web that is known already.
        reach: the shortest and the longest.
    """
    found, length = first, reach[0]
    while worst_violation(limits, found.quantities) > 0 and length < _LONGER * reach[1]:
        found = min(
            found, within(min(length, reach[1])), key=lambda one: worst_violation(goal, one.quantities)
        )
        length *= _LONGER
    return found
