"""Search with gradients: derivatives by steps, sequential quadratic programming, multipliers of the optimum.

At an optimum the goal's gradient is balanced by those of the active constraints with multipliers >= 0
(W. Karush, 1939; H. W. Kuhn, A. W. Tucker, 1951); non-negative least squares finds them. The programming is
that of D. Kraft, 1988, as NLopt has it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array

_IMAGINARY = 1e-30
"""Imaginary step: nothing cancels, so it may be as small as it likes."""


def central_difference(
    function: Callable[[Array], Array], at: Array, step: float, places: Iterable[int] | None = None
) -> Array:
    """Return derivatives by the argument's first axis, as last axis; 0 by places that are left out."""
    chosen = list(range(len(at)) if places is None else places)
    values = [function(point) for point in difference_points(at, step, chosen)] or [function(at)]
    return from_differences(values, step, chosen, np.zeros((*np.shape(values[0]), len(at))))


def difference_points(at: Array, step: float, places: Sequence[int]) -> list[Array]:
    """Return the points a step after and a step before, by each of some places of the first axis.

    For a function that is quicker for many points at once than for one after the other.
    """
    steps = step * np.eye(len(at)).reshape(len(at), len(at), *(1,) * (at.ndim - 1))
    return [at + sign * steps[i] for i in places for sign in (1, -1)]


def from_differences(values: Sequence[Array], step: float, places: Sequence[int], zeros: Array) -> Array:
    """Return the derivatives that a function's values at `difference_points` give, 0 by other places."""
    for i, more, less in zip(places, values[::2], values[1::2], strict=False):
        zeros[..., i] = (more - less) / (2 * step)
    return zeros


def remembered(function: Callable[[Array], Array]) -> Callable[[Array], Array]:
    """Return the same function of a vector, which finds each point once: differences ask for many again."""

    @lru_cache(maxsize=512)
    def found(values: tuple[float, ...]) -> Array:
        return function(np.array(values))

    return lambda at: found(tuple(map(float, at)))


def complex_step(function: Callable[[Any], Any], at: Array) -> Array:
    """Return the derivatives of an analytic function by its variables, exact to rounding, as the last axis.

    Source: J. R. R. A. Martins et al., The complex-step derivative approximation, ACM TOMS 29, 2003.
    """
    sides = [function(at + 1j * _IMAGINARY * unit).imag / _IMAGINARY for unit in np.eye(len(at))]
    return np.stack(sides, axis=-1)


@dataclass(frozen=True)
class Multipliers:
    """Multipliers of an optimum.

    Attributes:
        limits: (limits,) change of the goal per relative change of each limit.
        rules: (rules,) change of the goal per mm of each manufacturing rule.
        bounds: (parameters,) of the bounds, change of the goal per mm or degree.
        remainder: part of the goal's gradient that they do not balance, over its length.
    """

    limits: Array
    rules: Array
    bounds: Array
    remainder: float


_NEAR_LIMIT = 2e-3
"""Relative distance from a limit that counts as active."""
NEAR_MM = 0.05
"""The same from a rule or bound, mm or degrees."""


def multipliers(
    gradient: Array,
    limits: tuple[Array, Array],
    rules: tuple[Array, Array],
    bounds: tuple[Array, Array],
) -> Multipliers:
    """Return multipliers of the active constraints for the gradient (n,) of a goal that is to be small.

    Limits (relative) and rules (mm) are values, kept where <= 0, and gradients (m, n); bounds the room to the
    lower and to the upper ones, (n,) each, mm or degrees. What is near counts as active.
    """
    from scipy.optimize import nnls

    count = len(gradient)
    near = [limits[0] > -_NEAR_LIMIT, rules[0] > -NEAR_MM, bounds[0] < NEAR_MM, bounds[1] < NEAR_MM]
    rows = np.vstack([limits[1], rules[1], -np.eye(count), np.eye(count)])
    active = np.concatenate(near)
    weights = np.zeros(len(rows))
    scale = np.linalg.norm(rows[active], axis=1)
    kept = np.flatnonzero(active)[scale > 0]
    if kept.size:
        columns = (rows[kept] / scale[scale > 0, None]).T
        found, _ = nnls(columns, -gradient)
        weights[kept] = found / scale[scale > 0]
    rest = float(np.linalg.norm(gradient + weights @ rows)) / max(float(np.linalg.norm(gradient)), 1e-30)
    first, second, third = np.cumsum([len(limits[0]), len(rules[0]), count])
    return Multipliers(weights[:first], weights[first:second], weights[second:third] - weights[third:], rest)


Objective = Callable[[Array], tuple[float, Array]]
"""Value and gradient (parameters,) at parameters."""
Constraints = Callable[[Array], tuple[Array, Array]]
"""Values, kept where <= 0, and gradients (constraints, parameters) at parameters."""
Slopes = Array | Callable[[], Array]
"""Gradients, or what finds them: a line search asks for values alone, in a fit one time in seven."""


