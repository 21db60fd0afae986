"""An optimise run: the stages in order, begun or continued."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from cranktopo.base.arrays import Array
from cranktopo.base.companion import ALONE, Companion, Work
from cranktopo.base.notes import note
from cranktopo.base.progress import resumable_memory
from cranktopo.base.side_by_side import LazyFuture, OneBehind
from cranktopo.bodies.cells.domain import own_web
from cranktopo.design.assumed import (
    ENVELOPE,
    GOAL,
    LOADS,
    SEAT,
    SUPPORTS,
    THROW,
    VIBRATION,
    Assumption,
    assumed_text,
    assumptions,
    stored_assumptions,
)
from cranktopo.design.goal.scene_goal import goal_of
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.schema import Scene
from cranktopo.design.writing import design_from_run, new_run
from cranktopo.engine.analysis import analyse
from cranktopo.numerics.kernels.registry import compile_kernels
from cranktopo.numerics.precision import CompileClock, check_device, double_precision
from cranktopo.runs.checkpoint import load_checkpoint, save_checkpoint, save_iteration
from cranktopo.runs.directories import RunStore, check_destination, open_run
from cranktopo.runs.kind import require_kind, working_in
from cranktopo.tasks.accuracy.optimiser_levels import choose_cells
from cranktopo.tasks.density.assess import check_limits
from cranktopo.tasks.density.build import build_problem
from cranktopo.tasks.density.loop import check_fits, with_limit
from cranktopo.tasks.density.problem import DensityProblem, Progress
from cranktopo.tasks.density.proposals import by_optimality_criteria, compile_optimality_criteria
from cranktopo.tasks.density.stage import Prepared, first_state, iterate, note_model, prepare
from cranktopo.tasks.density.state import State, from_checkpoint, to_checkpoint
from cranktopo.tasks.importing.original import check_original
from cranktopo.tasks.optimise.evaluated_goal import enforce_limits_by_fea, evaluated_goal
from cranktopo.tasks.optimise.result import OptimisedRun
from cranktopo.tasks.throw_fea.studies import OPTIMISER, load_study

if TYPE_CHECKING:
    from cranktopo.tasks.optimise.finalise import Prefetched

EVALUATIONS = "checkpoint/evaluations.json"
"""Evaluations of a goal's limits, kept so that a resumed run does not repeat them."""
_LIBRARIES = (
    "trimesh",
    "meshio",
    "skimage.measure",
    "scipy.ndimage",
    "jinja2",
)
"""Libraries that the end of a run imports, half a second's worth."""
RUN_TABLES = (THROW, LOADS, VIBRATION, SUPPORTS, ENVELOPE, SEAT, GOAL)
"""Tables of a scene that an optimisation uses."""


@dataclass(frozen=True)
class _Job:
    """One optimisation of a run, and where it reports to.

    Attributes:
        prepared: with the scene as it is simulated.
        began: reading of `time.perf_counter`.
        beside: draws, and fills the cells of the original web.
        original: gives their solid fractions; None where a goal needs them sooner.
    """

    run: RunStore
    scene: Scene
    prepared: Prepared
    problem: DensityProblem
    clock: CompileClock
    progress: Progress
    began: float
    beside: Companion
    original: Work[Array] | None


def optimise_design(
    scene: DesignLike,
    out: Path | str | None = None,
    design_toml: str | None = None,
    command: Sequence[str] = (),
    progress: Progress = lambda *_: None,
    began: float | None = None,
    beside: Companion = ALONE,
) -> OptimisedRun:
    """Optimise the web of a scene in a new run directory; nothing is written before all is validated.

    Args:
        out: run directory; by default a new one under runs/.
        design_toml: text of the design as the user wrote it; by default written from the scene.
        command: the command line, for the manifest.
        began: reading of `time.perf_counter` from which the total time counts; now by default.
        beside: a second process; by default none, as whoever runs several optimisations has it.

    Raises:
        CranktopoError: bad input, solver failure, or interruption (exit code 130, checkpoint saved).
    """
    scene = as_scene(scene, whole=False)
    began = time.perf_counter() if began is None else began
    out = check_destination(out)
    check_device()
    check_original(scene)
    LazyFuture(compile_kernels).begin()
    prepared = prepare(scene)
    original = _original_web(prepared, beside)
    assumed = assumptions(scene, RUN_TABLES)
    announce(prepared, assumed)
    with double_precision():
        clock = CompileClock()
        problem = build_problem(prepared.scene, prepared.domain, prepared.cases)
        check_limits(problem, prepared.scene, prepared.domain)
    run = new_run(scene, assumed, out, design_toml, command, {})
    return _optimise(_Job(run, scene, prepared, problem, clock, progress, began, beside, original))


def announce(prepared: Prepared, assumed: Sequence[Assumption]) -> None:
    """Pass on what is going to be solved, what a user may not expect of it, and what is assumed."""
    note_model(prepared)
    if assumed:
        note(assumed_text(assumed))


