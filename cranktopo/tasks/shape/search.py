"""Search for the best dimensions of one layout: sequential quadratic programming with exact gradients."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.base.notes import Pace, note
from cranktopo.base.progress import StageMemory
from cranktopo.base.result import Result
from cranktopo.design.halves import usual_scale
from cranktopo.design.schema import Scene
from cranktopo.numerics.optimisers.gradient_search import (
    Multipliers,
    minimise,
    minimise_violation,
    multipliers,
    restore_feasibility,
)
from cranktopo.numerics.optimisers.linear_programmes import linear_multipliers
from cranktopo.tasks.refit.family import Layout, rounded_dimensions, scene_at, web_of
from cranktopo.tasks.refit.fit import scene_with_web
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.shape.rules import EnvelopeClearance, rules_at, rules_of
from cranktopo.tasks.shape.search_goal import Quantities, SearchGoal
from cranktopo.tasks.shape.web_model import Responses, WebModel

EVALUATIONS = 20
_REACH = 15.0
"""Largest move of a parameter in one search, mm or degrees."""
_RULES = 0.05
"""Weight of a millimetre of a manufacturing constraint against a limit's relative excess."""
KEPT_MM = 5e-3
"""Violation of a rule that rounding of the dimensions absorbs."""
HELD = 1e-6
"""Relative excess of a limit with which a web still counts as keeping it by the evaluation: rounding."""
_NEARLY = 5e-4
"""The same on cells, which err by far more."""
_STEP_MM, _FLAT = 2e-3, 1e-6
_STEEP = 2000.0
"""Factor on the goal. The method takes a curvature of 1 to begin with, while a millimetre changes the goal by
a thousandth: without the factor the first steps would be of micrometres."""
_ATTEMPTS = 4
_PRICED = 1.0
"""Reach of the programme that finds prices, mm or degrees for throws of usual size."""
PRICE = 10.0
"""Of a relative excess of a limit in the goal where no web within reach keeps all: far above usual ones."""


class WebSolver(Protocol):
    """Webs of a throw in one model, solved one after another."""

    @property
    def scene(self) -> Scene:
        """The throw."""

    def web(self, layout: Layout) -> ParametricWeb:
        """Return a web of the layout."""

    def responses(self, web: ParametricWeb, values: Array, quantities: Collection[str]) -> Quantities:
        """Return quantities of a web with these values."""


@dataclass(frozen=True)
class SearchBudget:
    """Length and reach of a search.

    Attributes:
        evaluations: most webs solved.
        reach: how far a parameter may move, mm or degrees.
        nearest: whether the web that comes nearest to its limits is taken where none keeps them.
    """

    evaluations: int = EVALUATIONS
    reach: float = _REACH
    nearest: bool = False


@dataclass(frozen=True)
class SearchResult:
    """The best web of a search on cells; by how much it misses its limits is relative."""

    layout: Layout
    values: Array
    objective: float
    responses: Responses
    violation: float = 0.0


class _WebSearch:
    """Objective and constraints of one search, each web solved once.

    Attributes:
        best: of the webs that keep the rules the one that misses its limits least, of those that keep them
            the one with the best goal: relative excess, goal, parameters.
    """

    def __init__(self, webs: WebSolver, layout: Layout, goal: SearchGoal, pace: Pace) -> None:
        self.goal, self._pace = goal, pace
        self.web: ParametricWeb = webs.web(layout)
        self.evaluations = 0
        self.best: tuple[float, float, Array] | None = None
        self._webs = webs
        self._clearance = EnvelopeClearance(webs.scene)
        self._last: tuple[bytes, Quantities] | None = None
        self._ruled: tuple[bytes, tuple[Array, Array]] | None = None

    def responses(self, values: Array) -> Quantities:
        if self._last is None or self._last[0] != values.tobytes():
            self._pace.begin()
            found = self._webs.responses(self.web, values, self.goal.quantities)
            self._last = values.tobytes(), found
            self.evaluations += 1
            self._keep(values, found)
        return self._last[1]

    @property
    def sound(self) -> Array:
        """The best web, else the last one that was solved."""
        assert self._last is not None
        return np.frombuffer(self._last[0]) if self.best is None else self.best[2]

    def objective(self, values: Array) -> tuple[float, Array]:
        found = self.responses(values)
        gradient = _STEEP * self.goal.objective_gradient(found.gradients)
        return float(_STEEP * self.goal.objective(found.values)), gradient

    def rules(self, values: Array) -> tuple[Array, Array]:
        if self._ruled is None or self._ruled[0] != values.tobytes():
            self._ruled = values.tobytes(), rules_of(self.web, self._clearance, values)
        return self._ruled[1]

    def constraints(self, values: Array) -> tuple[Array, Array]:
        found, (rules, gradients) = self.responses(values), self.rules(values)
        limits = self.goal.violation_gradients(found.gradients, len(values))
        violations = np.concatenate([self.goal.violations(found.values), _RULES * rules])
        return violations, np.vstack([limits, _RULES * gradients])

    def _keep(self, values: Array, quantities: Quantities) -> None:
        rank = worst_violation(self.goal, quantities), self.goal.objective(quantities.values)
        better = self.best is None or rank < self.best[:2]
        if better and self.rules(values)[0].max() < KEPT_MM:
            self.best = *rank, values.copy()


class FinishedSearch(Result):
    """A search as the work keeps it: the values of the best web, or why there is none."""

    values: tuple[float, ...] | None
    evaluations: int
    why: str | None


