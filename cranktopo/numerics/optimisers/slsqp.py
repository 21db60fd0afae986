"""Sequential quadratic programming with exact gradients (D. Kraft, 1988), as NLopt has it."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress

import numpy as np

from cranktopo.base.arrays import Array

Objective = Callable[[Array], tuple[float, Array]]
"""Value and gradient (parameters,) at parameters."""
Constraints = Callable[[Array], tuple[Array, Array]]
"""Values, kept where <= 0, and gradients (constraints, parameters) at parameters."""
_FEASIBLE = 1e-6
_FAR = 5.0
"""Violation of a rule that a search may be too short for, mm or what the rule is told in."""
_RESTORED, _RESTORE_EVALUATIONS = 1e-3, 100


def minimise(
    objective: Objective,
    constraints: Constraints,
    bounds: tuple[Array, Array],
    start: Array,
    step: float,
    evaluations: int,
    flat: float = 0.0,
) -> Array:
    """Minimise an objective under constraints; what rounding stops ends at the start.

    Args:
        bounds: lower and upper bounds of the parameters, between which the start is brought.
        step, flat: change of a parameter and relative change of the objective that end the search.
        evaluations: maximum number of them.
    """
    import nlopt

    def value(values: Array, gradient: Array) -> float:
        result, by_values = objective(values)
        if gradient.size:
            gradient[:] = by_values
        return result

    def constrain(result: Array, values: Array, gradient: Array) -> None:
        result[:], by_values = constraints(values)
        if gradient.size:
            gradient[:] = by_values

    first = np.clip(start, *bounds)
    optimiser = nlopt.opt(nlopt.LD_SLSQP, len(first))
    optimiser.set_min_objective(value)
    optimiser.add_inequality_mconstraint(constrain, np.full(len(constraints(first)[0]), _FEASIBLE))
    optimiser.set_lower_bounds(bounds[0])
    optimiser.set_upper_bounds(bounds[1])
    optimiser.set_xtol_abs(step)
    optimiser.set_ftol_rel(flat)
    optimiser.set_maxeval(max(evaluations, 1))
    with suppress(nlopt.RoundoffLimited):
        return np.asarray(optimiser.optimize(first))
    return first


def restore_feasibility(rules: Constraints, bounds: tuple[Array, Array], start: Array) -> Array:
    """Return the parameters nearest to a start that keep the rules; itself where a search can mend it.

    Args:
        start: (n,) parameters, mm or degrees.
    """
    first = np.clip(start, *bounds)
    if rules(first)[0].max(initial=0.0) < _FAR:
        return start

    def distance(values: Array) -> tuple[float, Array]:
        return float(((values - first) ** 2).sum()) / 2, values - first

    best = minimise(distance, rules, bounds, first, _RESTORED, _RESTORE_EVALUATIONS)
    return best if rules(best)[0].max() < rules(first)[0].max() else start
