"""The stage: a scene and a goal -> the dimensions of the best web that can be made.

Features are chosen on coarse cells, dimensions on finer ones. The cells know no fillets and err beside
pockets, so the result is evaluated on body-fitted elements, each limit is moved by the error that shows, and
the search goes on from there, until the limits hold by the evaluation.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cranktopo.remodel.manufacturing_limits import ManufacturingLimits
from cranktopo.scene import Scene
from cranktopo.scene.goal import Goal
from cranktopo.scene.goal.moved import moved_bound
from cranktopo.shape.body_fitted import EvaluatedWeb, evaluated_web
from cranktopo.shape.goal_in_model import search_goal_of
from cranktopo.shape.growth import Growth, Trial, no_web
from cranktopo.shape.prices import Prices
from cranktopo.shape.search import Found, prices_of, search, shaped_scene
from cranktopo.shape.search_goal import SearchGoal
from cranktopo.shape.start import scene_start
from cranktopo.shape.web_model import WebModel, web_model
from cranktopo.store import Work

Array = NDArray[np.float64]
HELD = 5e-4
"""Relative excess with which a limit still counts as kept by the evaluation."""
_SETTLED = 1e-3
"""Relative gain in the goal below which a round that keeps the limits is the last."""
_FIRST, _AGAIN = 60, 20
"""Most webs solved by the first search on the finer cells, and by those after the limits were moved."""
_SAFE = 3e-4
"""Part of a limit that the search keeps in reserve, for the rounding of the dimensions."""


@dataclass(frozen=True)
class ShapeSettings:
    """How a shape is searched for.

    Attributes:
        coarse_mm: cells on which features are chosen.
        fine_mm: cells on which dimensions are found.
        rounds: most searches on the finer cells, each followed by an evaluation.
        element_size_mm: of the evaluation; by default that of `evaluate`.
    """

    coarse_mm: float = 4.0
    fine_mm: float = 2.5
    rounds: int = 6
    element_size_mm: float | None = None
    limits: ManufacturingLimits = field(default_factory=ManufacturingLimits)


@dataclass(frozen=True)
class Round:
    """One search and the evaluation of its result.

    Attributes:
        excess_percent: how far each limit of the goal is missed by the evaluation, %; 0 or less is kept.
        evaluations: webs solved by the search.
    """

    web: EvaluatedWeb
    found: Found
    goal: SearchGoal
    excess_percent: tuple[float, ...]
    evaluations: int

    @property
    def held(self) -> bool:
        """Whether every limit is kept by the evaluation."""
        return max(self.excess_percent, default=0.0) <= 100 * HELD


@dataclass(frozen=True)
class ShapeOptimum:
    """The best web found.

    Attributes:
        rounds: searches on the finer cells in their order.
        best: position of the best of them.
        trials: features and stations that were tried.
    """

    goal: Goal
    original: EvaluatedWeb
    model: WebModel
    rounds: tuple[Round, ...]
    best: int
    trials: tuple[Trial, ...]
    prices: Prices

    @property
    def result(self) -> Round:
        """The best round."""
        return self.rounds[self.best]


def optimise_shape(
    scene: Scene,
    goal: Goal,
    settings: ShapeSettings | None = None,
    work: Work | None = None,
) -> ShapeOptimum:
    """The best web of the family for a goal; call inside `double_precision()`.

    Raises:
        CranktopoError: no envelope, no web that keeps limits and rules, or a failed solve.
    """
    settings, work = settings or ShapeSettings(), work or Work()
    fatigue = any(limit.quantity == "fatigue_safety" for limit in goal.limits)
    own = None if scene.original is None else Path(scene.original.file)
    original = evaluated_web(scene, fatigue, settings.element_size_mm, "original", work, own)
    coarse = web_model(scene, settings.limits, settings.coarse_mm)
    growth = Growth(coarse, _goal_on_cells(goal, coarse, original), work)
    grown = growth.grown(growth.first(*scene_start(scene, settings.limits)))
    fine = web_model(scene, settings.limits, settings.fine_mm)
    rounds = _rounds(fine, goal, original, grown, settings, work)
    best = _best(rounds)
    chosen = rounds[best]
    paid = prices_of(fine, chosen.found, chosen.goal)
    return ShapeOptimum(goal, original, fine, rounds, best, tuple(growth.trials), paid)


def _goal_on_cells(goal: Goal, model: WebModel, original: EvaluatedWeb) -> SearchGoal:
    return search_goal_of(goal, model.original, original.values, model.model.cases)


def _rounds(
    model: WebModel, wanted: Goal, original: EvaluatedWeb, grown: Found, settings: ShapeSettings, work: Work
) -> tuple[Round, ...]:
    """Searches on the finer cells, each with limits that are moved by the error of the one before."""
    plain, cases = _goal_on_cells(wanted, model, original), model.model.cases
    true = search_goal_of(wanted, original.values, original.values, cases)
    fatigue, errors = "fatigue_safety" in original.values, dict[str, float]()
    start, rounds = grown.values, list[Round]()
    for number in range(1, settings.rounds + 1):
        goal = plain.shifted(_factors(plain, errors))
        most = _AGAIN if rounds else _FIRST
        found, solved = search(model, grown.layout, start, goal, f"round-{number}", work, most)
        if found is None:
            break
        scene = shaped_scene(model.scene, found.layout, found.values)
        web = evaluated_web(scene, fatigue, settings.element_size_mm, f"evaluation-{number}", work)
        rounds.append(Round(web, found, goal, tuple(100 * true.excesses(web.values)), solved))
        work.info(_round_text(number, rounds[-1], original))
        if _settled(rounds):
            break
        errors, start = _errors(model, found, web, original), found.values
    if not rounds:
        raise no_web()
    return tuple(rounds)


def _settled(rounds: Sequence[Round]) -> bool:
    """Whether the last two rounds keep every limit and reach about the same goal."""
    if len(rounds) < 2 or not (rounds[-1].held and rounds[-2].held):
        return False
    before, now = (_goal_value(found) for found in rounds[-2:])
    return before - now < _SETTLED * abs(before)


def _errors(model: WebModel, found: Found, web: EvaluatedWeb, original: EvaluatedWeb) -> dict[str, float]:
    """By how much the cells overrate each quantity of the web against the original."""
    cells, truth, start = found.responses.values, web.values, original.values
    return {
        name: moved_bound(start[name], cells[name], truth[name]) / model.original[name]
        for name in cells
        if truth[name] and model.original[name]
    }


def _factors(goal: SearchGoal, errors: Mapping[str, float]) -> dict[str, float]:
    """What each limit on the cells is multiplied by: the error of the cells, and a little in reserve."""
    return {r.quantity: (1 - r.sign * _SAFE) * errors.get(r.quantity, 1.0) for r in goal.limits}


def _best(rounds: tuple[Round, ...]) -> int:
    """The held round with the best goal by the evaluation, the first of equals; else the nearest to held."""
    held = [index for index, found in enumerate(rounds) if found.held]
    if held:
        return min(held, key=lambda i: (round(_goal_value(rounds[i]), 6), i))
    return min(range(len(rounds)), key=lambda i: (round(max(rounds[i].excess_percent), 4), i))


def _goal_value(found: Round) -> float:
    goal = found.goal
    return goal.sign * found.web.values[goal.quantity]


def _round_text(number: int, found: Round, original: EvaluatedWeb) -> str:
    changes = ", ".join(
        f"{name} {100 * (found.web.values[name] / original.values[name] - 1):+.2f} %"
        for name in ("mass", "torsion", "bending", "fatigue_safety")
        if name in found.web.values
    )
    return f"round {number}: {changes} by the evaluation; limits {'kept' if found.held else 'missed'}"
