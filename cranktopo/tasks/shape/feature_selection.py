"""Features of a web: each is tried for what it gains in the goal, and kept only if it pays."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.progress import Json, Work
from cranktopo.design.goal.constraint import Constraint, model_error, without_error
from cranktopo.tasks.refit.family import Layout, with_free, with_part
from cranktopo.tasks.refit.search import with_stations
from cranktopo.tasks.shape.candidate import DOUBT, MINIMUM_GAIN, WebCandidate, doubtful
from cranktopo.tasks.shape.free_bores import free_bores
from cranktopo.tasks.shape.pocket_places import pocket_starts
from cranktopo.tasks.shape.refining import Refinement, merit, refined
from cranktopo.tasks.shape.result import FeatureTrial
from cranktopo.tasks.shape.search import (
    EVALUATIONS,
    SearchResult,
    WebSolver,
    multipliers_of,
    search_on_cells,
    why_nothing,
)
from cranktopo.tasks.shape.search_goal import Quantities, SearchGoal
from cranktopo.tasks.shape.start import bevel_start, groove_start
from cranktopo.tasks.shape.web_model import WebModel
from cranktopo.throw.bevel import FittedBevel
from cranktopo.throw.fitted import FittedFeature

_CLEAR_GAIN = 0.015
"""Gain on cells, far above their errors, with which a feature is kept unseen by the elements."""
_MAXIMUM_POCKETS = 4
_MORE_STATIONS = (9,)
_REFINED = Refinement(3, 12, 5.0, 1.5e-3)
"""Of each trial that pays on cells."""


def _trial_text(trial: FeatureTrial) -> str:
    """Return one line of progress."""
    if trial.objective is None:
        return f"{trial.step}: no web that keeps limits and rules"
    gain = "" if trial.gain_percent is None else f", gain {trial.gain_percent:+.2f} %"
    violation = f", a limit missed by {trial.missed_percent:.2f} %" if trial.missed_percent else ""
    out = "" if trial.kept else ", left out"
    return f"{trial.step}: goal at {100 * abs(trial.objective):.2f} % of the original{violation}{gain}{out}"


def _no_web(reached: str) -> CranktopoError:
    """Return the error where no web keeps the limits.

    Args:
        reached: what the nearest web reaches of each.
    """
    return CranktopoError(
        f"shape: no web found that keeps all limits. The nearest, in percent of the original: {reached}.",
        hint="Loosen a limit, enlarge the envelope, or allow a smaller wall or radius.",
        code=ExitCode.CRITERION_NOT_MET,
    )


class FeatureSelection:
    """A web that grows by features; the trials in their order."""

    def __init__(
        self,
        model: WebModel,
        elements: WebSolver,
        goals: tuple[SearchGoal, SearchGoal],
        original: Mapping[str, float],
        work: Work,
    ) -> None:
        """Say what is wanted of a web.

        Args:
            elements: webs on body-fitted elements, which judge those of the cells.
            goals: in the numbers of the cells, and in those of the elements.
            original: quantities of the original web in the latter.
        """
        self.model, self.trials = model, list[FeatureTrial]()
        self._elements, self._original, self._work = elements, original, work
        self._cells_goal, self._goal = goals

    def first(self, layout: Layout, start: Array) -> WebCandidate:
        """Return the best web of the start's layout by cells; the nearest to its limits if none keeps them.

        Raises:
            CranktopoError: no web keeps the rules (exit code 6).
        """
        name = self._name
        found, solved = self._on_cells(layout, start, 2 * EVALUATIONS, {})
        self._note("outline", layout, found, None, found is not None, solved)
        if found is None:
            raise why_nothing(name, self._work)
        return found

    def select(self, best: WebCandidate) -> WebCandidate:
        """Return the web with every feature that pays: bevels and a groove, then pockets, then more stations.

        Raises:
            CranktopoError: no web keeps the limits (exit code 6).
        """
        best = self._with_features(best)
        if best.violation > DOUBT:
            raise _no_web(
                ", ".join(_required_and_reached(r, best.told, self._original) for r in self._goal.limits)
            )
        return best

    def _with_features(self, best: WebCandidate) -> WebCandidate:
        for part, guess in self._ends(best):
            best = self._with(best, part, guess)
        for bore in [name for name in free_bores(self.model.scene) if name not in best.layout.dimensions]:
            layout, start = with_free(best.layout, best.values, self.model.scene, (bore,))
            best = self._tried(best, layout, start, bore)
        for _ in range(_MAXIMUM_POCKETS):
            with self._leaving_out("pockets"):
                best = self._refined(best, f"before-{len(self.trials) + 1:02d}")
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

    def _ends(self, best: WebCandidate) -> Iterator[tuple[FittedFeature, Array]]:
        there = {part.label for part in best.layout.parts}
        for bevel in (FittedBevel("journal", hollow=True), FittedBevel("pin", hollow=True)):
            if bevel.label not in there and bevel.possible(self.model.scene):
                yield bevel, bevel_start(self.model.scene, bevel)
        groove, guess = groove_start(self.model.scene)
        if groove.label not in there and groove.possible(self.model.scene):
            yield groove, guess

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
        if found is None or not MINIMUM_GAIN <= found.gain_over(best) < _CLEAR_GAIN:
            return found, solved, best
        number = len(self.trials) + 1
        best = self._refined(best, f"before-{number:02d}")
        found = self._refined(found, f"refined-{number:02d}", best.required_merit)
        return found, solved + found.solved, best

    @contextmanager
    def _leaving_out(self, step: str) -> Iterator[None]:
        """Go on without a step whose web cannot be solved."""
        try:
            yield
        except CranktopoError as error:
            self._work.info(f"{step}: left out, as a web could not be solved: {error}")

    def _on_cells(
        self, layout: Layout, start: Array, evaluations: int, errors: Mapping[str, float]
    ) -> tuple[WebCandidate | None, int]:
        """Return the best web of a layout by cells with these errors, and how many webs were solved."""
        goal = self._cells_goal.corrected(errors)
        found, solved = search_on_cells(
            self.model, layout, start, goal, self._name, self._work, evaluations, True
        )
        if found is None:
            return None, solved
        told = {
            name: self._told(name, value, errors)
            for name, value in found.responses.values.items()
            if name in self._original
        }
        objective = merit(goal, found.responses.values)
        return WebCandidate(layout, found.values, objective, doubtful(found.violation), told, errors), solved

    def _told(self, name: str, value: float, errors: Mapping[str, float]) -> float:
        """Return a quantity of the cells in the numbers of the evaluation."""
        told = without_error(name, value, model_error(name, self.model.original[name], self._original[name]))
        return without_error(name, told, errors[name]) if name in errors else told

    @property
    def _name(self) -> str:
        return f"trial-{len(self.trials) + 1:02d}"

    def _refined(self, web: WebCandidate, name: str, required_merit: float = np.inf) -> WebCandidate:
        """Return a web of the cells, refined on body-fitted elements; one that was refined as it is.

        Args:
            worth: merit without hope of which the web is not refined further.
        """
        if web.exact is not None:
            return web

        def make() -> Json:
            cells, start = self.model.webs(), web.values
            made = refined(
                cells, self._elements, web.layout, start, self._goal, self._work, _REFINED, required_merit
            )
            return {
                "values": made.values.tolist(),
                "objective": made.merit,
                "quantities": made.found.values,
                "slopes": {name: slope.tolist() for name, slope in made.found.gradients.items()},
                "solved": made.solved,
            }

        kept = self._work.once(name, make)
        exact = Quantities(
            kept["quantities"], {name: np.array(slope) for name, slope in kept["slopes"].items()}
        )
        values = np.array(kept["values"])
        return WebCandidate(
            web.layout,
            values,
            kept["objective"],
            doubtful(float(self._goal.violations(exact.values).max(initial=0.0))),
            exact.values,
            self._errors(web.layout, values, exact.values),
            exact,
            kept["solved"],
        )

    def _errors(self, layout: Layout, values: Array, truth: Mapping[str, float]) -> dict[str, float]:
        """Return by how much the cells overrate each quantity of the goal for a web whose truth is known."""
        cells = self.model.responses(self.model.web(layout), values, ()).values
        return {
            name: model_error(name, self._told(name, cells[name], {}), truth[name])
            for name in set(self._cells_goal.quantities)
        }

    def _note(
        self,
        step: str,
        layout: Layout,
        found: WebCandidate | None,
        before: WebCandidate | None,
        kept: bool,
        solved: int,
    ) -> None:
        gain = None if found is None or before is None else 100 * found.gain_over(before)
        objective, violation = (None, 0.0) if found is None else (found.objective, 100 * found.violation)
        trial = FeatureTrial(
            step=step,
            parameters=len(layout.names),
            objective=objective,
            gain_percent=gain,
            kept=kept,
            evaluations=solved,
            missed_percent=violation,
        )
        self.trials.append(trial)
        self._work.info(_trial_text(trial))


def _required_and_reached(limit: Constraint, told: Mapping[str, float], original: Mapping[str, float]) -> str:
    """Return a limit with what a web reaches of it."""
    whole = original[limit.quantity]
    unit, size = (" %", 100 / whole) if whole > 0 else ("", 1.0)
    required, reached = size * limit.bound, size * told[limit.quantity]
    name = limit.quantity.replace("_", " ")
    return f"{name} {limit.sense} {required:.4g}{unit}: {reached:.1f}{unit} reached"
