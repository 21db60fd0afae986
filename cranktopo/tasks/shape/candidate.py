"""The best web so far, and whether one with a feature more pays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.tasks.refit.family import Layout
from cranktopo.tasks.shape.search_goal import Quantities

MINIMUM_GAIN = 2e-3
"""Gain in the goal, relative to the original, that a feature or a station must bring."""
DOUBT = 1e-2
"""Violation of a limit above which no finish will keep it."""


@dataclass(frozen=True)
class WebCandidate:
    """The best web so far.

    Attributes:
        values: parameters of the layout, mm or degrees.
        objective: the goal, with what slightly missed limits cost; smaller is better.
        violation: by how much it misses its limits, relative; 0 where it keeps them.
        told: its quantities in the numbers of the evaluation.
        errors: by how much the cells overrate them, also taken for webs that grow from it (`model_error`).
        exact: these by body-fitted elements; None while only the cells have told them.
        solved: webs solved to refine it.
    """

    layout: Layout
    values: Array
    objective: float
    violation: float
    told: Mapping[str, float]
    errors: Mapping[str, float]
    exact: Quantities | None = None
    solved: int = 0

    @property
    def required_merit(self) -> float:
        """Merit that a web with one feature more must reach to pay."""
        return np.inf if self.violation > 0 else self.objective - MINIMUM_GAIN

    def gain_over(self, before: WebCandidate) -> float:
        """Return the gain in the goal; over a web that violates a limit, how much nearer this one comes."""
        if before.violation > 0 or self.violation > 0:
            return before.violation - self.violation
        return before.objective - self.objective

    def pays(self, before: WebCandidate) -> bool:
        """Tell whether the web is worth its feature more."""
        return (self.violation == 0 < before.violation) or self.gain_over(before) >= MINIMUM_GAIN


def doubtful(violation: float) -> float:
    """Return a violation; 0 where a finish may still keep the limits, as the merit counts that."""
    return violation if violation > DOUBT else 0.0
