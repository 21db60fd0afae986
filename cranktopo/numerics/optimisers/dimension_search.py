"""Search of dimensions where every point costs a solve: each is solved once, and the best one is kept.

Sequential quadratic programming with exact gradients. Rules, which cost nothing, are met before the first
solve. Where a point cannot be solved, the search goes on from the last sound one with a shorter reach.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.numerics.optimisers.gradient_search import (
    Constraints,
    minimise,
    minimise_violation,
    restore_feasibility,
)

EVALUATIONS = 20
KEPT_MM = 5e-3
"""Violation of a rule that rounding of the dimensions absorbs."""
PRICE = 10.0
"""Of a relative excess of a limit in the goal where no point within reach keeps all: far above usual ones."""
_REACH = 15.0
"""Largest move of a parameter in one search, mm or degrees."""
_RULES = 0.05
"""Weight of a millimetre of a rule against a limit's relative excess."""
_STEP_MM, _FLAT = 2e-3, 1e-6
_STEEP = 2000.0
"""Factor on the goal. The method takes a curvature of 1 to begin with, while a millimetre changes the goal by
a thousandth: without the factor the first steps would be of micrometres."""
_ATTEMPTS = 4
_SHORTER = 4
"""The reach over that after a point that could not be solved."""


@dataclass(frozen=True)
class SearchBudget:
    """Length and reach of a search.

    Attributes:
        evaluations: most points solved.
        reach: how far a parameter may move, mm or degrees.
        nearest: whether the point that comes nearest to its limits is taken where none keeps them.
    """

    evaluations: int = EVALUATIONS
    reach: float = _REACH
    nearest: bool = False


@dataclass(frozen=True)
class SolvedPoint:
    """Goal and limits at a point, as its solve finds them.

    Attributes:
        goal, goal_slopes: smaller is better; (parameters,).
        limits, limit_slopes: relative excesses, kept where <= 0, (limits,); (limits, parameters).
        missed: the worst excess, 0 where all limits count as kept.
    """

    goal: float
    goal_slopes: Array
    limits: Array
    limit_slopes: Array
    missed: float


class DimensionSearch:
    """Goal and constraints of one search.

    Attributes:
        best: of the points that keep the rules the one that misses its limits least, of those that keep them
            the one with the best goal: relative excess, goal, parameters.
        evaluations: points solved so far.
    """

    def __init__(
        self, solve: Callable[[Array], SolvedPoint], rules: Constraints, bounds: tuple[Array, Array]
    ) -> None:
        """Take what solves a point, the rules in mm, and the bounds of the parameters."""
        self._solve, self._rules, self._bounds = solve, rules, bounds
        self.evaluations = 0
        self.best: tuple[float, float, Array] | None = None
        self._last: tuple[bytes, SolvedPoint] | None = None
        self._ruled: tuple[bytes, tuple[Array, Array]] | None = None

    @property
    def sound(self) -> Array:
        """The best point, else the last one that was solved."""
        assert self._last is not None
        return np.frombuffer(self._last[0]) if self.best is None else self.best[2]

    def minimise(
        self,
        start: Array,
        budget: SearchBudget,
        check: Callable[[], None],
        refused: Callable[[CranktopoError], None],
    ) -> None:
        """Search from a start, which may break rules and limits.

        Args:
            check: called before each point, may raise.
            refused: told why a point could not be solved.

        Raises:
            CranktopoError: the first point could not be solved.
        """
        start, reach = restore_feasibility(self.rules, self._bounds, start), budget.reach
        for _ in range(_ATTEMPTS):
            try:
                return self._descend(start, replace(budget, reach=reach), check)
            except CranktopoError as error:
                if self.evaluations == 0:
                    raise
                refused(error)
                start, reach = self.sound, reach / _SHORTER

    def rules(self, values: Array) -> tuple[Array, Array]:
        """Return the rules at a point, kept where <= 0, mm, and their gradients."""
        if self._ruled is None or self._ruled[0] != values.tobytes():
            self._ruled = values.tobytes(), self._rules(values)
        return self._ruled[1]

    def _descend(self, start: Array, budget: SearchBudget, check: Callable[[], None]) -> None:
        (low, high), reach = self._bounds, budget.reach
        bounds = np.maximum(low, start - reach), np.minimum(high, start + reach)

        def objective(values: Array) -> tuple[float, Array]:
            check()
            found = self._solved(values)
            return float(_STEEP * found.goal), _STEEP * found.goal_slopes

        evaluations = budget.evaluations - self.evaluations
        minimise(objective, self._constraints, bounds, start, _STEP_MM, evaluations, _FLAT)
        if budget.nearest and (self.best is None or self.best[0] > 0):
            assert self._last is not None
            minimise_violation(
                objective,
                self._constraints,
                len(self._last[1].limits),
                PRICE * _STEEP,
                bounds,
                start,
                _STEP_MM,
                budget.evaluations,
                _FLAT,
            )

    def _constraints(self, values: Array) -> tuple[Array, Array]:
        found, (rules, gradients) = self._solved(values), self.rules(values)
        violations = np.concatenate([found.limits, _RULES * rules])
        return violations, np.vstack([found.limit_slopes, _RULES * gradients])

    def _solved(self, values: Array) -> SolvedPoint:
        if self._last is None or self._last[0] != values.tobytes():
            found = self._solve(values)
            self._last = values.tobytes(), found
            self.evaluations += 1
            self._keep(values, found)
        return self._last[1]

    def _keep(self, values: Array, found: SolvedPoint) -> None:
        rank = found.missed, found.goal
        better = self.best is None or rank < self.best[:2]
        if better and self.rules(values)[0].max() < KEPT_MM:
            self.best = *rank, values.copy()
