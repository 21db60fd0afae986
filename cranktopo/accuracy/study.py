"""Climbing the ladders of a design, cheapest rung first, until a time budget is used."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from cranktopo.accuracy import evaluation_study as evaluation_study
from cranktopo.accuracy import stress_study as stress_study
from cranktopo.accuracy.level import Level
from cranktopo.accuracy.machine import Machine, this_machine
from cranktopo.errors import CranktopoError
from cranktopo.evaluate.targets import Target

Progress = Callable[[str], None]

_SHARES = {"judge": 0.35, "fillet stress": 0.2, "optimiser": 1.0}
"""Share of what is left of the budget that a ladder may use, in this order."""
_STRESS_POWER = 1.8
"""Growth of a mesh's cost with the fineness of its fillets (`python -m tests.benchmarks.fatigue_mesh`)."""


@dataclass(frozen=True)
class Task:
    """A rung that is still to be climbed.

    Attributes:
        name: shown.
        cost: relative to the other rungs of its ladder.
        run: solves it.
    """

    name: str
    cost: float
    run: Callable[[], Level]


@dataclass(frozen=True)
class Study:
    """All rungs that a budget allowed.

    Attributes:
        design: what was solved.
        budget_s: as given.
        spent_s: wall time of everything.
        machine: where.
        rungs: in the order of climbing.
        failures: rungs without an answer, and why, one sentence each.
        interrupted: whether the user ended it.
    """

    design: str
    budget_s: float
    spent_s: float
    machine: Machine
    rungs: tuple[Level, ...]
    failures: tuple[str, ...]
    interrupted: bool


def climb(target: Target, budget_s: float, progress: Progress = lambda _: None) -> Study:
    """Climb every ladder that a design calls for; an interruption keeps the rungs that are done.

    Args:
        target: a design; of a surface file only the judge's ladder is climbed.
        budget_s: wall time to use.
        progress: called with one line before every rung.
    """
    began = time.perf_counter()
    machine = this_machine()
    rungs: list[Level] = []
    failures: list[str] = []
    interrupted = False
    try:
        ladders = _ladders(target)
        for name, tasks in ladders.items():
            left = budget_s - (time.perf_counter() - began)
            share = 1.0 if name == list(ladders)[-1] else _SHARES[name]
            if left > 0:
                _climb_one(name, tasks, share * left, (began, budget_s), rungs, failures, progress)
    except KeyboardInterrupt:
        interrupted = True
    spent = time.perf_counter() - began
    return Study(target.name, budget_s, spent, machine, tuple(rungs), tuple(failures), interrupted)


def _climb_one(
    ladder: str,
    tasks: Sequence[Task],
    allowed_s: float,
    clock: tuple[float, float],
    rungs: list[Level],
    failures: list[str],
    progress: Progress,
) -> None:
    """Climb one ladder as far as its share of the budget allows; its first rung is always tried."""
    start, (began, budget) = time.perf_counter(), clock
    rate: float | None = None
    for number, task in enumerate(tasks):
        guess = None if rate is None else rate * task.cost
        used = time.perf_counter() - start
        if number > 0 and used + (guess or 0.0) > allowed_s:
            return
        about = "" if guess is None else f", about {guess:.2g} s"
        progress(f"{time.perf_counter() - began:.0f} of {budget:g} s: {ladder}, {task.name}{about}")
        try:
            rungs.append(task.run())
        except CranktopoError as error:
            failures.append(f"{ladder}, {task.name}: {error}")
            continue
        rate = rungs[-1].spent_seconds / task.cost


def _ladders(target: Target) -> dict[str, list[Task]]:
    found = {"judge": _judge_tasks(target)}
    if stress_study.calls_for_stress(target):
        found["fillet stress"] = _stress_tasks(target)
    if target.file is None and target.scene.envelope is not None:
        found["optimiser"] = _optimiser_tasks(target)
    return found


def _judge_tasks(target: Target) -> list[Task]:
    def task(model: evaluation_study.EvaluationMesh) -> Task:
        name = f"{model.family} {model.size_mm(target):.3g} mm"
        return Task(
            name, evaluation_study.relative_cost(model), lambda: evaluation_study.solve_level(target, model)
        )

    usable = [m for m in evaluation_study.LADDER if target.file is None or m.graded]
    return [task(model) for model in usable]


def _stress_tasks(target: Target) -> list[Task]:
    def task(fraction: float) -> Task:
        return Task(
            f"{fraction:g} of the radius",
            fraction**-_STRESS_POWER,
            lambda: stress_study.solve_stress_level(target, fraction),
        )

    return [task(fraction) for fraction in stress_study.LADDER]


def _optimiser_tasks(target: Target) -> list[Task]:
    from cranktopo.accuracy import optimiser_study as optimiser_study

    def task(model: optimiser_study.OptimiserModel) -> Task:
        cost = model.cell_mm**-3
        return Task(model.name, cost, lambda: optimiser_study.solve_optimiser_level(target.scene, model))

    return [task(model) for model in optimiser_study.optimiser_study(target.scene)]
