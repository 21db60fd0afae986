"""The stage: a scene and a goal -> the dimensions of the best web that can be made.

Features are chosen on cells, which are fast but know no fillets, err beside pockets and tell no fatigue;
small gains are proven on coarse body-fitted elements. The web is then evaluated on the default mesh with all
limits, and each finish is a short search beside the evaluated web, by the gradients of coarse elements.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import Pace, note
from cranktopo.base.progress import StageMemory
from cranktopo.base.result import Result
from cranktopo.base.side_by_side import LazyFuture
from cranktopo.design.goal.limit import Goal, goal_text
from cranktopo.design.goal.quantities import quantity_named
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.histories import WebLoads
from cranktopo.numerics.optimisers.dimension_search import SearchBudget
from cranktopo.report.goal_table import missed_words
from cranktopo.tasks.refit.family import DECIMALS, Layout, rounded_dimensions, with_free
from cranktopo.tasks.refit.read_web import WebRead
from cranktopo.tasks.web_shape.evaluated_web import (
    EvaluatedWeb,
    coarse_shares,
    evaluated_original,
    evaluated_web,
)
from cranktopo.tasks.web_shape.feature_selection import FeatureSelection
from cranktopo.tasks.web_shape.mesh_model import MeshedWebs, MeshResponses
from cranktopo.tasks.web_shape.nearest_web import nearest_of, nearest_web, search_with_corrections
from cranktopo.tasks.web_shape.optimum import ShapeOptimum, ShapeRound, ShapeSettings
from cranktopo.tasks.web_shape.refining import SHORTER, CorrectedSurrogate, Step, merit, stepped
from cranktopo.tasks.web_shape.result import FeatureTrial
from cranktopo.tasks.web_shape.search import prices_of, shaped_scene, worst_violation
from cranktopo.tasks.web_shape.search_goal import Quantities, SearchGoal, goal_on_cells, search_goal_of
from cranktopo.tasks.web_shape.start import first_on_cells, not_on_cells, scene_start
from cranktopo.tasks.web_shape.text import TOLD_FIRST
from cranktopo.tasks.web_shape.web_model import WebModel, web_model

_SETTLED = 2e-3
"""Gain in the goal, over the original's, that is worth an evaluation beside a web that keeps the limits."""
_FINISH = SearchBudget(20, 0.8, nearest=True)
"""Of each finish: so near that cells brought to the evaluated web tell another one within 0.1 %."""
_FILLET_FRACTION = 0.6
"""Elements on a fillet over its radius where gradients are taken; its safety is brought to the truth."""
_MISSED, _FARTHER = 1e-2, 5.0
"""Violation of a limit from which on a finish reaches farther, in proportion, and how much at most."""
_FARTHER_IN_SHAFT = 2.0
"""The same under the loads of webs in their shaft, where many places are near the least safety."""
_LATE_ROUNDS = 2
"""So many times the finishes where none has kept the limits yet, as long as each comes nearer."""
_FREE_ROUNDS = 3
"""So many times the finishes for free dimensions that cells do not know, which move a little in each."""
_SAFE, _SURE = 5e-4, 2e-3
"""Part of a limit that the search keeps in reserve beside a web that keeps them all, and beside another."""
_BY_MASSES = frozenset({"inertia", "unbalance", "balance_factor"})
"""Quantities that grow with a power of a counterweight's radius, and that closed forms tell of any web."""
_PROMISE = f"promises {100 * _SETTLED:.1f} % more"
_FIRST = {True: "web of the cells", False: "web of the start"}
"""The web that finishes begin with, by whether features were sought."""
_SCATTER = 5e-3
"""The same of safety and stress: those of nearly equal webs scatter by half a percent from mesh to mesh."""


