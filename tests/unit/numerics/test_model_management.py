"""A cheap model proposes, a dear one judges: parabolas whose lowest points are known."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
import pytest
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.numerics.optimisers.dimension_search import DimensionSearch, SearchBudget, SolvedPoint
from cranktopo.numerics.optimisers.gradient_search import Constraints, by_differences
from cranktopo.numerics.optimisers.model_management import ManagedModels, managed_search

TRUE, ROUGH = 3.0, 1.0
"""Lowest points of the dear and of the cheap model, whose second derivative is half too large."""
ROUNDS = 40


@dataclass
class Parabolas(ManagedModels[float, float]):
    """Designs are places. The dear model refuses those beyond a wall."""

    wall: float = np.inf
    judged: list[float] = field(default_factory=list)

    @override
    def propose(self, best: float, reach: float) -> float:
        slope = 2 * (best - TRUE)  # the cheap model has this slope at the best place by its correction
        return best + float(np.clip(-slope / 3.0, -reach, reach))

    @override
    def settled(self, best: float, proposed: float) -> bool:
        return abs(proposed - best) < 1e-9

    @override
    def judge(self, proposed: float) -> float | None:
        self.judged.append(proposed)
        return proposed if proposed <= self.wall else None

    @override
    def is_better(self, best: float, proposed: float, found: float) -> bool:
        return (found - TRUE) ** 2 < (best - TRUE) ** 2

    @override
    def longer(self, reach: float) -> float:
        return 2 * reach

    @override
    def shorter(self, best: float, proposed: float, reach: float) -> float:
        return abs(proposed - best) / 2

    @override
    def is_near(self, best: float, reach: float) -> bool:
        return reach < 1e-6


def test_the_lowest_point_is_that_of_the_dear_model() -> None:
    """By two thirds of the way each time: the error falls to a third."""
    models = Parabolas()
    assert managed_search(models, ROUGH, np.inf, ROUNDS) == pytest.approx(TRUE, abs=1e-8)
    assert models.judged[:2] == pytest.approx([ROUGH + 4 / 3, TRUE - 2 / 9])


def test_the_rounds_are_at_most_so_many() -> None:
    models = Parabolas()
    assert managed_search(models, ROUGH, np.inf, 2) == pytest.approx(TRUE - 2 / 9)
    assert len(models.judged) == 2


def test_what_cannot_be_judged_shortens_the_way() -> None:
    """Beyond 2 nothing is judged: the search comes up to it from below, and never ends there."""
    models = Parabolas(wall=2.0)
    found = managed_search(models, ROUGH, np.inf, ROUNDS)
    assert 1.9 < found <= 2.0
    assert max(models.judged) > 2.0


def test_a_reach_holds_a_proposal_back() -> None:
    models = Parabolas()
    managed_search(models, ROUGH, 0.25, 3)
    assert models.judged == pytest.approx([1.25, 1.75, 1.75 + 2.5 / 3])


def bowl(at: Array) -> SolvedPoint:
    """Square of the distance from (3, 3), a thousandth for a millimetre, within x <= 2."""
    away, limit = at - 3.0, np.array([at[0] - 2.0])
    missed = 0.0 if limit[0] < 1e-3 else float(limit[0])
    return SolvedPoint(1e-3 * float(away @ away), 2e-3 * away, limit, np.array([[1.0, 0.0]]), missed)


def rule(at: Array) -> tuple[Array, Array]:
    """Within a circle about the origin: steps along its tangent leave it."""
    return np.array([at @ at - 10.0]), 2 * at[None]


def searched(
    solve: Callable[[Array], SolvedPoint], rules: Constraints = rule
) -> tuple[DimensionSearch, list[str]]:
    task = DimensionSearch(solve, rules, (np.zeros(2), np.full(2, 10.0)))
    told: list[str] = []
    start, budget = np.array([1.0, 1.0]), SearchBudget(60)
    task.minimise(start, budget, lambda: None, lambda error: told.append(str(error)))
    return task, told


def test_the_best_point_keeps_limit_and_rule() -> None:
    """x = 2 by the limit leaves y2 = 6; by symmetry the rule alone has x2 = y2 = 5."""
    task, told = searched(bowl)
    assert task.best is not None
    assert task.best[2] == pytest.approx([2.0, np.sqrt(6.0)], abs=0.01)
    assert task.best[0] == 0
    assert not told


def test_a_point_that_breaks_a_rule_is_not_kept() -> None:
    task, _ = searched(bowl, lambda _: (np.array([1.0]), np.zeros((1, 2))))
    assert task.evaluations
    assert task.best is None


def test_each_point_is_solved_once() -> None:
    solved: list[bytes] = []

    def solve(at: Array) -> SolvedPoint:
        solved.append(at.tobytes())
        return bowl(at)

    task, _ = searched(solve)
    assert task.evaluations == len(solved)
    assert all(one != other for one, other in pairwise(solved))


def test_a_point_that_cannot_be_solved_is_told_and_passed_by() -> None:
    def solve(at: Array) -> SolvedPoint:
        if at[1] > 1.5:
            raise CranktopoError("folds")
        return bowl(at)

    task, told = searched(solve)
    assert told
    assert set(told) == {"folds"}
    assert task.best is not None
    assert task.best[2][1] <= 1.5


def test_differences_find_each_point_once() -> None:
    seen: list[tuple[float, ...]] = []

    def judged(at: Array) -> Array:
        seen.append(tuple(at))
        return np.array([at @ at, at[0] - at[1], 5 * at[1]])

    objective, constraints = by_differences(judged, 1e-3)
    at = np.array([1.0, 2.0])
    value, slope = objective(at)
    limits, slopes = constraints(at)
    assert value == 5.0
    assert slope == pytest.approx([2.0, 4.0])
    assert limits == pytest.approx([-1.0, 10.0])
    assert slopes == pytest.approx(np.array([[1.0, -1.0], [0.0, 5.0]]))
    assert len(seen) == len(set(seen)) == 5
