"""Which features a web should have: each is tried for what it gains in the goal, and kept only if it pays."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
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
from cranktopo.shape.search import EVALUATIONS, Found, prices_of, search, why_nothing
from cranktopo.shape.search_goal import SearchGoal, SearchLimit
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
_DOUBT = 1e-2
"""Relative excess of a limit on corrected cells above which no finish will keep it."""
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
        missed_percent: by how much the worst limit is missed, 0 where all are kept. Then the gain is how
            much nearer the web comes.
    """

    step: str
    parameters: int
    objective: float | None
    gain_percent: float | None
    kept: bool
    evaluations: int
    missed_percent: float = 0.0


def trial_text(trial: Trial) -> str:
    """One line of progress."""
    if trial.objective is None:
        return f"{trial.step}: no web that keeps limits and rules"
    gain = "" if trial.gain_percent is None else f", gain {trial.gain_percent:+.2f} %"
    missed = f", a limit missed by {trial.missed_percent:.2f} %" if trial.missed_percent else ""
    out = "" if trial.kept else ", left out"
    return f"{trial.step}: goal at {100 * abs(trial.objective):.2f} % of the original{missed}{gain}{out}"


def no_web(reached: str) -> CranktopoError:
    """What is said where no web keeps the limits.

    Args:
        reached: what the nearest web reaches of each.
    """
    return CranktopoError(
        f"shape: no web found that keeps all limits. The nearest, in percent of the original: {reached}.",
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
        """The best web of the start's layout; the nearest to its limits where none keeps them.

        Raises:
            CranktopoError: no web keeps the rules (exit code 6).
        """
        name = self._name
        found, solved = self._searched(layout, start, 2 * EVALUATIONS, nearest=True)
        if found is not None:
            self.goal, found, again = self._corrected(found, nearest=True)
            solved += again
        self._note("outline", layout, found, None, found is not None, solved)
        if found is None:
            raise why_nothing(name, self._work)
        return found

    def grown(self, best: Found) -> Found:
        """The web with every feature that pays: bevels and a groove, then pockets, then more stations.

        Raises:
            CranktopoError: no web keeps the limits (exit code 6).
        """
        best = self._grown(best)
        if best.missed > _DOUBT:
            raise no_web(self._reached(best))
        return best

    def _reached(self, found: Found) -> str:
        """Each limit with what a web reaches of it, the errors of the cells allowed for."""
        return ", ".join(
            _asked_and_reached(asked, here, found.responses.values, self.model.original)
            for asked, here in zip(self._plain.limits, self.goal.limits, strict=True)
        )

    def _grown(self, best: Found) -> Found:
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
        # A web that misses a limit is improved by what comes nearer, or keeps it.
        try:
            goal, found, solved = self._found(best, layout, start)
        except CranktopoError as error:
            self._work.info(f"{step}: left out, as a web could not be solved: {error}")
            goal, found, solved = self.goal, None, 0
        kept = found is not None and _pays(best, found)
        self._note(step, layout, found, best, kept, solved)
        if not kept or found is None:
            return best
        self.goal = goal
        return found

    def _found(self, best: Found, layout: Layout, start: Array) -> tuple[SearchGoal, Found | None, int]:
        """The goal, the best web of a layout, corrected if it seems to pay, and how many webs were solved."""
        nearest = best.missed > 0
        found, solved = self._searched(layout, start, EVALUATIONS, nearest)
        if found is None or not _pays(best, found):
            return self.goal, found, solved
        goal, found, again = self._corrected(found, nearest)
        return goal, found, solved + again

    def _corrected(self, found: Found, nearest: bool) -> tuple[SearchGoal, Found | None, int]:
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
            again, more = search(self.model, *start, goal, name, self._work, _AGAIN, nearest)
            solved += more
            if again is None:
                return goal, None, solved
            best = again
        return goal, best, solved

    def _searched(
        self, layout: Layout, start: Array, evaluations: int, nearest: bool
    ) -> tuple[Found | None, int]:
        return search(self.model, layout, start, self.goal, self._name, self._work, evaluations, nearest)

    @property
    def _name(self) -> str:
        return f"trial-{len(self.trials) + 1:02d}"

    def _note(
        self, step: str, layout: Layout, found: Found | None, before: Found | None, kept: bool, solved: int
    ) -> None:
        gain = None if found is None or before is None else 100 * _gain(before, found)
        objective, missed = (None, 0.0) if found is None else (found.objective, 100 * found.missed)
        trial = Trial(step, len(layout.names), objective, gain, kept, solved, missed)
        self.trials.append(trial)
        self._work.info(trial_text(trial))


def _gain(before: Found, found: Found) -> float:
    """What a web gains over another in the goal; over one that misses a limit, how much nearer it comes."""
    if before.missed > 0 or found.missed > 0:
        return before.missed - found.missed
    return before.objective - found.objective


def _pays(before: Found, found: Found) -> bool:
    return (found.missed == 0 < before.missed) or _gain(before, found) >= LEAST_GAIN


def _asked_and_reached(
    asked: SearchLimit, corrected: SearchLimit, values: Mapping[str, float], original: Mapping[str, float]
) -> str:
    """A limit with what a web reaches of it, the errors of the cells allowed for."""
    whole = original[asked.quantity]
    error = corrected.value / asked.value if asked.value else 1.0
    unit, size = (" %", 100 / whole) if whole > 0 else ("", 1.0)
    required, reached = size * asked.value, size * values[asked.quantity] / error
    return (
        f"{asked.quantity.replace('_', ' ')} {asked.sense} {required:.4g}{unit}: {reached:.1f}{unit} reached"
    )