def optimise_shape(
    scene: Scene,
    goal: Goal,
    settings: ShapeSettings | None = None,
    work: StageMemory | None = None,
    start: WebRead | None = None,
    then: Callable[[], None] = lambda: None,
) -> ShapeOptimum:
    """Return the best web of the family for a goal; call inside `double_precision()`.

    Args:
        then: begins what may run beside the search once the stresses of the original web are known.

    Raises:
        CranktopoError: no envelope, no web that keeps limits and rules, or a failed solve.
    """
    settings, work = settings or ShapeSettings(), work or StageMemory()
    stressed = stresses_in(goal.quantities)
    own = None if scene.original is None else Path(scene.original.file)
    before, judged = evaluated_original(
        scene, stressed, settings.element_size_mm, work, own, settings.judging, then
    )
    cells = web_model(scene, settings.limits, settings.cell_mm)
    start = start or scene_start(scene, settings.limits)
    begins_free, trials = first_on_cells(scene, start.sizes), tuple[FeatureTrial, ...]()
    layout, begin = with_free(start.layout, start.values, scene, begins_free, start.sizes)
    if settings.features:
        chosen_for = goal_on_cells(goal, before.values, lambda: judged().values)
        selection = _selection(cells, goal, chosen_for, before, settings, work)
        candidate = selection.select(selection.first(layout, begin))
        layout, begin, trials = candidate.layout, candidate.values, tuple(selection.trials)
    original = judged()
    stated = search_goal_of(goal, original.values, original.values, cells.model.cases)
    layout, first = with_free(layout, begin, scene, not_on_cells(scene), start.sizes)
    finish = _LocalRefinement(cells, stated, layout, original, settings, work)
    rounds, unfinished = finish.rounds(first)
    best, web = _best(rounds, stated), cells.web(layout)
    found = finish.anchored(rounds[best])
    paid = prices_of(scene, web, rounds[best].values, found, stated)
    return ShapeOptimum(goal, stated, original, web, rounds, best, trials, found, paid, unfinished)


def _selection(
    cells: WebModel,
    goal: Goal,
    chosen_for: Goal,
    before: EvaluatedWeb,
    settings: ShapeSettings,
    work: StageMemory,
) -> FeatureSelection:
    """Return what seeks outline and features on cells, for a goal that stands for the true one there."""
    if set(chosen_for.limits) - set(goal.limits) or chosen_for.quantity != goal.quantity:
        note(f"cells have no fillets; features are chosen there by another {goal_text(chosen_for, 'shape')}")
    scene, cases = cells.scene, cells.model.cases
    known = {name: before.values[name] for name in cells.original if name in before.values}
    goals = (
        search_goal_of(chosen_for, cells.original, before.values, cases),
        search_goal_of(chosen_for, known, before.values, cases),
    )
    shares = work.once("original-coarse", lambda: coarse_shares(scene, settings.mesh_mm, before.values))
    coarse = MeshedWebs(scene, settings.limits, settings.mesh_mm, shares=shares)
    return FeatureSelection(cells, coarse, goals, before.values, work)


def responses_of_sound_web(webs: MeshedWebs, layout: Layout, values: Array) -> MeshResponses:
    """Return the quantities of a web as it was found, or as it is written where that alone is sound.

    Rules hold at places of the outline: a steep bevel may leave the web between two of them.
    """
    web = webs.web(layout)
    try:
        return webs.responses(web, values)
    except CranktopoError as error:
        if error.code != ExitCode.INVALID_INPUT:
            raise
        written = rounded_dimensions(webs.scene, layout, np.round(values, DECIMALS))
        return webs.responses(web, written)


def stresses_in(quantities: Collection[str]) -> frozenset[str]:
    """Return those of some quantities that are read off stresses, over the load states."""
    return frozenset(name for name in quantities if quantity_named(name).of_stress)


class _KeptFinish(Result):
    values: tuple[float, ...]
    merit: float
    solved: int


