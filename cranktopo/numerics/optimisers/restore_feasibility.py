"""A start that breaks the rules by more than a search reaches, moved to the nearest web that keeps them."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress

import numpy as np

from cranktopo.base.arrays import Array

_FAR = 5.0
"""Excess of a rule that a search may be too short for, mm or what the rule is told in."""
_FEASIBLE, _STEP, _STEPS = 1e-6, 1e-3, 100


def mended(rules: Callable[[Array], tuple[Array, Array]], bounds: tuple[Array, Array], start: Array) -> Array:
    """The parameters nearest to a start that keep the rules; itself where a search can mend it.

    Args:
        rules: values, kept where <= 0, and gradients (rules, parameters).
        bounds: lower and upper bounds of the parameters.
        start: (n,) parameters, mm or degrees.
    """
    import nlopt

    first = np.clip(start, *bounds)
    if rules(first)[0].max(initial=0.0) < _FAR:
        return start

    def distance(values: Array, gradient: Array) -> float:
        if gradient.size:
            gradient[:] = values - first
        return float(((values - first) ** 2).sum()) / 2

    def constrain(result: Array, values: Array, gradient: Array) -> None:
        result[:], slopes = rules(values)
        if gradient.size:
            gradient[:] = slopes

    optimiser = nlopt.opt(nlopt.LD_SLSQP, len(first))
    optimiser.set_min_objective(distance)
    optimiser.add_inequality_mconstraint(constrain, np.full(len(rules(first)[0]), _FEASIBLE))
    optimiser.set_lower_bounds(bounds[0])
    optimiser.set_upper_bounds(bounds[1])
    optimiser.set_xtol_abs(_STEP)
    optimiser.set_maxeval(_STEPS)
    best = first
    with suppress(nlopt.RoundoffLimited):
        best = optimiser.optimize(first)
    return best if rules(best)[0].max() < rules(first)[0].max() else start
