"""Multipliers of an optimum: what each limit and each rule costs, from its stationarity.

At an optimum the goal's gradient is balanced by those of the active constraints with multipliers >= 0
(W. Karush, 1939; H. W. Kuhn, A. W. Tucker, 1951); non-negative least squares finds them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array


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


def multipliers(
    gradient: Array, limits: tuple[Array, Array], rules: tuple[Array, Array], bounds: tuple[Array, Array]
) -> Multipliers:
    """Return multipliers of the active constraints.

    Args:
        gradient: (n,) gradient of the goal, smaller is better.
        limits: values and gradients (m, n) of the limits, kept where <= 0, relative.
        rules: values and gradients of the rules, kept where <= 0, mm.
        bounds: room to the lower and to the upper bounds, (n,) each, mm or degrees.
    """
    from scipy.optimize import nnls

    count = len(gradient)
    near = [limits[0] > -_NEAR_LIMIT, rules[0] > -_NEAR_MM, bounds[0] < _NEAR_MM, bounds[1] < _NEAR_MM]
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


_NEAR_LIMIT, _NEAR_MM = 2e-3, 0.05
"""Distance from a limit (relative) and from a rule or bound (mm, degrees) that counts as active."""
