"""The best web so far, and its refinement: few webs on body-fitted elements, searches on cells between.

There the cells stand for the elements, brought to the value and the gradient of the last meshed web
(`numerics/optimisers/model_management.py`).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.base.notes import Pace, note
from cranktopo.base.progress import StageMemory
from cranktopo.numerics.optimisers.dimension_search import SearchBudget
from cranktopo.numerics.optimisers.model_management import ManagedModels, managed_search
from cranktopo.tasks.refit.family import Layout
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.web_shape.search import WebSolver, best_values
from cranktopo.tasks.web_shape.search_goal import Quantities, SearchGoal

MINIMUM_GAIN = 2e-3
"""Gain in the goal, relative to the original, that a feature or a station must bring."""
DOUBT = 1e-2
"""Violation of a limit above which no finish will keep it."""


@dataclass(frozen=True)
class WebCandidate:
    """The best web so far.

    Attributes:
        objective: the goal, with what slightly missed limits cost; smaller is better.
        violation: by how much it misses its limits, relative; 0 where it keeps them.
        quantities: its quantities in the numbers of the evaluation.
        errors: by how much the cells overrate them, also taken for webs that grow from it (`model_error`).
        exact: these by body-fitted elements; None while only the cells have told them.
    """

    layout: Layout
    values: Array
    objective: float
    violation: float
    quantities: Mapping[str, float]
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


_MISSED = 1.0
"""Cost of a relative excess of a limit in the goal when two webs are compared: above usual prices."""
SHORTER = 0.25
"""Factor on the reach after a step that did not pay."""


@dataclass(frozen=True)
class Refinement:
    """Length of a refinement.

    Attributes:
        steps: most searches on cells, each followed by a meshed web.
        evaluations: most webs on cells in each of them.
        reach: how far a parameter may move in the first of them, mm or degrees.
        settled: gain in the goal, over the original's, below which a step is not worth a mesh.
    """

    steps: int
    evaluations: int
    reach: float
    settled: float


@dataclass(frozen=True)
class Step:
    """A web of a refinement with its quantities and merit, and how many webs were solved to find it."""

    values: Array
    quantities: Quantities
    merit: float
    solved: int


class CorrectedSurrogate:
    """Webs of a rough model with the value and the gradient of an exact one at one web.

    What the rough model does not know is linear.
    """

    def __init__(self, webs: WebSolver, at: Array, rough: Quantities, exact: Quantities) -> None:
        """Match at the web with the parameters `at`, (n,)."""
        self.scene = webs.scene
        self._webs, self._at, self._rough, self._exact = webs, at, rough, exact

    def web(self, layout: Layout) -> ParametricWeb:
        """Return a web of the layout."""
        return self._webs.web(layout)

    def responses(self, web: ParametricWeb, values: Array, quantities: Collection[str]) -> Quantities:
        """Return quantities of a web with these values."""
        found = self._webs.responses(web, values, quantities)
        corrected = {name: self._corrected(name, found, values - self._at) for name in quantities}
        return Quantities(
            {name: value for name, (value, _) in corrected.items()},
            {name: slope for name, (_, slope) in corrected.items()},
        )

    def _corrected(self, name: str, quantities: Quantities, moved: Array) -> tuple[float, Array]:
        value, slope = self._exact.values[name], self._exact.gradients[name]
        if not self._rough.values.get(name):
            return value + float(slope @ moved), slope
        share = value / self._rough.values[name]
        rest = slope - share * self._rough.gradients[name]
        return share * quantities.values[name] + float(rest @ moved), share * quantities.gradients[
            name
        ] + rest


def merit(goal: SearchGoal, values: dict[str, float]) -> float:
    """Return the goal, with what missed limits cost; smaller is better."""
    return goal.objective(values) + _MISSED * float(np.maximum(goal.violations(values), 0.0).sum())


def refined(
    cells: WebSolver,
    meshed: WebSolver,
    layout: Layout,
    start: Array,
    goal: SearchGoal,
    work: StageMemory,
    extent: Refinement,
    required_merit: float = np.inf,
) -> Step:
    """Return the best web near a start by meshed webs, as few as can be; the goal is in their numbers.

    Args:
        required_merit: the web stays as it is once the next search promises less, where only that share of
            its promise counts that the search before kept.

    Raises:
        CranktopoError: the start cannot be solved.
    """
    models = _CellsAndElements(cells, meshed, layout, goal, work, extent, required_merit)
    best = managed_search(models, models.judged(start), extent.reach, extent.steps)
    return replace(best, solved=models.solved)


class _CellsAndElements(ManagedModels[Step, Step]):
    """Webs of a layout on cells and on body-fitted elements.

    Attributes:
        solved: webs so far.
    """

    def __init__(
        self,
        cells: WebSolver,
        meshed: WebSolver,
        layout: Layout,
        goal: SearchGoal,
        work: StageMemory,
        extent: Refinement,
        required_merit: float,
    ) -> None:
        self._cells, self._meshed, self._layout, self._goal, self._work = cells, meshed, layout, goal, work
        self._extent, self._required, self._kept_share, self.solved = extent, required_merit, 1.0, 0

    @cached_property
    def _web(self) -> ParametricWeb:
        return self._meshed.web(self._layout)

    @cached_property
    def _pace(self) -> Pace:
        return Pace("steps judged by elements", self._extent.steps, at_most=True)

    def judged(self, values: Array) -> Step:
        """Return a web by elements; raises CranktopoError where it cannot be solved."""
        found = self._meshed.responses(self._web, values, self._goal.quantities)
        self.solved += 1
        return Step(values, found, merit(self._goal, found.values), self.solved)

    @override
    def propose(self, best: Step, reach: float) -> Step:
        self._pace.begin()
        effort = SearchBudget(self._extent.evaluations, reach, nearest=True)
        at, found = best.values, best.quantities
        step = stepped(self._cells, self._layout, at, found, self._goal, self._work, effort)
        self.solved += step.solved
        return step

    @override
    def settled(self, best: Step, proposed: Step) -> bool:
        promised = best.merit - proposed.merit
        return promised < self._extent.settled or best.merit - self._kept_share * promised > self._required

    @override
    def judge(self, proposed: Step) -> Step | None:
        try:
            return self.judged(proposed.values)
        except CranktopoError as error:
            note(f"a web on the way could not be solved ({error}): a shorter step instead")
            return None

    @override
    def is_better(self, best: Step, proposed: Step, found: Step) -> bool:
        gain = best.merit - found.merit
        if gain > 0:
            self._kept_share = min(gain / (best.merit - proposed.merit), 1.0)
        return gain > 0

    @override
    def longer(self, reach: float) -> float:
        return reach

    @override
    def shorter(self, best: Step, proposed: Step, reach: float) -> float:
        return reach * SHORTER

    @override
    def is_near(self, best: Step, reach: float) -> bool:
        return False


def stepped(
    cells: WebSolver,
    layout: Layout,
    at: Array,
    exact: Quantities,
    goal: SearchGoal,
    work: StageMemory,
    effort: SearchBudget,
) -> Step:
    """Return the best web by cells brought to the truth of one web; that web where none is better."""
    rough = cells.responses(cells.web(layout), at, goal.quantities)
    matched, private = CorrectedSurrogate(cells, at, rough, exact), StageMemory({}, work.check)
    values, solved = best_values(lambda: matched, layout, at, goal, "step", private, effort)
    if values is None:
        return Step(at, exact, merit(goal, exact.values), solved + 1)
    promised = matched.responses(matched.web(layout), values, goal.quantities)
    return Step(values, promised, merit(goal, promised.values), solved + 2)
