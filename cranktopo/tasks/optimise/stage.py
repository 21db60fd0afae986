"""The stages in order: scene -> plan -> load cases -> domain -> density -> surface -> files."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cranktopo.base.progress import KeptWork, Work
from cranktopo.base.side_by_side import Ahead
from cranktopo.design.assumed import (
    ENVELOPE,
    GOAL,
    LOADS,
    SUPPORTS,
    THROW,
    VIBRATION,
    Assumption,
    assumed_text,
    assumptions,
    stored_assumptions,
)
from cranktopo.design.goal.sentence import goal_text
from cranktopo.design.goal.wanted import wanted
from cranktopo.design.new_run import new_run
from cranktopo.design.of_run import design_from_run
from cranktopo.design.schema import Scene
from cranktopo.numerics.kernels.registry import compile_kernels
from cranktopo.numerics.precision import CompileClock, check_device, double_precision
from cranktopo.runs.checkpoint import load_checkpoint, save_checkpoint
from cranktopo.runs.directories import RunStore, check_destination, open_run
from cranktopo.runs.iterations import save_iteration
from cranktopo.runs.kind import require_kind
from cranktopo.runs.status import working_in
from cranktopo.tasks.accuracy.cell_choice import choose_cells
from cranktopo.tasks.density.build import build_problem
from cranktopo.tasks.density.coarse_start import first_state
from cranktopo.tasks.density.continuation import with_limit
from cranktopo.tasks.density.feasibility import check_limits
from cranktopo.tasks.density.problem import DensityProblem, Progress
from cranktopo.tasks.density.proposals import by_optimality_criteria, compile_optimality_criteria
from cranktopo.tasks.density.stage import Prepared, describe, iterate, prepare
from cranktopo.tasks.density.state import State, from_checkpoint, to_checkpoint
from cranktopo.tasks.fea.evaluation import Info
from cranktopo.tasks.fea.level import OPTIMISER
from cranktopo.tasks.fea.stored_studies import load_study
from cranktopo.tasks.importing.original import check_original
from cranktopo.tasks.optimise.goal_by_evaluation import evaluated_goal, met_by_evaluation

if TYPE_CHECKING:
    from cranktopo.tasks.optimise.finishing import Finisher

EVALUATIONS = "checkpoint/evaluations.json"
"""Evaluations of a goal's limits, kept so that a resumed run does not repeat them."""
_LIBRARIES = (
    "trimesh",
    "meshio",
    "skimage.measure",
    "scipy.ndimage",
    "matplotlib.backends.backend_svg",
    "jinja2",
)
"""What the end of a run imports, half a second's worth."""
RUN_TABLES = (THROW, LOADS, VIBRATION, SUPPORTS, ENVELOPE, GOAL)
"""What an optimisation uses of a scene."""


@dataclass(frozen=True)
class OptimisedRun:
    """A finished optimise run."""

    folder: Path
    metrics: dict[str, Any]


def optimise_design(
    scene: Scene,
    out: Path | None = None,
    design_toml: str | None = None,
    command: Sequence[str] = (),
    info: Info = lambda _: None,
    progress: Progress = lambda *_: None,
    began: float | None = None,
) -> OptimisedRun:
    """Optimise the web of a scene in a new run directory; nothing is written before all is validated.

    Args:
        scene: the design with all options in it.
        out: run directory; by default a new one under runs/.
        design_toml: text of the design as the user wrote it; by default written from the scene.
        command: the command line, for the manifest.
        began: reading of `time.perf_counter` from which the total time counts; now by default.

    Raises:
        CranktopoError: bad input, solver failure, or interruption (exit code 130, checkpoint saved).
    """
    began = time.perf_counter() if began is None else began
    check_destination(out)
    check_device()
    check_original(scene)
    Ahead(compile_kernels).begin()
    prepared = prepare(scene)
    assumed = assumptions(scene, RUN_TABLES)
    announce(prepared, assumed, info)
    with double_precision():
        clock = CompileClock()
        problem = build_problem(prepared.scene, prepared.domain, prepared.cases)
        check_limits(problem, prepared.scene, prepared.domain)
    run = new_run(scene, assumed, out, design_toml, command, {})
    return _optimise(run, scene, prepared, problem, clock, info, progress, began)


def announce(prepared: Prepared, assumed: Sequence[Assumption], info: Info) -> None:
    """Pass on what is going to be solved, what a user may not expect of it, and what is assumed."""
    info(describe(prepared))
    goal = wanted(prepared.scene)
    if goal is not None:
        info(goal_text(goal, "density"))
    for notice in prepared.notices:
        info(f"note: {notice}.")
    if assumed:
        info(assumed_text(assumed))