def with_cells_for(scene: DesignLike, accuracy_percent: float | None, budget_s: float | None) -> Scene:
    """Return the scene with the cell size that an accuracy or a time asks for."""
    scene = as_scene(scene, whole=False)
    choice = choose_cells(scene, accuracy_percent, budget_s, load_study(scene.name, OPTIMISER))
    note(str(choice))
    return scene.with_optimise(resolution_mm=choice.cell_mm)


def resume_optimisation(
    reference: str | Path,
    max_iterations: int | None = None,
    progress: Progress = lambda *_: None,
    began: float | None = None,
    beside: Companion = ALONE,
) -> OptimisedRun:
    """Continue an interrupted, stopped or killed run; `max_iterations` of None keeps the run's limit.

    Raises:
        CranktopoError: not a run of `optimise`, a changed input, or as `optimise_design`.
    """
    began = time.perf_counter() if began is None else began
    run = open_run(reference)
    require_kind(run, "optimise")
    run.require_same_inputs()
    scene = design_from_run(run).with_optimise(max_iterations=max_iterations)
    prepared = prepare(scene)
    original = _original_web(prepared, beside)
    announce(prepared, stored_assumptions(run.manifest().assumed))
    with double_precision():
        clock = CompileClock()
        problem = build_problem(prepared.scene, prepared.domain, prepared.cases)
    job = _Job(run, scene, prepared, problem, clock, progress, began, beside, original)
    return _optimise(job, resume=True)


def _original_web(prepared: Prepared, beside: Companion) -> Work[Array] | None:
    if goal_of(prepared.scene) is not None:
        return None
    return beside.begin(own_web, prepared.scene, prepared.domain)


def _optimise(job: _Job, resume: bool = False) -> OptimisedRun:
    """Take a run through its stages: first design, iterations, limits by the evaluation, results."""
    run, problem = job.run, job.problem
    with working_in(run, "what is done is saved") as check, double_precision(), OneBehind() as saving:
        if resume:
            run.resume()
        LazyFuture(lambda: _compiled(problem)).begin()
        end = LazyFuture(lambda: _ready_for_the_end(job))
        progress = _checked(job.progress, check, end)
        kept = _kept(run, progress, saving)
        prepared, work = job.prepared, resumable_memory(run.path / EVALUATIONS, check)
        state = (_saved_state(job) if resume else None) or first_state(
            problem, prepared.scene, prepared.domain, prepared.cases, progress
        )
        state = iterate(problem, state, kept)
        case = evaluated_goal(job.scene, prepared, problem, work)
        state, failure = enforce_limits_by_fea(
            case, state, lambda now: _save(run, now, saving), lambda now: iterate(problem, now, kept)
        )
        saving.wait()
        from cranktopo.tasks.optimise.finalise import finalise_run

        times = job.began, job.clock
        return finalise_run(run, prepared, problem, state, *times, case, failure, end.result(), job.beside)


def _saved_state(job: _Job) -> State | None:
    if not job.run.checkpoint.is_file():
        return None
    saved = load_checkpoint(job.run.checkpoint)
    state = from_checkpoint(saved.arrays, saved.state)
    check_fits(job.problem, state)
    return with_limit(job.problem, state)


def _compiled(problem: DensityProblem) -> None:
    """Compile the first step's program while the first solve's are compiled."""
    if problem.method is by_optimality_criteria:
        with double_precision():
            compile_optimality_criteria(problem)


def _ready_for_the_end(job: _Job) -> Prefetched:
    """Find what the end needs, and load the libraries that surfaces and pages take."""
    from cranktopo.report.report_file import drawn_plots
    from cranktopo.tasks.loads.section import loads_pictures
    from cranktopo.tasks.optimise.finalise import Prefetched, cells_of_bound, judged_original

    scene = job.prepared.scene
    analysis = analyse(scene) if scene.engine else None
    loads = job.beside.begin(drawn_plots, loads_pictures(analysis))
    cells = cells_of_bound(job.run, job.prepared)
    for name in _LIBRARIES:
        import_module(name)
    filled = job.original() if job.original else None
    return Prefetched(cells, judged_original(job.problem, job.prepared, filled), loads)


def _checked(progress: Progress, check: Callable[[], None], end: LazyFuture[Prefetched]) -> Progress:
    """Return progress after which a run may be interrupted; after the first design the end is got ready."""

    def show(problem: DensityProblem, state: State) -> None:
        progress(problem, state)
        end.begin()
        check()

    return show


def _kept(run: RunStore, progress: Progress, saving: OneBehind) -> Progress:
    """Return progress that first keeps every iteration in the run, so that it can be resumed."""

    def keep(problem: DensityProblem, state: State) -> None:
        _save(run, state, saving)
        if state.last.notice:
            run.log(f"iteration {state.last.iteration}: {state.last.notice}")
        progress(problem, state)

    return keep


def _save(run: RunStore, state: State, saving: OneBehind) -> None:
    """Save a state and the last design beside the next iteration: the disk takes 40 ms to keep them."""
    arrays, data = to_checkpoint(state)

    def save() -> None:
        save_iteration(run.path, state.last.iteration, state.evaluated, state.last.beta)
        save_checkpoint(run.checkpoint, arrays, data)

    saving.begin(save)
