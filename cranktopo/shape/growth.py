"""Which features a web should have: each is tried for what it gains in the goal, and kept only if it pays."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cranktopo.errors import CranktopoError, ExitCode
from cranktopo.remodel.dimensions import with_free, with_part
from cranktopo.remodel.family import Layout
from cranktopo.remodel.initial_guess import with_stations
from cranktopo.scene.features.bevel import FittedBevel
from cranktopo.scene.features.fitted import FittedFeature
from cranktopo.shape.cell_errors import CellErrors
from cranktopo.shape.free_bores import free_bores
from cranktopo.shape.pocket_places import pocket_starts
from cranktopo.shape.prices import Prices
from cranktopo.shape.search import EVALUATIONS, Found, prices_of, search
from cranktopo.shape.search_goal import SearchGoal
from cranktopo.shape.start import bevel_start, groove_start
from cranktopo.shape.web_model import WebModel
from cranktopo.store import Work

Array = NDArray[np.float64]
LEAST_GAIN = 2e-3
"""Least gain in the goal, relative to the original, that a feature or a station must bring."""
_MOST_POCKETS = 4
_MORE_STATIONS = (9,)
_AGAIN = 12
"""Most webs solved after the goal was corrected."""
_CORRECTIONS, _SAME_ERROR = 3, 2e-3
"""Most corrections of a trial, and the change of the errors below which there is no other."""


@dataclass(frozen=True)
class Trial:
    """One row of the table of what was tried.

    Attributes:
        step: stations or feature.
        parameters: how many parameters the web then has.
        objective: the goal, smaller is better; None where no web kept limits and rules.
        gain_percent: gain in the goal against what was there before, % of the original's; None likewise.
        kept: whether it is in the web.
        evaluations: webs solved.
    """

    step: str
    parameters: int
    objective: float | None
    gain_percent: float | None
    kept: bool
    evaluations: int


def trial_text(trial: Trial) -> str:
    """One line of progress."""
    if trial.objective is None:
        return f"{trial.step}: no web that keeps limits and rules"
    gain = "" if trial.gain_percent is None else f", gain {trial.gain_percent:+.2f} %"
    return f"{trial.step}: goal at {100 * abs(trial.objective):.2f} % of the original{gain}" + (
        "" if trial.kept else ", left out"
    )


def no_web() -> CranktopoError:
    """What is said where no web keeps limits and rules."""
    return CranktopoError(
        "shape: no web found that keeps limits and rules.",
        hint="Loosen a limit, enlarge the envelope, or allow a smaller wall or radius.",
        code=ExitCode.CRITERION_NOT_MET,
    )


class Growth:
    """A web that grows by features; the trials in their order."""

    def __init__(self, model: WebModel, goal: SearchGoal, errors: CellErrors, work: Work) -> None:
        """Say what is wanted of webs on cells.

        Args:
            goal: as the cells state it; it is corrected by their errors as the web grows.
        """
        self.model, self.goal, self.trials = model, goal, list[Trial]()
        self._plain, self._errors, self._work = goal, errors, work

    def first(self, layout: Layout, start: Array) -> Found:
        """The best web of the start's layout.

        Raises:
            CranktopoError: no web keeps limits and rules (exit code 6).
        """
        found, solved = self._searched(layout, start, 2 * EVALUATIONS)
        if found is not None:
            self.goal, found, again = self._corrected(found)
            solved += again
        self._note("outline", layout, found, None, found is not None, solved)
        if found is None:
            raise no_web()
        return found

    def grown(self, best: Found) -> Found:
        """The web with every feature that pays: bevels and a groove, then pockets, then more stations."""
        for part, guess in self._ends(best):
            best = self._with(best, part, guess)
        for bore in [name for name in free_bores(self.model.scene) if name not in best.layout.dimensions]:
            layout, start = with_free(best.layout, best.values, self.model.scene, (bore,))
            best = self._tried(best, layout, start, bore)
        for _ in range(_MOST_POCKETS):
            before, paid = best, self._prices(best)
            for part, guess in pocket_starts(self.model, best, self.goal, paid):
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

    def _prices(self, best: Found) -> Prices:
        web = self.model.web(best.layout)
        return prices_of(self.model.scene, web, best.values, best.responses, self.goal)

    def _ends(self, best: Found) -> Iterator[tuple[FittedFeature, Array]]:
        there = {part.label for part in best.layout.parts}
        for bevel in (FittedBevel("journal", hollow=True), FittedBevel("pin", hollow=True)):
            if bevel.label not in there:
                yield bevel, bevel_start(self.model.scene, bevel)
        groove, guess = groove_start(self.model.scene)
        if groove.label not in there:
            yield groove, guess

    def _with(self, best: Found, part: FittedFeature, guess: Array) -> Found:
        layout, start = with_part(best.layout, best.values, part, guess)
        return self._tried(best, layout, start, part.label)

    def _tried(self, best: Found, layout: Layout, start: Array, step: str) -> Found:
        found, solved = self._searched(layout, start, EVALUATIONS)
        goal = self.goal
        if found is not None and best.objective - found.objective >= LEAST_GAIN:
            goal, found, again = self._corrected(found)
            solved += again
        kept = found is not None and best.objective - found.objective >= LEAST_GAIN
        self._note(step, layout, found, best, kept, solved)
        if not kept or found is None:
            return best
        self.goal = goal
        return found

    def _corrected(self, found: Found) -> tuple[SearchGoal, Found | None, int]:
        """The goal with the errors of the cells for a web, the best web near it, how many were solved.

        A deep groove is misjudged more than the shallower one that is best: the errors of the web that the
        correction leads to are asked for again.
        """
        solved, before = 0, dict[str, float]()
        goal, best = self._plain, found
        for number in range(1, _CORRECTIONS + 1):
            errors = self._errors.of(best, f"{self._name}-coarse-{number}")
            if before and max(abs(errors[name] - before[name]) for name in errors) < _SAME_ERROR:
                break
            goal, before = self._plain.corrected(errors), errors
            name, start = f"{self._name}-again-{number}", (best.layout, best.values)
            again, more = search(self.model, *start, goal, name, self._work, _AGAIN)
            solved += more
            if again is None:
                return goal, None, solved
            best = again
        return goal, best, solved

    def _searched(self, layout: Layout, start: Array, evaluations: int) -> tuple[Found | None, int]:
        return search(self.model, layout, start, self.goal, self._name, self._work, evaluations)

    @property
    def _name(self) -> str:
        return f"trial-{len(self.trials) + 1:02d}"

    def _note(
        self, step: str, layout: Layout, found: Found | None, before: Found | None, kept: bool, solved: int
    ) -> None:
        gain = None if found is None or before is None else 100 * (before.objective - found.objective)
        objective = None if found is None else found.objective
        trial = Trial(step, len(layout.names), objective, gain, kept, solved)
        self.trials.append(trial)
        self._work.info(trial_text(trial))
