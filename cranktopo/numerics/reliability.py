"""First-order reliability: probability that a function of standard normal variables falls below zero.

The variables are independent.

Source: R. Rackwitz, B. Fiessler, Structural reliability under combined random load sequences, Computers and
Structures 9 (1978) 489-494.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import solver_error

_STEP, _NEAR, _MOST = 1e-4, 1e-6, 100


@dataclass(frozen=True)
class Reliability:
    """Distance of failure, and the variables that it comes by.

    Attributes:
        index: distance of the most likely point of failure from the mean; negative where the mean has failed.
        shares: part of each variable in it, summing to one, shape (n,).
    """

    index: float
    shares: Array

    @property
    def failure_probability(self) -> float:
        """The probability of failure that belongs to the index."""
        from scipy.special import ndtr

        return float(ndtr(-self.index))


def first_order(margin: Callable[[Array], float], count: int) -> Reliability:
    """Return the reliability of a margin, positive where nothing fails, of so many standard normal variables.

    Raises:
        CranktopoError: no point of failure is found, or the margin depends on none of them.
    """
    point = np.zeros(count)
    for _ in range(_MOST):
        value, gradient = margin(point), _gradient(margin, point)
        steepness = float(np.linalg.norm(gradient))
        if steepness == 0.0:
            break
        direction = -gradient / steepness
        index = float(direction @ point) + value / steepness
        if np.linalg.norm(index * direction - point) < _NEAR * max(1.0, abs(index)):
            return Reliability(index, direction**2)
        point = index * direction
    raise solver_error("reliability: no point of failure is found.", "Reduce the scatter.")


def _gradient(margin: Callable[[Array], float], point: Array) -> Array:
    """Return the gradient by central differences."""
    return np.array(
        [(margin(point + step) - margin(point - step)) / (2 * _STEP) for step in _STEP * np.eye(len(point))]
    )