def by_differences(judged: Callable[[Array], Array], step: float) -> tuple[Objective, Constraints]:
    """Return objective and constraints of a function that finds (objective, *constraints) at once.

    Each point is found once; slopes are central differences.
    """
    of = remembered(judged)

    def objective(values: Array) -> tuple[float, Array]:
        return float(of(values)[0]), central_difference(of, values, step)[0]

    def constraints(values: Array) -> tuple[Array, Array]:
        return of(values)[1:], central_difference(of, values, step)[1:]

    return objective, constraints


_FEASIBLE = 1e-6
_FAR = 5.0
"""Violation of a rule that a search may be too short for, mm or what the rule is told in."""
_RESTORED, _RESTORE_EVALUATIONS = 1e-3, 100
_VALUE_DIGITS, _SLOPE_DIGITS = 7, 6
"""Digits of values and slopes that a search sees. The last bits of sums depend on the machine, and on where
in memory an array lies; a search that saw them would end at another design."""


def minimise(
    objective: Callable[[Array], tuple[float, Slopes]],
    constraints: Callable[[Array], tuple[Array, Slopes]],
    bounds: tuple[Array, Array],
    start: Array,
    step: float,
    evaluations: int,
    flat: float = 0.0,
) -> Array:
    """Minimise an objective under constraints; a search that gets stuck ends at the start, in the bounds.

    Rounding stops it, or slopes of which the method's least squares make nothing: who asks keeps the best.

    A change of a parameter by `step`, or of the objective by its share `flat`, ends the search. Values and
    slopes are rounded, so that it goes the same way where their last bits differ.
    """
    import nlopt

    def value(values: Array, gradient: Array) -> float:
        result, by_values = objective(values)
        if gradient.size:
            gradient[:] = _rounded(_found(by_values), _SLOPE_DIGITS)
        return float(_rounded(np.array([result]), _VALUE_DIGITS)[0])

    def constrain(result: Array, values: Array, gradient: Array) -> None:
        found, by_values = constraints(values)
        result[:] = np.round(found, _VALUE_DIGITS)
        if gradient.size:
            gradient[:] = _rounded(_found(by_values), _SLOPE_DIGITS)

    first = np.clip(start, *bounds)
    optimiser = nlopt.opt(nlopt.LD_SLSQP, len(first))
    optimiser.set_min_objective(value)
    optimiser.add_inequality_mconstraint(constrain, np.full(len(constraints(first)[0]), _FEASIBLE))
    optimiser.set_lower_bounds(bounds[0])
    optimiser.set_upper_bounds(bounds[1])
    optimiser.set_xtol_abs(step)
    optimiser.set_ftol_rel(flat)
    optimiser.set_maxeval(max(evaluations, 1))
    with suppress(nlopt.RoundoffLimited, nlopt.runtime_error):  # errors of the functions are of other kinds
        return np.asarray(optimiser.optimize(first))
    return first


def _found(slopes: Slopes) -> Array:
    return slopes() if callable(slopes) else slopes


def _rounded(rows: Array, digits: int) -> Array:
    """Return rows rounded to so many digits of their largest entries."""
    largest = np.abs(rows).max(axis=-1, keepdims=True, initial=0.0)
    unit = 10.0 ** (np.floor(np.log10(np.where(largest > 0, largest, 1.0))) - digits)
    return np.asarray(np.round(rows / unit) * unit)


def minimise_violation(
    objective: Objective,
    constraints: Constraints,
    missable: int,
    price: float,
    bounds: tuple[Array, Array],
    start: Array,
    step: float,
    evaluations: int,
    flat: float = 0.0,
) -> Array:
    """Minimise the worst violation of the first constraints, and an objective where they hold.

    Where constraints contradict each other within the bounds, sequential quadratic programming stands still.
    Elastic mode (P. E. Gill, W. Murray, M. A. Saunders, SIAM Review 47, 2005, section 6.5): one more variable
    by which they may all be missed, at a price.

    Args:
        missable: number of constraints that may be missed.
        price: of the objective for one of violation, above the multipliers of these constraints.
    """

    def eased(values: Array) -> tuple[float, Array]:
        value, by_values = objective(values[:-1])
        return value + price * float(values[-1]), np.append(by_values, price)

    def loosened(values: Array) -> tuple[Array, Array]:
        found, by_values = constraints(values[:-1])
        ease = (np.arange(len(found)) < missable).astype(float)
        return found - values[-1] * ease, np.column_stack([by_values, -ease])

    first = np.clip(start, *bounds)
    worst = float(constraints(first)[0][:missable].max(initial=0.0))
    low, high = np.append(bounds[0], 0.0), np.append(bounds[1], worst)
    best = minimise(eased, loosened, (low, high), np.append(first, worst), step, evaluations, flat)
    return best[:-1]


def restore_feasibility(rules: Constraints, bounds: tuple[Array, Array], start: Array) -> Array:
    """Return the parameters nearest to a start that keep the rules; itself where a search can mend it."""
    first = np.clip(start, *bounds)
    if rules(first)[0].max(initial=0.0) < _FAR:
        return start

    def distance(values: Array) -> tuple[float, Array]:
        return float(((values - first) ** 2).sum()) / 2, values - first

    best = minimise(distance, rules, bounds, first, _RESTORED, _RESTORE_EVALUATIONS)
    return best if rules(best)[0].max() < rules(first)[0].max() else start
