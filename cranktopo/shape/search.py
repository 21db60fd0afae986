"""Search for the best dimensions of one layout: sequential quadratic programming with exact gradients."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cranktopo.errors import CranktopoError
from cranktopo.remodel.family import Layout, web_of
from cranktopo.remodel.fit import scene_with_web
from cranktopo.remodel.parametric_web import ParametricWeb
from cranktopo.scene import Scene
from cranktopo.shape.envelope_room import EnvelopeRoom
from cranktopo.shape.prices import Prices, prices
from cranktopo.shape.search_goal import SearchGoal
from cranktopo.shape.web_model import Responses, WebModel
from cranktopo.store import Json, Work

Array = NDArray[np.float64]
EVALUATIONS = 40
_REACH = 15.0
"""How far a parameter may move in one search, mm or degrees."""
_RULES = 0.05
"""Weight of a millimetre of a manufacturing constraint against a limit's relative excess."""
_KEPT_MM = 5e-3
"""Violation of a rule that rounding of the dimensions absorbs."""
_HELD = 1e-3
"""Relative excess of a limit with which a web still counts as keeping it."""
_FEASIBLE, _STEP_MM, _FLAT = 1e-6, 1e-3, 1e-8


@dataclass(frozen=True)
class Found:
    """The best web of a search.

    Attributes:
        values: parameters of the layout, mm or degrees.
        objective: the goal, smaller is better.
        responses: its quantities and their gradients.
    """

    layout: Layout
    values: Array
    objective: float
    responses: Responses


class _Search:
    """Objective and constraints of one search, each web solved once; the best web that keeps all."""

    def __init__(self, model: WebModel, layout: Layout, goal: SearchGoal) -> None:
        self.goal = goal
        self.web: ParametricWeb = model.web(layout)
        self.evaluations = 0
        self.best: tuple[float, Array] | None = None
        self._model = model
        self._room = EnvelopeRoom(model.scene)
        self._last: tuple[bytes, Responses] | None = None

    def responses(self, values: Array) -> Responses:
        if self._last is None or self._last[0] != values.tobytes():
            guess = None if self._last is None else self._last[1].displacements
            found = self._model.responses(self.web, values, self.goal.quantities, guess)
            self._last = values.tobytes(), found
            self.evaluations += 1
            self._keep(values, found)
        return self._last[1]

    def objective(self, values: Array, gradient: Array) -> float:
        found = self.responses(values)
        if gradient.size:
            gradient[:] = self.goal.objective_slope(found.slopes)
        return float(self.goal.objective(found.values))

    def rules(self, values: Array) -> tuple[Array, Array]:
        """Manufacturing constraints and envelope, mm, and their gradients."""
        room, room_slopes = self._room.constraints(self.web, values)
        return (
            np.concatenate([self.web.constraints(values), room]),
            np.vstack([self.web.slopes(values), room_slopes]),
        )

    def constrain(self, result: Array, values: Array, gradient: Array) -> None:
        found, (rules, slopes) = self.responses(values), self.rules(values)
        result[:] = np.concatenate([self.goal.excesses(found.values), _RULES * rules])
        if gradient.size:
            limits = self.goal.excess_slopes(found.slopes, len(values))
            gradient[:] = np.vstack([limits, _RULES * slopes])

    def _keep(self, values: Array, found: Responses) -> None:
        objective = self.goal.objective(found.values)
        if self.best is not None and objective >= self.best[0]:
            return
        held = self.goal.excesses(found.values).max(initial=0.0) < _HELD
        if held and self.rules(values)[0].max() < _KEPT_MM:
            self.best = objective, values.copy()


def search(
    model: WebModel,
    layout: Layout,
    start: Array,
    goal: SearchGoal,
    name: str,
    work: Work,
    evaluations: int = EVALUATIONS,
) -> tuple[Found | None, int]:
    """The best web of a layout near a start, and how many webs were solved.

    Args:
        start: (n,) parameters, mm or degrees; it may break rules and limits.
        name: under which the work keeps the result.

    Returns:
        None when no web that keeps limits and rules was found.

    Raises:
        CranktopoError: a failed solve.
    """

    def make() -> Json:
        task = _Search(model, layout, goal)
        _minimise(task, start, evaluations, work)
        sound = task.best is not None and _sound(model.scene, layout, task.best[1], work)
        values = [float(value) for value in task.best[1]] if task.best and sound else None
        return {"values": values, "evaluations": task.evaluations}

    kept = work.once(name, make)
    if kept["values"] is None:
        return None, kept["evaluations"]
    # Solved anew from nothing, so that a continued optimisation sees the very same numbers.
    values = np.array(kept["values"])
    found = model.responses(model.web(layout), values, goal.quantities)
    return Found(layout, values, goal.objective(found.values), found), kept["evaluations"]


def prices_of(model: WebModel, found: Found, goal: SearchGoal) -> Prices:
    """What each limit, rule and bound costs at an optimum."""
    task = _Search(model, found.layout, goal)
    values, slopes, count = found.responses.values, found.responses.slopes, len(found.values)
    low, high = task.web.bounds
    return prices(
        goal.objective_slope(slopes),
        (goal.excesses(values), goal.excess_slopes(slopes, count)),
        task.rules(found.values),
        (found.values - low, high - found.values),
    )


def shaped_scene(scene: Scene, layout: Layout, values: Array) -> Scene:
    """The scene with a web of the family; what only concerns the original web is left out.

    Raises:
        CranktopoError: the web does not fit the throw.
    """
    web = scene_with_web(scene, web_of(layout, values, scene)).web
    changes = {"web": web, "name": f"{scene.name}-shape", "published": None, "original": None}
    return scene.model_copy(update=changes)


def _sound(scene: Scene, layout: Layout, values: Array, work: Work) -> bool:
    """Whether the rounded dimensions make a web that the scene accepts."""
    try:
        shaped_scene(scene, layout, values)
    except CranktopoError as error:
        work.info(f"left out: {error}")
        return False
    return True


def _minimise(task: _Search, start: Array, evaluations: int, work: Work) -> None:
    import nlopt

    low, high = np.maximum(task.web.bounds[0], start - _REACH), np.minimum(task.web.bounds[1], start + _REACH)
    first = np.clip(start, low, high)
    count = len(task.goal.limits) + len(task.rules(first)[0])

    def objective(values: Array, gradient: Array) -> float:
        work.check()
        return task.objective(values, gradient)

    optimiser = nlopt.opt(nlopt.LD_SLSQP, len(first))
    optimiser.set_min_objective(objective)
    optimiser.add_inequality_mconstraint(task.constrain, np.full(count, _FEASIBLE))
    optimiser.set_lower_bounds(low)
    optimiser.set_upper_bounds(high)
    optimiser.set_xtol_abs(_STEP_MM)
    optimiser.set_ftol_rel(_FLAT)
    optimiser.set_maxeval(evaluations)
    with suppress(nlopt.RoundoffLimited):
        optimiser.optimize(first)
