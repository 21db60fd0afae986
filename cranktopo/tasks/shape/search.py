"""Search for the best dimensions of one layout: sequential quadratic programming with exact gradients."""

from __future__ import annotations

from collections.abc import Callable, Collection
from contextlib import suppress
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.progress import Json, Work
from cranktopo.design.schema import Scene
from cranktopo.numerics.optimisers.multipliers import Prices, prices
from cranktopo.numerics.optimisers.restore_feasibility import mended
from cranktopo.tasks.refit.dimensions import rounded, scene_at
from cranktopo.tasks.refit.family import Layout, web_of
from cranktopo.tasks.refit.fit import scene_with_web
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.shape.envelope_clearance import EnvelopeClearance
from cranktopo.tasks.shape.rules import rules_at, rules_of
from cranktopo.tasks.shape.search_goal import SearchGoal
from cranktopo.tasks.shape.web_model import Responses, WebModel

EVALUATIONS = 20
_REACH = 15.0
"""How far a parameter may move in one search, mm or degrees."""
_RULES = 0.05
"""Weight of a millimetre of a manufacturing constraint against a limit's relative excess."""
_KEPT_MM = 5e-3
"""Violation of a rule that rounding of the dimensions absorbs."""
HELD = 1e-6
"""Relative excess of a limit with which a web still counts as keeping it by the evaluation: rounding."""
_NEARLY = 5e-4
"""The same on cells, which err by far more."""
_FEASIBLE, _STEP_MM, _FLAT = 1e-6, 2e-3, 1e-6
_STEEP = 2000.0
"""Factor on the goal. The method takes a curvature of 1 to begin with, while a millimetre changes the goal by
a thousandth: without the factor the first steps would be of micrometres."""
_ATTEMPTS = 4


class Quantities(Protocol):
    """Quantities of a web by name, and their gradients by its parameters, per mm or degree."""

    @property
    def values(self) -> dict[str, float]:
        """In the units of the goal's limits."""

    @property
    def slopes(self) -> dict[str, Array]:
        """Of those that were asked for, each (parameters,)."""


class Webs(Protocol):
    """Webs of a throw in one model, solved one after another."""

    @property
    def scene(self) -> Scene:
        """The throw."""

    def web(self, layout: Layout) -> ParametricWeb:
        """A web of the layout."""

    def responses(self, web: ParametricWeb, values: Array, quantities: Collection[str]) -> Quantities:
        """Quantities of a web with these values."""


@dataclass(frozen=True)
class Effort:
    """How long a search may be, and how far it may go.

    Attributes:
        evaluations: most webs solved.
        reach: how far a parameter may move, mm or degrees.
        nearest: whether the web that comes nearest to its limits is taken where none keeps them.
    """

    evaluations: int = EVALUATIONS
    reach: float = _REACH
    nearest: bool = False


@dataclass(frozen=True)
class Found:
    """The best web of a search on cells.

    Attributes:
        values: parameters of the layout, mm or degrees.
        objective: the goal, smaller is better.
        responses: its quantities and their gradients.
        missed: by how much it misses its limits, relative; 0 where it keeps them.
    """

    layout: Layout
    values: Array
    objective: float
    responses: Responses
    missed: float = 0.0


class _Search:
    """Objective and constraints of one search, each web solved once.

    Attributes:
        best: of the webs that keep the rules the one that misses its limits least, of those that keep them
            the one with the best goal: relative excess, goal, parameters.
    """

    def __init__(self, webs: Webs, layout: Layout, goal: SearchGoal) -> None:
        self.goal = goal
        self.web: ParametricWeb = webs.web(layout)
        self.evaluations = 0
        self.best: tuple[float, float, Array] | None = None
        self._webs = webs
        self._room = EnvelopeClearance(webs.scene)
        self._last: tuple[bytes, Quantities] | None = None
        self._ruled: tuple[bytes, tuple[Array, Array]] | None = None

    def responses(self, values: Array) -> Quantities:
        if self._last is None or self._last[0] != values.tobytes():
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

    @property
    def broken(self) -> str:
        """The rules that the last web breaks."""
        return rules_at(self._webs.scene, self.web, self.sound).broken_text

    def objective(self, values: Array, gradient: Array) -> float:
        found = self.responses(values)
        if gradient.size:
            gradient[:] = _STEEP * self.goal.objective_slope(found.slopes)
        return float(_STEEP * self.goal.objective(found.values))

    def rules(self, values: Array) -> tuple[Array, Array]:
        if self._ruled is None or self._ruled[0] != values.tobytes():
            self._ruled = values.tobytes(), rules_of(self.web, self._room, values)
        return self._ruled[1]

    def constrain(self, result: Array, values: Array, gradient: Array) -> None:
        found, (rules, slopes) = self.responses(values), self.rules(values)
        result[:] = np.concatenate([self.goal.excesses(found.values), _RULES * rules])
        if gradient.size:
            limits = self.goal.excess_slopes(found.slopes, len(values))
            gradient[:] = np.vstack([limits, _RULES * slopes])

    def _keep(self, values: Array, found: Quantities) -> None:
        rank = _missed(self.goal, found), self.goal.objective(found.values)
        better = self.best is None or rank < self.best[:2]
        if better and self.rules(values)[0].max() < _KEPT_MM:
            self.best = *rank, values.copy()


