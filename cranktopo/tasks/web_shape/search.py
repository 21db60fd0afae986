"""Search for the best dimensions of one layout: sequential quadratic programming with exact gradients."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.base.notes import Pace, note
from cranktopo.base.progress import StageMemory
from cranktopo.base.result import Result
from cranktopo.design.halves import usual_scale
from cranktopo.design.schema import Scene
from cranktopo.numerics.optimisers.dimension_search import (
    EVALUATIONS,
    DimensionSearch,
    SearchBudget,
    SolvedPoint,
)
from cranktopo.numerics.optimisers.gradient_search import Multipliers, multipliers
from cranktopo.numerics.optimisers.linear_programmes import linear_multipliers
from cranktopo.tasks.refit.family import Layout, rounded_dimensions, scene_at, web_of
from cranktopo.tasks.refit.fit import scene_with_web
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.web_shape.rules import EnvelopeClearance, rules_at, rules_of
from cranktopo.tasks.web_shape.search_goal import Quantities, SearchGoal
from cranktopo.tasks.web_shape.web_model import Responses, WebModel

HELD = 1e-6
"""Relative excess of a limit with which a web still counts as keeping it by the evaluation: rounding."""
_NEARLY = 5e-4
"""The same on cells, which err by far more."""
_PRICED = 1.0
"""Reach of the programme that finds prices, mm or degrees for throws of usual size."""


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
class SearchResult:
    """The best web of a search on cells; by how much it misses its limits is relative."""

    layout: Layout
    values: Array
    objective: float
    responses: Responses
    violation: float = 0.0


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
        web = model.web(layout)
        task = _web_search(model, web, goal, Pace(_told(name, start), effort.evaluations, at_most=True))
        task.minimise(start, effort, work.check, _note_refused)
        best = task.best
        violation = None if best else rules_at(model.scene, web, task.sound).violation_text
        why = refused(model.scene, layout, best[2]) if best else violation
        if why and best is not None:
            note(f"left out: {why}")
        kept = best is not None and not why and (effort.nearest or best[0] == 0)
        values = tuple(best[2]) if best and kept else None
        return FinishedSearch(values=values, evaluations=task.evaluations, why=why)

    kept = work.once_as(FinishedSearch, name, make)
    return None if kept.values is None else np.array(kept.values), kept.evaluations


def _told(name: str, start: Array) -> str:
    return f"{name}, webs of {len(start)} dimensions"


def _note_refused(error: CranktopoError) -> None:
    note(f"a web on the way could not be solved ({error}): on from the last one, in smaller steps")


def _web_search(webs: WebSolver, web: ParametricWeb, goal: SearchGoal, pace: Pace) -> DimensionSearch:
    """Return the search of a web's dimensions for a goal, within its rules and the envelope."""
    clearance = EnvelopeClearance(webs.scene)

    def solve(values: Array) -> SolvedPoint:
        pace.begin()
        found = webs.responses(web, values, goal.quantities)
        return SolvedPoint(
            goal.objective(found.values),
            goal.objective_gradient(found.gradients),
            goal.violations(found.values),
            goal.violation_gradients(found.gradients, len(values)),
            worst_violation(goal, found),
        )

    return DimensionSearch(solve, lambda values: rules_of(web, clearance, values), web.bounds)


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