def with_cells_for(
    scene: Scene, accuracy_percent: float | None, budget_s: float | None, info: Info = lambda _: None
) -> Scene:
    """The scene with the cell size that an accuracy or a time asks for; `info` is called with the choice."""
    choice = choose_cells(scene, accuracy_percent, budget_s, load_study(scene.name, OPTIMISER))
    info(str(choice))
    return scene.with_optimise(resolution_mm=choice.cell_mm)


def resume_optimisation(
    reference: str,
    max_iterations: int | None = None,
    info: Info = lambda _: None,
    progress: Progress = lambda *_: None,
    began: float | None = None,
) -> OptimisedRun:
    """Continue an interrupted, stopped or killed run.

    Args:
        max_iterations: a new iteration limit; None keeps the run's.
        info, progress, began: as in `optimise_design`.

    Raises:
        CranktopoError: not a run of `optimise`, a changed input, or as `optimise_design`.
    """
    began = time.perf_counter() if began is None else began
    run = open_run(reference)
    require_kind(run, "optimise")
    run.require_same_inputs()
    scene = design_from_run(run).with_optimise(max_iterations=max_iterations)
    prepared = prepare(scene)
    announce(prepared, stored_assumptions(run.manifest().get("assumed", ())), info)
    with double_precision():
        clock = CompileClock()
        problem = build_problem(prepared.scene, prepared.domain, prepared.cases)
    return _optimise(run, scene, prepared, problem, clock, info, progress, began, resume=True)


def _optimise(
    run: RunStore,
    scene: Scene,
    prepared: Prepared,
    problem: DensityProblem,
    clock: CompileClock,
    info: Info,
    progress: Progress,
    began: float,
    resume: bool = False,
) -> OptimisedRun:
    with working_in(run, "what is done is saved") as check, double_precision():
        if resume:
            run.resume()
        state = _saved_state(run, problem) if resume else None
        Ahead(lambda: _compiled(problem)).begin()
        ahead = Ahead(lambda: _finisher(run, prepared))
        shown = _checked(progress, check, ahead)
        keep = _kept(run, shown)
        if state is None:
            state = first_state(problem, prepared.scene, prepared.domain, prepared.cases, shown)
        state = iterate(problem, state, keep)
        case = evaluated_goal(scene, prepared, problem, Work(info, KeptWork(run.path / EVALUATIONS), check))
        failure = ""
        if case is not None:
            state, failure = met_by_evaluation(
                case, state, lambda now: _save(run, now), lambda now: iterate(problem, now, keep)
            )
        metrics = ahead.result().finish(problem, state, began, clock, case, failure)
    run.log(f"{metrics['status']}: {metrics['stop_reason']}")
    return OptimisedRun(run.path, metrics)


def _saved_state(run: RunStore, problem: DensityProblem) -> State | None:
    if not run.checkpoint.is_file():
        return None
    saved = load_checkpoint(run.checkpoint)
    return with_limit(problem, from_checkpoint(saved.arrays, saved.state))


def _compiled(problem: DensityProblem) -> None:
    """Compile the first step's program while the first solve's are compiled."""
    if problem.method is by_optimality_criteria:
        with double_precision():
            compile_optimality_criteria(problem)


def _finisher(run: RunStore, prepared: Prepared) -> Finisher:
    """What ends a run: the libraries that surfaces, pictures and pages take are loaded here."""
    from cranktopo.tasks.optimise.finishing import finisher

    found = finisher(run, prepared)
    for name in _LIBRARIES:
        import_module(name)
    return found


def _checked(progress: Progress, check: Callable[[], None], ahead: Ahead[Finisher]) -> Progress:
    """Progress after which a run may be interrupted; after the first design the end is got ready."""

    def show(problem: DensityProblem, state: State) -> None:
        progress(problem, state)
        ahead.begin()
        check()

    return show


def _kept(run: RunStore, progress: Progress) -> Progress:
    """Progress that first keeps every iteration in the run, so that it can be resumed."""

    def keep(problem: DensityProblem, state: State) -> None:
        save_iteration(run.path, state.last.iteration, state.evaluated, state.last.beta)
        _save(run, state)
        if state.last.notice:
            run.log(f"iteration {state.last.iteration}: {state.last.notice}")
        progress(problem, state)

    return keep


def _save(run: RunStore, state: State) -> None:
    save_checkpoint(run.checkpoint, *to_checkpoint(state))