def best_values(
    webs: Callable[[], Webs],
    layout: Layout,
    start: Array,
    goal: SearchGoal,
    name: str,
    work: Work,
    effort: Effort,
) -> tuple[Array | None, int]:
    """Parameters of the best web of a layout near a start, and how many webs were solved.

    Args:
        webs: makes the model that solves them.
        start: (n,) parameters, mm or degrees; it may break rules and limits.
        name: under which the work keeps the result.

    Returns:
        None when no web that keeps limits and rules was found.

    Raises:
        CranktopoError: a failed solve.
    """

    def make() -> Json:
        model = webs()
        task = _Search(model, layout, goal)
        _minimise(task, start, effort, work)
        best = task.best
        why = task.broken if best is None else _refused(model.scene, layout, best[2])
        if why and best is not None:
            work.info(f"left out: {why}")
        kept = best is not None and not why and (effort.nearest or best[0] == 0)
        values = [float(value) for value in best[2]] if best and kept else None
        return {"values": values, "evaluations": task.evaluations, "why": why}

    kept = work.once(name, make)
    return None if kept["values"] is None else np.array(kept["values"]), kept["evaluations"]


def search(
    model: WebModel,
    layout: Layout,
    start: Array,
    goal: SearchGoal,
    name: str,
    work: Work,
    evaluations: int = EVALUATIONS,
    nearest: bool = False,
) -> tuple[Found | None, int]:
    """As `best_values` on cells, with the responses of the best web.

    Args:
        nearest: whether the web that comes nearest to its limits is taken where none keeps them.
    """
    effort = Effort(evaluations, nearest=nearest)
    values, solved = best_values(model.webs, layout, start, goal, name, work, effort)
    if values is None:
        return None, solved
    # Solved anew from nothing, so that a continued optimisation sees the very same numbers.
    found = model.responses(model.web(layout), values, goal.quantities)
    return Found(layout, values, goal.objective(found.values), found, _missed(goal, found)), solved


def why_nothing(name: str, work: Work) -> CranktopoError:
    """What is said where a search found no web that can be made, near its limits or not."""
    return CranktopoError(
        f"shape: no web can be made near the one to begin with: {work.kept[name]['why']}.",
        hint="Enlarge the envelope, allow a smaller wall or radius, or begin with another web.",
        code=ExitCode.CRITERION_NOT_MET,
    )


def prices_of(scene: Scene, web: ParametricWeb, at: Array, found: Quantities, goal: SearchGoal) -> Prices:
    """What each limit, rule and bound costs at an optimum.

    Args:
        at: (n,) parameters of the optimum.
        found: its quantities.
    """
    low, high = web.bounds
    return prices(
        goal.objective_slope(found.slopes),
        (goal.excesses(found.values), goal.excess_slopes(found.slopes, len(at))),
        rules_of(web, EnvelopeClearance(scene), at),
        (at - low, high - at),
    )


def shaped_scene(scene: Scene, layout: Layout, values: Array) -> Scene:
    """The scene with a web of the family and its dimensions of the throw, rounded to 0.01 mm.

    What only concerns the original web is left out.

    Raises:
        CranktopoError: the web does not fit the throw.
    """
    sized = scene_at(scene, layout, rounded(scene, layout, values))
    web = scene_with_web(sized, web_of(layout, values, sized)).web
    changes = {"web": web, "name": f"{scene.name}-shape", "published": None, "original": None}
    return sized.model_copy(update=changes)


def _missed(goal: SearchGoal, found: Quantities) -> float:
    """By how much the worst limit is missed, relative; 0 where all count as kept."""
    missed = float(goal.excesses(found.values).max(initial=0.0))
    return 0.0 if missed < _NEARLY else missed


def _refused(scene: Scene, layout: Layout, values: Array) -> str:
    """Why the scene refuses the web of the rounded dimensions; empty where it accepts it."""
    try:
        shaped_scene(scene, layout, values)
    except CranktopoError as error:
        return str(error).rstrip(".")
    return ""


def _minimise(task: _Search, start: Array, effort: Effort, work: Work) -> None:
    """Search; where a web cannot be solved, once more from the last sound one with a shorter reach."""
    start, reach = mended(task.rules, task.web.bounds, start), effort.reach
    for _ in range(_ATTEMPTS):
        try:
            return _descend(task, start, reach, effort.evaluations - task.evaluations, work)
        except CranktopoError as error:
            if task.evaluations == 0:
                raise
            work.info(
                f"a web on the way could not be solved ({error}): on from the last one, in smaller steps"
            )
            start, reach = task.sound, reach / 4


def _descend(task: _Search, start: Array, reach: float, evaluations: int, work: Work) -> None:
    import nlopt

    low, high = task.web.bounds
    low, high = np.maximum(low, start - reach), np.minimum(high, start + reach)
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
    optimiser.set_maxeval(max(evaluations, 1))
    with suppress(nlopt.RoundoffLimited):
        optimiser.optimize(first)
