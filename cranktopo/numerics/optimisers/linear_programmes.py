"""Linear programmes over slopes: prices of an optimum, and sequential linear programming from a point.

The multipliers are the dual variables of the programme that a goal's gradient poses with the room of every
constraint within a reach: limits that are a little way off count with that room, the others stay kept. The
sequence is that of R. Fletcher, E. Sainz de la Maza, Mathematical Programming 43, 1989, without second
derivatives: an exact penalty of the worst violation, a reach that shrinks where a step does not pay, and a
step once more with the curvature of the constraints that it met.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.numerics.optimisers.gradient_search import NEAR_MM, Constraints, Multipliers

_SHORTEST = 1e-3
"""Reach at which a sequence ends, in the unit of the parameters."""
_STEPS, _CORRECTIONS = 40, 2
_SMALLEST_GAIN = 1e-6
"""Promise of a step, in the goal, at which a sequence ends."""
_KEPT_SHARE = 0.1
"""Share of its promise that a step must keep."""


def linear_multipliers(
    gradient: Array,
    limits: tuple[Array, Array],
    rules: tuple[Array, Array],
    bounds: tuple[Array, Array],
    reach: float,
) -> Multipliers:
    """Return prices for the gradient (n,) of a goal that is to be small, with every other constraint kept.

    What is violated may not become worse. Rules and bounds farther off than `NEAR_MM` have no price, but what
    lies beyond them is not gained.

    Args:
        limits, rules, bounds: as of `multipliers`.
        reach: of every parameter, mm or degrees.
    """
    from scipy.optimize import linprog

    room = np.maximum(-np.concatenate([limits[0], rules[0]]), 0.0)
    low, high = (np.minimum(np.maximum(side, 0.0), reach) for side in bounds)
    rows = np.vstack([limits[1], rules[1]])
    found = linprog(gradient, A_ub=rows, b_ub=room, bounds=np.column_stack([-low, high]), method="highs")
    by_limits, by_rules = np.split(-found.ineqlin.marginals, [len(limits[0])])
    by_rules = np.where(rules[0] > -NEAR_MM, by_rules, 0.0)
    at_low = np.where(bounds[0] < NEAR_MM, found.lower.marginals, 0.0)
    at_high = np.where(bounds[1] < NEAR_MM, -found.upper.marginals, 0.0)
    rest = gradient + by_limits @ limits[1] + by_rules @ rules[1] - at_low + at_high
    share = float(np.linalg.norm(rest)) / max(float(np.linalg.norm(gradient)), 1e-30)
    return Multipliers(by_limits, by_rules, at_low - at_high, share)


@dataclass(frozen=True)
class Penalties:
    """Cost in a goal of one of violation of the worst limit, and of the worst rule."""

    limits: float
    rules: float


def linear_steps(
    goal: Array,
    limits: Constraints,
    rules: Constraints,
    bounds: tuple[Array, Array],
    start: Array,
    penalties: Penalties,
) -> Array:
    """Return parameters with the least linear goal (n,) under constraints that are known with gradients.

    Where no parameters within the bounds keep the limits, those with the least violation.
    """
    at = np.clip(start, *bounds)
    widest = float((bounds[1] - bounds[0]).max(initial=0.0)) / 2
    reach, here = widest, (limits(at), rules(at))
    for _ in range(_STEPS):
        room = np.maximum(bounds[0], at - reach) - at, np.minimum(bounds[1], at + reach) - at
        step, promised = _elastic_step(goal, here, room, penalties)
        if reach < _SHORTEST or promised < _SMALLEST_GAIN:
            break
        found = None
        for _ in range(_CORRECTIONS):
            there = limits(at + step), rules(at + step)
            gain = _missed(here, penalties) - _missed(there, penalties) - float(goal @ step)
            if gain > _KEPT_SHARE * promised:
                found = at + step, there
                break
            step, _ = _elastic_step(goal, _bent(here, there, step), room, penalties)
        if found is None:
            reach /= 4
            continue
        at, here = found
        reach = min(2 * reach, widest)
    return at


_Known = tuple[tuple[Array, Array], tuple[Array, Array]]
"""Values and gradients of limits and of rules at a point."""


def _missed(known: _Known, penalties: Penalties) -> float:
    (limits, _), (rules, _) = known
    return float(penalties.limits * limits.max(initial=0.0) + penalties.rules * rules.max(initial=0.0))


def _bent(here: _Known, there: _Known, step: Array) -> _Known:
    """Return constraints at a point with what their curvature adds on the way of a step."""
    bent = [(found - slopes @ step, slopes) for (found, _), (_, slopes) in zip(there, here, strict=True)]
    return bent[0], bent[1]


def _elastic_step(
    goal: Array, known: _Known, room: tuple[Array, Array], penalties: Penalties
) -> tuple[Array, float]:
    """Return the best move within some room and what it promises.

    One more variable each is by how much all limits and all rules are missed.
    """
    from scipy.optimize import linprog

    (limits, by_limits), (rules, by_rules) = known
    eases = np.zeros((len(limits) + len(rules), 2))
    eases[: len(limits), 0] = eases[len(limits) :, 1] = -1.0
    found = linprog(
        np.concatenate([goal, [penalties.limits, penalties.rules]]),
        A_ub=np.column_stack([np.vstack([by_limits, by_rules]), eases]),
        b_ub=-np.concatenate([limits, rules]),
        bounds=[*zip(*room, strict=True), (0.0, None), (0.0, None)],
        method="highs",
    )
    if found.x is None:
        return np.zeros(len(goal)), 0.0
    return np.asarray(found.x[:-2]), _missed(known, penalties) - float(found.fun)
