"""Features of a web: each is tried for what it gains in the goal, and kept only if it pays."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import note
from cranktopo.base.progress import StageMemory
from cranktopo.base.result import Result
from cranktopo.design.goal.constraint import Constraint, model_error, without_error
from cranktopo.numerics.optimisers.dimension_search import EVALUATIONS
from cranktopo.tasks.refit.family import Layout, with_free, with_part
from cranktopo.tasks.refit.search import with_stations
from cranktopo.tasks.web_shape.feature_starts import end_starts, pocket_starts
from cranktopo.tasks.web_shape.refining import (
    DOUBT,
    MINIMUM_GAIN,
    Refinement,
    WebCandidate,
    doubtful,
    merit,
    refined,
)
from cranktopo.tasks.web_shape.result import FeatureTrial
from cranktopo.tasks.web_shape.search import (
    FinishedSearch,
    SearchResult,
    WebSolver,
    multipliers_of,
    search_on_cells,
)
from cranktopo.tasks.web_shape.search_goal import Quantities, SearchGoal
from cranktopo.tasks.web_shape.start import free_bores
from cranktopo.tasks.web_shape.web_model import WebModel
from cranktopo.throw.fitted import FittedFeature

_CLEAR_GAIN = 0.015
"""Gain on cells, far above their errors, with which a feature is kept unseen by the elements."""
_MAXIMUM_POCKETS = 4
_MORE_STATIONS = (9,)
_REFINED = Refinement(3, 12, 5.0, 1.5e-3)
"""Of each trial that pays on cells."""


def _trial_text(trial: FeatureTrial) -> str:
    if trial.objective is None:
        return f"{trial.step}: no web that keeps limits and rules"
    gain = "" if trial.gain_percent is None else f", gain {trial.gain_percent:+z.2f} %"
    violation = f", a limit missed by {trial.missed_percent:.2f} %" if trial.missed_percent else ""
    out = "" if trial.kept else ", left out"
    return f"{trial.step}: goal at {100 * abs(trial.objective):.2f} % of the original{violation}{gain}{out}"


class _KeptRefinement(Result):
    values: tuple[float, ...]
    objective: float
    quantities: dict[str, float]
    slopes: dict[str, tuple[float, ...]]
    solved: int


class FeatureSelection:
    """A web that grows by features; the trials in their order."""

    def __init__(
        self,
        model: WebModel,
        elements: WebSolver,
        goals: tuple[SearchGoal, SearchGoal],
        original: Mapping[str, float],
        work: StageMemory,
    ) -> None:
        """Take the goal and the original in the numbers of the elements, which judge the webs of the cells.

        Args:
            goals: in the numbers of the cells, and in those of the elements.
        """
        self.model, self.trials = model, list[FeatureTrial]()
        self._elements, self._original, self._work = elements, original, work
        self._cells_goal, self._goal = goals

    def first(self, layout: Layout, start: Array) -> WebCandidate:
        """Return the best web of a layout by cells; the nearest to its limits if none keeps them."""
        name = self._name("trial")
        found, solved = self._on_cells(layout, start, 2 * EVALUATIONS, {})
        self._note("outline", layout, found, None, found is not None, solved)
        if found is None:
            why = FinishedSearch.of_json(self._work.kept[name], name).why
            raise CranktopoError(
                f"shape: no web can be made near the one to begin with: {why}.",
                hint="Enlarge the envelope, allow a smaller wall or radius, or begin with another web.",
                code=ExitCode.CRITERION_NOT_MET,
            )
        return found

    def select(self, best: WebCandidate) -> WebCandidate:
        """Return the web with every feature that pays: bevels and a groove, then pockets, then more stations.

        Raises:
            CranktopoError: no web keeps the limits.
        """
        best = self._with_features(best)
        if best.violation > DOUBT:
            reached = ", ".join(_reached(one, best.quantities, self._original) for one in self._goal.limits)
            raise CranktopoError(
                "shape: no web found that keeps all limits. The nearest, in percent of the original: "
                f"{reached}.",
                hint="Loosen a limit, enlarge the envelope, or allow a smaller wall or radius.",
                code=ExitCode.CRITERION_NOT_MET,
            )
        return best

    def _with_features(self, best: WebCandidate) -> WebCandidate:
        there = {part.label for part in best.layout.parts}
        for part, guess in end_starts(self.model.scene, self.model.limits):
            if part.label not in there:
                best = self._with(best, part, guess)
        for bore in [name for name in free_bores(self.model.scene) if name not in best.layout.dimensions]:
            layout, start = with_free(best.layout, best.values, self.model.scene, (bore,))
            best = self._tried(best, layout, start, bore)
        for _ in range(_MAXIMUM_POCKETS):
            with self._leaving_out("pockets"):
                best = self._refined(best, self._name("before"))
            before = best
            for part, guess in self._pockets(best):
                best = self._with(best, part, guess)
                if best is not before:
                    break
            if best is before:
                break
        for stations in (number for number in _MORE_STATIONS if number > best.layout.stations):
            layout = replace(best.layout, stations=stations)
            values = with_stations(best.layout, best.values, stations)
            best = self._tried(best, layout, values, f"{stations} stations")
        return best

    def _pockets(self, best: WebCandidate) -> Iterator[tuple[FittedFeature, Array]]:
        if best.exact is None:
            return iter(())
        web = self.model.web(best.layout)
        paid = multipliers_of(self.model.scene, web, best.values, best.exact, self._goal)
        cells = self.model.responses(web, best.values, self._cells_goal.quantities)
        found = SearchResult(best.layout, best.values, best.objective, cells)
        return pocket_starts(self.model, found, self._cells_goal.corrected(best.errors), paid)

    def _with(self, best: WebCandidate, part: FittedFeature, guess: Array) -> WebCandidate:
        layout, start = with_part(best.layout, best.values, part, guess)
        return self._tried(best, layout, start, part.label)

    def _tried(self, best: WebCandidate, layout: Layout, start: Array, step: str) -> WebCandidate:
        """Return the web with one feature more if it pays: clearly by the cells, else by the elements.

        A web that misses a limit is improved by what comes nearer, or keeps it.
        """
        found, solved = None, 0
        with self._leaving_out(step):
            found, solved, best = self._judged(best, layout, start)
        kept = found is not None and found.pays(best)
        self._note(step, layout, found, best, kept, solved)
        return found if kept and found is not None else best

    def _judged(
        self, best: WebCandidate, layout: Layout, start: Array
    ) -> tuple[WebCandidate | None, int, WebCandidate]:
        """Return the best web of a layout, how many were solved, and the web to compare it with.

        Both are refined where the cells cannot tell which is better.
        """
        found, solved = self._on_cells(layout, start, EVALUATIONS, best.errors)
        if found is not None and best.violation == 0 < found.violation:
            found = None
        clear = np.inf if any(part.rough_on_cells for part in layout.parts) else _CLEAR_GAIN
        if found is None or not MINIMUM_GAIN <= found.gain_over(best) < clear:
            return found, solved, best
        best = self._refined(best, self._name("before"))
        found = self._refined(found, self._name("refined"), best.required_merit)
        return found, solved + found.solved, best

    @contextmanager
    def _leaving_out(self, step: str) -> Iterator[None]:
        """Go on without a step whose web cannot be solved."""
        try:
            yield
        except CranktopoError as error:
            note(f"{step}: left out, as a web could not be solved: {error}")

    def _on_cells(
        self, layout: Layout, start: Array, evaluations: int, errors: Mapping[str, float]
    ) -> tuple[WebCandidate | None, int]:
        """Return the best web of a layout by cells with these errors, and how many webs were solved."""
        goal = self._cells_goal.corrected(errors)
        name = self._name("trial")
        found, solved = search_on_cells(self.model, layout, start, goal, name, self._work, evaluations, True)
        if found is None:
            return None, solved
        values = found.responses.values
        quantities = {
            name: self._as_evaluated(name, values[name], errors) for name in values if name in self._original
        }
        objective = merit(goal, values)
        return WebCandidate(
            layout, found.values, objective, doubtful(found.violation), quantities, errors
        ), solved

    def _as_evaluated(self, name: str, value: float, errors: Mapping[str, float]) -> float:
        """Return a quantity of the cells in the numbers of the evaluation."""
        corrected = without_error(
            name, value, model_error(name, self.model.original[name], self._original[name])
        )
        return without_error(name, corrected, errors[name]) if name in errors else corrected

    def _name(self, kind: str) -> str:
        return f"{kind}-{len(self.trials) + 1:02d}"

    def _refined(self, web: WebCandidate, name: str, required_merit: float = np.inf) -> WebCandidate:
        """Return a web of the cells, refined on body-fitted elements; one that was refined as it is."""
        if web.exact is not None:
            return web

        def make() -> _KeptRefinement:
            cells, start = self.model.webs(), web.values
            step = refined(
                cells, self._elements, web.layout, start, self._goal, self._work, _REFINED, required_merit
            )
            return _KeptRefinement(
                values=tuple(step.values),
                objective=step.merit,
                quantities=dict(step.quantities.values),
                slopes={name: tuple(slope) for name, slope in step.quantities.gradients.items()},
                solved=step.solved,
            )

        kept = self._work.once_as(_KeptRefinement, name, make)
        slopes = {name: np.array(slope) for name, slope in kept.slopes.items()}
        truth, values = kept.quantities, np.array(kept.values)
        violation = doubtful(float(self._goal.violations(truth).max(initial=0.0)))
        cells = self.model.responses(self.model.web(web.layout), values, ()).values
        errors = {
            name: model_error(name, self._as_evaluated(name, cells[name], {}), truth[name])
            for name in set(self._cells_goal.quantities)
        }
        found = web.layout, values, kept.objective, violation, truth, errors
        return WebCandidate(*found, Quantities(truth, slopes), kept.solved)

    def _note(
        self,
        step: str,
        layout: Layout,
        candidate: WebCandidate | None,
        before: WebCandidate | None,
        kept: bool,
        solved: int,
    ) -> None:
        trial = FeatureTrial(
            step=step,
            parameters=len(layout.names),
            objective=candidate and candidate.objective,
            gain_percent=100 * candidate.gain_over(before) if candidate and before else None,
            kept=kept,
            evaluations=solved,
            missed_percent=100 * candidate.violation if candidate else 0.0,
        )
        self.trials.append(trial)
        note(_trial_text(trial))


def _reached(limit: Constraint, quantities: Mapping[str, float], original: Mapping[str, float]) -> str:
    whole = original[limit.quantity]
    unit, size = (" %", 100 / whole) if whole > 0 else ("", 1.0)
    required, reached = size * limit.bound, size * quantities[limit.quantity]
    name = limit.quantity.replace("_", " ")
    return f"{name} {limit.sense} {required:.4g}{unit}: {reached:.1f}{unit} reached"
