"""Evaluation to an accuracy or within a time: start at the rung that should do, and climb until it does."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from cranktopo.accuracy.evaluation_study import EvaluationMesh, relative_cost
from cranktopo.accuracy.stored_studies import Known
from cranktopo.evaluate.evaluation import Evaluation, MeshResult, evaluate_on_mesh, evaluation
from cranktopo.evaluate.targets import Target

Progress = Callable[[str], None]

RUNGS = tuple(EvaluationMesh(steps, graded=True) for steps in (2, 1, 0, -1, -2, -3))
"""The finer mesh of each evaluation, cheapest first; the coarser one has elements 1.5 times as large.

Meshes that are not refined at the fillets are cheaper, but two of them say little about their error.
"""
EXPECTED_PERCENT = (3.8, 2.6, 1.6, 1.1, 0.7, 0.4)
"""Bounds to be expected before anything is measured: medians of `tests.benchmarks.error_estimates`.

The last three go on as the first ones fall.
"""


@dataclass(frozen=True)
class ErrorTarget:
    """What the user wants of an evaluation.

    Attributes:
        percent: largest error of torsional and bending stiffness, or None.
        budget_s: wall time to use, or None.
    """

    percent: float | None = None
    budget_s: float | None = None


def evaluate_to(
    target: Target, wish: ErrorTarget, known: Known | None = None, progress: Progress = lambda _: None
) -> tuple[Evaluation, bool]:
    """Evaluate on the cheapest mesh that should do, and on finer ones until its own estimate agrees.

    A budget ends the climb before a mesh that would not fit; the cheapest one is always solved.

    Args:
        target: what to evaluate.
        wish: accuracy, time, or both.
        known: what was measured before, to start at the right rung.
        progress: called with one line per mesh.

    Returns:
        The last evaluation, and whether it has the accuracy.

    Raises:
        CranktopoError: impossible geometry or a failed solve.
    """
    began = time.perf_counter()
    solved: dict[EvaluationMesh, MeshResult] = {}
    found: Evaluation | None = None
    for rung in RUNGS[first_rung(wish, known) :]:
        coarser = EvaluationMesh(rung.steps + 1, rung.graded)
        todo = [model for model in (coarser, rung) if model not in solved]
        spent = time.perf_counter() - began
        if found is not None and _too_long(wish, spent, todo, solved):
            break
        for model in todo:
            solved[model] = evaluate_on_mesh(
                target, model.size_mm(target), graded=model.graded, progress=progress
            )
        found = evaluation(solved[coarser], solved[rung], time.perf_counter() - began)
        if wish.percent is not None and found.error_percent <= wish.percent:
            return found, True
    assert found is not None, "the first rung is always solved"
    return found, wish.percent is None


def first_rung(wish: ErrorTarget, known: Known | None) -> int:
    """Number of the rung to start on.

    Args:
        wish: accuracy, time, or both.
        known: what was measured before.
    """
    starts = []
    if wish.percent is not None:
        enough = [n for n, rung in enumerate(RUNGS) if _expected_percent(rung, known) <= wish.percent]
        starts.append(enough[0] if enough else len(RUNGS) - 1)
    if wish.budget_s is not None:
        seconds = [_expected_seconds(rung, known) for rung in RUNGS]
        fit = [n for n, s in enumerate(seconds) if s is not None and s <= wish.budget_s]
        starts.append(fit[-1] if fit else 0)
    return min(starts, default=0)


def _expected_percent(rung: EvaluationMesh, known: Known | None) -> float:
    measured = _measured(rung, known)
    errors = [measured[key] for key in ("error_percent", "uncertainty_percent")] if measured else []
    if errors and all(error is not None for error in errors):
        return float(sum(errors))
    return EXPECTED_PERCENT[RUNGS.index(rung)]


def _expected_seconds(rung: EvaluationMesh, known: Known | None) -> float | None:
    """Time of an evaluation on a rung, both meshes; None where one was never measured."""
    total = 0.0
    for model in (rung, EvaluationMesh(rung.steps + 1, rung.graded)):
        measured = _measured(model, known)
        if measured is None or known is None:
            return None
        total += measured["seconds"] * known.slowdown
    return total


def _measured(model: EvaluationMesh, known: Known | None) -> dict[str, float] | None:
    wanted = {"steps": model.steps, "graded": model.graded, "order": model.order}
    for rung in known.rungs("judge") if known else []:
        if wanted.items() <= rung["settings"].items():
            return rung
    return None


def _too_long(
    wish: ErrorTarget, spent: float, todo: list[EvaluationMesh], solved: dict[EvaluationMesh, MeshResult]
) -> bool:
    """Whether the next meshes would not fit into the budget, by what the last one took."""
    if wish.budget_s is None:
        return False
    last, judged = list(solved.items())[-1]
    rate = judged.seconds / relative_cost(last)
    return spent + sum(rate * relative_cost(model) for model in todo) > wish.budget_s
