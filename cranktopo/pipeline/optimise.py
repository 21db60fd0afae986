"""The stages in order: scene -> plan -> load cases -> domain -> density -> surface -> files."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from importlib import import_module
from pathlib import Path
from typing import Any

from cranktopo.errors import CranktopoError, ExitCode
from cranktopo.fem.precision import CompileClock, double_precision
from cranktopo.optimise import loop
from cranktopo.optimise.assess import assess, assess_original
from cranktopo.optimise.stage import Prepared, Progress, describe, iterate, prepare
from cranktopo.optimise.state import State, from_checkpoint, to_checkpoint
from cranktopo.scene import Scene
from cranktopo.scene.loading import input_files
from cranktopo.scene.of_run import scene_of_run
from cranktopo.store import (
    RunStore,
    check_destination,
    create_run,
    load_checkpoint,
    locked,
    open_run,
    require_kind,
    save_checkpoint,
    save_iteration,
)

Notice = Callable[[str], None]


def start(
    scene: Scene, design_toml: str, command: Sequence[str], out: Path | None, notice: Notice
) -> tuple[RunStore, Prepared]:
    """Validate everything, then make the run directory.

    Args:
        scene: the scene with the command line's options in it.
        design_toml: text of the design as the user wrote it.
        command: the command line, for the manifest.
        out: run directory, or None for a new one under runs/.
        notice: called with one line about the model.

    Raises:
        CranktopoError: nothing has been written.
    """
    check_destination(out)
    prepared = prepare(scene)
    notice(describe(prepared))
    run = create_run(
        design=scene.name,
        design_toml=design_toml,
        scene=scene.model_dump(mode="json"),
        options={},
        command=command,
        inputs=input_files(scene),
        out=out,
    )
    return run, prepared


def reopen(reference: str, max_iterations: int | None, notice: Notice) -> tuple[RunStore, Prepared]:
    """An interrupted, stopped or killed run, ready to continue.

    Args:
        reference: path or name of the run.
        max_iterations: a new iteration limit, or None to keep the run's.
        notice: called with one line about the model.

    Raises:
        CranktopoError: not a run of `optimise`, or what is missing in it.
    """
    run = open_run(reference)
    require_kind(run, "optimise")
    run.require_same_inputs()
    prepared = prepare(scene_of_run(run).with_optimise(max_iterations=max_iterations))
    notice(describe(prepared))
    return run, prepared


def optimise(
    run: RunStore, prepared: Prepared, resume: bool, progress: Progress, began: float | None = None
) -> dict[str, Any]:
    """Optimise the web of a prepared scene and write the run's files.

    Args:
        run: where to write.
        prepared: from `start` or `reopen`.
        resume: continue from the run's checkpoint, if it has one.
        progress: called after every iteration.
        began: reading of `time.perf_counter` from which the total time counts; now by default.

    Returns:
        The metrics, as written to metrics.json.

    Raises:
        CranktopoError: solver failure, surface that fails its gates, interruption (exit code 130, the
            checkpoint is saved).
    """
    began = time.perf_counter() if began is None else began
    with locked(run.path), double_precision():
        clock = CompileClock()
        if resume:
            run.resume()
        problem = loop.build_problem(prepared.scene, prepared.domain, prepared.cases)
        state = _first_state(run, problem, resume)
        try:
            with ThreadPoolExecutor(1) as aside:
                # What `_finish` imports takes a second, and while programs compile the interpreter is free.
                aside.submit(import_module, "cranktopo.report.writing")
                state = iterate(problem, state, _kept(run, progress))
                metrics = _finish(run, prepared, problem, state, clock, began, aside)
        except KeyboardInterrupt:
            run.set_status("interrupted")
            run.log("interrupted")
            raise CranktopoError(
                f"interrupted; checkpoint saved in {run.path}.",
                hint=f"Continue with: cranktopo optimise --resume {run.path}",
                code=ExitCode.INTERRUPTED,
            ) from None
        except Exception as error:
            run.set_status("failed")
            run.log(f"failed: {error}")
            raise
        run.set_status("done")
        run.log(f"{metrics['status']}: {metrics['stop_reason']}")
        return metrics


def _first_state(run: RunStore, problem: loop.DensityProblem, resume: bool) -> State:
    if not (resume and run.checkpoint.is_file()):
        return loop.init(problem)
    saved = load_checkpoint(run.checkpoint)
    return loop.with_limit(problem, from_checkpoint(saved.arrays, saved.state))


def _kept(run: RunStore, progress: Progress) -> Progress:
    """Progress that first keeps every iteration in the run, so that it can be resumed."""

    def keep(problem: loop.DensityProblem, state: State) -> None:
        save_iteration(run.path, state.last.iteration, state.evaluated, state.last.beta)
        save_checkpoint(run.checkpoint, *to_checkpoint(state))
        if state.last.notice:
            run.log(f"iteration {state.last.iteration}: {state.last.notice}")
        progress(problem, state)

    return keep


def _finish(
    run: RunStore,
    prepared: Prepared,
    problem: loop.DensityProblem,
    state: State,
    clock: CompileClock,
    began: float,
    aside: Executor,
) -> dict[str, Any]:
    """Judge the final design in the optimiser's model at a tight tolerance and write every file."""
    from cranktopo.report.metrics import Timing, optimise_metrics
    from cranktopo.report.outputs import history_rows, write_outputs
    from cranktopo.report.writing import REPORT, write_run_report

    optimised = time.perf_counter()
    scene, domain = prepared.scene, prepared.domain
    design = loop.final_design(problem, state)
    rows = history_rows(state.history, problem.model.case_names)
    writing = aside.submit(write_outputs, run, scene, domain, design, rows)
    result = assess(problem, scene, domain, design.physical)
    original = assess_original(problem, scene, domain)
    outputs = writing.result()
    now = time.perf_counter()
    timing = Timing(now - began, now - optimised, clock.compile_s)
    metrics = optimise_metrics(
        run.name,
        scene,
        prepared.plan,
        domain,
        problem,
        state,
        design.physical,
        result,
        original,
        outputs,
        timing,
    )
    metrics["files"]["report"] = REPORT
    run.write_metrics(metrics)
    write_run_report(run, domain=domain)
    end = time.perf_counter()
    metrics["seconds"] |= {"total": end - began, "report": end - now}
    run.write_metrics(metrics)
    return metrics