def best_values(
    webs: Callable[[], WebSolver],
    layout: Layout,
    start: Array,
    goal: SearchGoal,
    name: str,
    work: StageMemory,
    effort: SearchBudget,
) -> tuple[Array | None, int]:
    """Return parameters of the best web of a layout near a start, and how many webs were solved.

    The start may break rules and limits. None when no web that keeps them was found; the work then says why.
    """

    def make() -> FinishedSearch:
        model = webs()
        pace = Pace(f"{name}, webs of {len(start)} dimensions", effort.evaluations, at_most=True)
        task = _WebSearch(model, layout, goal, pace)
        _minimise(task, start, effort, work)
        best = task.best
        violation = None if best else rules_at(model.scene, task.web, task.sound).violation_text
        why = refused(model.scene, layout, best[2]) if best else violation
        if why and best is not None:
            note(f"left out: {why}")
        kept = best is not None and not why and (effort.nearest or best[0] == 0)
        values = tuple(best[2]) if best and kept else None
        return FinishedSearch(values=values, evaluations=task.evaluations, why=why)

    kept = work.once_as(FinishedSearch, name, make)
    return None if kept.values is None else np.array(kept.values), kept.evaluations


def search_on_cells(
    model: WebModel,
    layout: Layout,
    start: Array,
    goal: SearchGoal,
    name: str,
    work: StageMemory,
    evaluations: int = EVALUATIONS,
    nearest: bool = False,
) -> tuple[SearchResult | None, int]:
    """Do as `best_values` on cells, with the responses of the best web."""
    effort = SearchBudget(evaluations, nearest=nearest)
    values, solved = best_values(model.webs, layout, start, goal, name, work, effort)
    if values is None:
        return None, solved
    # Solved anew from nothing, so that a continued optimisation sees the very same numbers.
    found = model.responses(model.web(layout), values, goal.quantities)
    return SearchResult(
        layout, values, goal.objective(found.values), found, worst_violation(goal, found)
    ), solved


def multipliers_of(
    scene: Scene, web: ParametricWeb, at: Array, quantities: Quantities, goal: SearchGoal
) -> Multipliers:
    """Return what each limit, rule and bound costs where a web is an optimum, whose quantities are known."""
    return multipliers(*_slopes(scene, web, at, quantities, goal))


def prices_of(
    scene: Scene, web: ParametricWeb, at: Array, quantities: Quantities, goal: SearchGoal
) -> Multipliers:
    """Return the same by a linear programme, which keeps the other limits beside a web that is no optimum.

    A finish keeps up to 0.7 % in reserve, so that its web lies inside limits that decide it.
    """
    return linear_multipliers(*_slopes(scene, web, at, quantities, goal), _PRICED / usual_scale(scene))


def _slopes(
    scene: Scene, web: ParametricWeb, at: Array, quantities: Quantities, goal: SearchGoal
) -> tuple[Array, tuple[Array, Array], tuple[Array, Array], tuple[Array, Array]]:
    """Return gradient, limits, rules and room to the bounds."""
    low, high = web.bounds
    return (
        goal.objective_gradient(quantities.gradients),
        (goal.violations(quantities.values), goal.violation_gradients(quantities.gradients, len(at))),
        rules_of(web, EnvelopeClearance(scene), at),
        (at - low, high - at),
    )


def shaped_scene(scene: Scene, layout: Layout, values: Array) -> Scene:
    """Return the scene with a web of the family and its dimensions of the throw, rounded to 0.01 mm.

    Raises:
        CranktopoError: the web does not fit the throw.
    """
    sized = scene_at(scene, layout, rounded_dimensions(scene, layout, values))
    found = scene_with_web(sized, web_of(layout, values, sized))
    changes = {"web": found.web, "shape": found.shape, "published": None, "original": None}
    return sized.model_copy(update={"name": f"{scene.name}-shape", **changes})


def worst_violation(goal: SearchGoal, quantities: Quantities) -> float:
    """Return by how much the worst limit is missed, relative; 0 where all count as kept."""
    violation = float(goal.violations(quantities.values).max(initial=0.0))
    return 0.0 if violation < _NEARLY else violation


def refused(scene: Scene, layout: Layout, values: Array) -> str:
    """Return why the scene refuses the web of the rounded dimensions; empty where it accepts it."""
    try:
        shaped_scene(scene, layout, values)
    except CranktopoError as error:
        return str(error).rstrip(".")
    return ""


def _minimise(task: _WebSearch, start: Array, effort: SearchBudget, work: StageMemory) -> None:
    """Search; where a web cannot be solved, once more from the last sound one with a shorter reach."""
    start, reach = restore_feasibility(task.rules, task.web.bounds, start), effort.reach
    for _ in range(_ATTEMPTS):
        try:
            return _descend(task, start, replace(effort, reach=reach), work)
        except CranktopoError as error:
            if task.evaluations == 0:
                raise
            note(f"a web on the way could not be solved ({error}): on from the last one, in smaller steps")
            start, reach = task.sound, reach / 4


def _descend(task: _WebSearch, start: Array, effort: SearchBudget, work: StageMemory) -> None:
    (low, high), reach = task.web.bounds, effort.reach
    bounds = np.maximum(low, start - reach), np.minimum(high, start + reach)

    def objective(values: Array) -> tuple[float, Array]:
        work.check()
        return task.objective(values)

    evaluations = effort.evaluations - task.evaluations
    minimise(objective, task.constraints, bounds, start, _STEP_MM, evaluations, _FLAT)
    if effort.nearest and (task.best is None or task.best[0] > 0):
        minimise_violation(
            objective,
            task.constraints,
            len(task.goal.limits),
            PRICE * _STEEP,
            bounds,
            start,
            _STEP_MM,
            effort.evaluations,
            _FLAT,
        )