class _LocalRefinement:
    """Webs of one layout on body-fitted elements, and what the default mesh says of them."""

    def __init__(
        self,
        cells: WebModel,
        goal: SearchGoal,
        layout: Layout,
        original: EvaluatedWeb,
        settings: ShapeSettings,
        work: StageMemory,
    ) -> None:
        self._cells, self._scene = cells, cells.scene
        self._goal, self._layout = goal, layout
        self._original, self._settings, self._work = original, settings, work
        self._stressed = stresses_in(goal.quantities)
        self._coarse: dict[bytes, LazyFuture[MeshResponses]] = {}

    def anchored(self, web: ShapeRound) -> MeshResponses:
        """Return the quantities of a web as the evaluation tells them, with gradients of a coarse mesh."""
        return self._on_coarse_mesh(web.values).result().calibrated(web.web.values)

    def _on_coarse_mesh(self, values: Array) -> LazyFuture[MeshResponses]:
        """Return the work on a coarse mesh of a web, the same for the same web."""
        settings, fraction = self._settings, _FILLET_FRACTION if self._stressed else None
        webs = MeshedWebs(
            self._scene,
            settings.limits,
            settings.mesh_mm,
            fraction,
            stressed=self._stressed,
            loads=settings.loads,
        )
        work = LazyFuture(lambda: responses_of_sound_web(webs, self._layout, values))
        return self._coarse.setdefault(values.tobytes(), work)

    def rounds(self, start: Array) -> tuple[tuple[ShapeRound, ...], bool]:
        """Return the web of the cells and those of the finishes, until they keep limits and settle.

        True beside them where the last one misses a limit and no more of them were allowed.
        """
        rounds, effort, violation = [self._evaluated(start, 0, 0)], _FINISH, 0.0
        maximum = self._settings.rounds * (_FREE_ROUNDS if not_on_cells(self._scene) else 1)
        pace = Pace("finish on body-fitted elements", maximum, at_most=True, quiet_s=0.0)
        for number in range(1, _LATE_ROUNDS * maximum + 1):
            best = _best(rounds, self._goal)
            before = rounds[best]
            if number > maximum and (before.held or best + 1 < len(rounds)):
                break
            pace.begin()
            try:
                found = self._finished(before, number, effort, violation)
            except CranktopoError as error:
                note(f"finish {number} ended early, the best web before it stands: {error}")
                break
            if found is None:
                break
            rounds.append(found)
            better = _best(rounds, self._goal) == number
            if before.held and found.held and not better:
                break
            violation = 0.0 if better else violation + max(found.violation, 0.0)
            if not better:
                effort = replace(effort, reach=SHORTER * effort.reach)
        else:
            last = rounds[_best(rounds, self._goal)]
            return tuple(rounds), last is rounds[-1] and not last.met
        return tuple(rounds), False

    def _finished(
        self, before: ShapeRound, number: int, effort: SearchBudget, violation: float
    ) -> ShapeRound | None:
        """Return the best web near one that was evaluated, by its gradients; None where none promises to pay.

        What the last webs found beside it missed of a limit, `violation`, is kept in reserve as well.
        """

        def make() -> _KeptFinish:
            reserve = (_SAFE if before.held else _SURE) + violation
            goal = self._goal.reserved(reserve).reserved(_SCATTER, self._stressed)
            step = self._step(goal, before, effort)
            return _KeptFinish(values=tuple(step.values), merit=step.merit, solved=1 + step.solved)

        kept = self._work.once_as(_KeptFinish, f"finish-{number}", make)
        gain = merit(self._goal, before.web.values) - kept.merit
        if list(kept.values) == before.values.tolist():
            note(f"finish {number}: no web beside {_PROMISE if before.met else 'comes nearer to the limits'}")
            return None
        if before.held and gain < _SETTLED:
            note(f"finish {number}: no web beside {_PROMISE}")
            return None
        return self._evaluated(np.array(kept.values), number, kept.solved)

    def _step(self, goal: SearchGoal, before: ShapeRound, effort: SearchBudget) -> Step:
        """Return the best web beside one by cells, by slopes where it misses a limit and they find none."""
        farthest = _FARTHER_IN_SHAFT if isinstance(self._settings.loads, WebLoads) else _FARTHER
        near = _farther(effort, before, farthest)
        cells, exact = self._cells.webs(), self.anchored(before)

        def by_cells(corrected: SearchGoal) -> Step:
            return stepped(cells, self._layout, before.values, exact, corrected, self._work, near)

        step = search_with_corrections(goal, by_cells, lambda values: self._masses(goal, values))
        if before.met or worst_violation(self._goal, step.quantities) == 0:
            return step
        reaches = near.reach, max(near.reach, farthest * effort.reach)
        return self._nearest(goal, before.values, exact, step, reaches)

    def _nearest(
        self, goal: SearchGoal, at: Array, exact: Quantities, step: Step, reaches: tuple[float, float]
    ) -> Step:
        """Return the web nearest to its limits by slopes, or that of a step where it is nearer."""
        cells, web = self._cells.webs(), self._cells.web(self._layout)
        matched = CorrectedSurrogate(cells, at, cells.responses(web, at, goal.quantities), exact)

        def known(values: Array) -> dict[str, float]:
            return {**matched.responses(web, values, goal.quantities).values, **self._masses(goal, values)}

        def within(reach: float) -> Step:
            def by_slopes(corrected: SearchGoal) -> Step:
                return nearest_web(self._scene, web, at, exact, corrected, reach)

            return search_with_corrections(goal, by_slopes, known)

        here = Step(at, exact, merit(goal, exact.values), 0)
        first = min(here, step, key=lambda one: worst_violation(goal, one.quantities))
        return nearest_of(self._goal, goal, within, first, reaches)

    def _masses(self, goal: SearchGoal, values: Array) -> dict[str, float]:
        """Return what the limits name of inertia, unbalance and balance factor of a web, by closed forms.

        A counterweight's unbalance grows with the cube of its radius: no search by slopes sees that.
        """
        names = _BY_MASSES & {limit.quantity for limit in goal.limits}
        if not names:
            return {}
        balance = throw_balance(shaped_scene(self._scene, self._layout, values))
        known = {
            "inertia": balance.inertia_kg_mm2,
            "unbalance": balance.throw_unbalance_kg_mm,
            "balance_factor": balance.balance_factor_percent or 0.0,
        }
        return {name: known[name] for name in names}

    def _evaluated(self, values: Array, number: int, solved: int) -> ShapeRound:
        scene, size = shaped_scene(self._scene, self._layout, values), self._settings.element_size_mm
        name = f"evaluation-{number}"
        if name not in self._work.kept:
            self._on_coarse_mesh(values).begin()
        web = evaluated_web(scene, self._stressed, size, name, self._work, self._settings.judging)
        found = ShapeRound(web, values, tuple(100 * self._goal.violations(web.values)), solved)
        label = f"finish {number}" if number else _FIRST[self._settings.features]
        note(_round_text(label, found, self._original, self._goal))
        return found


def _farther(effort: SearchBudget, before: ShapeRound, most: float) -> SearchBudget:
    """Return the length of a finish: it reaches farther beside a web that misses its limits by much."""
    return replace(effort, reach=effort.reach * min(max(before.violation / _MISSED, 1.0), most))


def _best(rounds: Sequence[ShapeRound], goal: SearchGoal) -> int:
    """Return the round with the best goal of those that keep the limits; else the nearest to them."""
    held = [index for index, found in enumerate(rounds) if found.held]
    if held:
        return min(held, key=lambda i: (round(goal.objective(rounds[i].web.values), 6), i))
    return min(range(len(rounds)), key=lambda i: (round(100 * rounds[i].violation, 4), i))


def _round_text(label: str, shape_round: ShapeRound, original: EvaluatedWeb, goal: SearchGoal) -> str:
    changes = ", ".join(
        f"{name} {100 * (shape_round.web.values[name] / original.values[name] - 1):+z.2f} %"
        for name in TOLD_FIRST
        if name in original.values
    )
    missed = missed_words([limit.quantity for limit in goal.limits], shape_round.excess_percent)
    limits = f"limits missed: {missed}" if missed else "limits kept"
    return f"{label}: {changes} by the evaluation; {limits}"
