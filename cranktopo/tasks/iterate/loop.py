"""The loop over steps: resumable at every step and inside the optimisation of each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.files import write_json, write_text
from cranktopo.base.near_ties import first_of_the_best
from cranktopo.base.notes import bar, duration_text, indented, note
from cranktopo.design.assumed import assumptions, stored_assumptions
from cranktopo.design.loading import stored_scene
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.schema import Scene
from cranktopo.design.writing import design_from_run, new_run
from cranktopo.engine.plan.planning import plan
from cranktopo.numerics.surfaces.files import read_stl
from cranktopo.report.page import Page
from cranktopo.report.report_file import REPORT, write_report
from cranktopo.report.result_table import comma_separated
from cranktopo.report.viewer.scene3d import ShownBody
from cranktopo.runs.directories import RunStore, check_destination, open_run
from cranktopo.runs.kind import LOOP, RESULT_FILES, SHAPE, require_kind, result_file, working_in
from cranktopo.runs.stored import unchanged
from cranktopo.tasks.bound.result import BoundStatements, NoBound
from cranktopo.tasks.bound.stage import bounds_for_result
from cranktopo.tasks.density import stage
from cranktopo.tasks.density.stage import baseline_notice
from cranktopo.tasks.importing.original import check_original
from cranktopo.tasks.iterate.one_step import StepWeb, finished_step, make_step, original_web
from cranktopo.tasks.iterate.page import iterate_page, save_steps_plot
from cranktopo.tasks.iterate.result import (
    LoopResult,
    LoopRun,
    LoopStep,
    Settings,
    StepRow,
    Verdict,
    best_step,
    loop_settings,
    verdict,
)
from cranktopo.tasks.iterate.shape_step import shape_scene, shape_step
from cranktopo.tasks.iterate.text import LOOP_FILES, shape_lines, steps_table
from cranktopo.tasks.optimise.stage import RUN_TABLES, announce


def loop_scene(scene: DesignLike) -> Scene:
    """Return the design as a loop takes it where no process is asked for: forged unless it names one."""
    scene = as_scene(scene, whole=False)
    return scene.with_optimise(process="forged") if scene.optimise.process == "free" else scene


def start_loop(
    scene: DesignLike,
    settings: Settings | None = None,
    out: Path | str | None = None,
    design_toml: str | None = None,
    command: Sequence[str] = (),
) -> LoopRun:
    """Run the loop in a new directory.

    Args:
        scene: the design with all options in it, from `loop_scene` unless its process is to stay free.
        settings: by default those of `loop_settings`.
        out: directory; by default a new one under runs/.
        design_toml: text of the design as the user wrote it; by default written from the scene.
        command: the command line, for the manifest.

    Raises:
        CranktopoError: bad input (nothing is written), a failed stage, or interruption (exit code 130).
    """
    scene = as_scene(scene, whole=False)
    out = check_destination(out)
    settings = settings or loop_settings(scene)
    _check_goal(scene, settings)
    check_original(scene)
    assumed = assumptions(scene, RUN_TABLES)
    announce(stage.prepare(_without_goal(scene)), assumed)
    run = new_run(scene, assumed, out, design_toml, command, {LOOP: settings.as_json()})
    return _worked(run, scene, settings)


def continue_loop(reference: str | Path) -> LoopRun:
    """Continue an interrupted loop: finished steps are read, not repeated; raises as `start_loop`."""
    run = open_run(reference)
    require_kind(run, LOOP)
    run.require_same_inputs()
    scene, settings = design_from_run(run), Settings.from_json(run.manifest().options[LOOP])
    return _worked(run, scene, settings, resume=True)


def _check_goal(scene: Scene, settings: Settings) -> None:
    """Check that a goal is for the shape optimiser, and one that it can search for."""
    if settings.shape:
        shape_scene(scene)
    elif scene.goal is not None:
        raise CranktopoError(
            "goal: the loop takes volume away step by step; only its shape step knows a goal.",
            hint="Leave out --no-shape, or take [goal] out of the design.",
        )


def _without_goal(scene: Scene) -> Scene:
    return scene.model_copy(update={"goal": None})


def _worked(run: RunStore, scene: Scene, settings: Settings, resume: bool = False) -> LoopRun:
    with working_in(run, "finished steps are kept") as check:
        if resume:
            run.resume()
        bare = _without_goal(scene)
        webs, reason, lost = _steps(run, bare, settings, check)
        result = _result(run, bare, webs, reason, settings, lost)
        shown = result
        _write_page(run, shown, webs)
        if settings.shape:
            check()
            result = _handed_over(run, scene, webs, result, settings)
        result = result.model_copy(update={"bound": _bound(bare, result)})
        if result != shown:
            _write_page(run, result, webs)
        write_json(run.path / RESULT_FILES[LOOP], result.as_json())
        write_text(run.path / LOOP_FILES["csv"], comma_separated(steps_table(result.steps)) + "\n")
        save_steps_plot(run.path / LOOP_FILES["plot"], result)
    run.log(result.stop_reason)
    return LoopRun(run.path, result)


def _handed_over(
    run: RunStore, scene: Scene, webs: Sequence[StepWeb], result: LoopResult, settings: Settings
) -> LoopResult:
    """Optimise the shape of the best web; return the result with it."""
    best = None if result.best_step is None else webs[result.best_step]
    note(_progress(settings.steps + 1, webs, settings))
    note(f"shape: begins with {f'the web of step {best.step.number}' if best else 'the original web'}")
    start = None if best is None else best.scene
    found = shape_step(run, scene, best.step if best else None, len(webs), start, settings)
    result = result.model_copy(update={"shape": found.outcome})
    if found.row is not None:
        row = StepRow.of(found.row, webs[0].step, SHAPE)
        result = result.model_copy(update={"steps": [*result.steps, row]})
    for line in shape_lines(result):
        note(line)
        run.log(line)
    return result


def _bound(scene: Scene, result: LoopResult) -> NoBound | BoundStatements | None:
    """Return what no web of the envelope can beat, beside the best web of the loop."""
    if result.best is None or plan(scene)["bound"].state == "off":
        return None
    return bounds_for_result(scene, result.best.percent_of_original, None)


def _steps(
    run: RunStore, scene: Scene, settings: Settings, check: Callable[[], None]
) -> tuple[list[StepWeb], str, str]:
    """Return the webs of all steps, the original one first, why they ended, and why one was lost."""
    webs = [finished_step(run.path / "original") or original_web(run, scene, settings)]
    for number in range(1, settings.steps + 1):
        folder = run.path / f"step-{number:02d}"
        web = finished_step(folder)
        if web is None:
            note(_progress(number, webs, settings))
            try:
                with indented():
                    web = make_step(run, folder, number, webs, settings)
            except CranktopoError as error:
                if number == 1 or error.code == ExitCode.INTERRUPTED:
                    raise
                lost = f"step {number} was lost, the steps before it stand: {error}"
                note(lost)
                return webs, lost, lost
        webs.append(web)
        steps = [web.step for web in webs]
        found = verdict(steps, settings.least_transition_mm)
        note(f"step {number}: {_line(steps)}: {found}")
        if found != "better":
            return webs, _reason(found, steps, settings), ""
        check()
        if number < settings.steps:
            so_far = _result(run, scene, webs, f"step {number} of {settings.steps} done", settings)
            _write_page(run, so_far, webs)
    return webs, f"all {settings.steps} steps done", ""


def _progress(number: int, webs: Sequence[StepWeb], settings: Settings) -> str:
    """Return a line of how far the loop is, with the time left: the shape optimisation is its last part."""
    parts, done_s = settings.steps + settings.shape, [web.step.seconds for web in webs[1:]]
    left_s = (parts - number + 1) * sum(done_s) / max(len(done_s), 1)
    guess = f", about {duration_text(left_s)} left" if done_s else ""
    return f"loop: {bar(number - 1, parts)} {number} of {parts}{guess}"


def _result(
    run: RunStore, scene: Scene, webs: Sequence[StepWeb], reason: str, settings: Settings, lost: str = ""
) -> LoopResult:
    steps = [web.step for web in webs]
    best = best_step(steps, settings.least_transition_mm)
    return LoopResult(
        design=scene.name,
        stop_reason=reason,
        least_transition_mm=settings.least_transition_mm,
        best_step=None if best is None else best.number,
        notices=list(filter(None, [baseline_notice(scene)])),
        lost_step=lost or None,
        assumed=stored_assumptions(run.manifest().assumed),
        steps=[StepRow.of(step, steps[0], str(step.number) if step.number else "original") for step in steps],
    )


def finished_page(run: RunStore) -> Page:
    """Return the page of a finished loop from its files; raises CranktopoError."""
    found = LoopResult.read(result_file(run))
    steps = map(finished_step, (run.path / "original", *sorted(run.path.glob("step-[0-9][0-9]"))))
    return _page(run, found, [web for web in steps if web])


def _write_page(run: RunStore, result: LoopResult, webs: Sequence[StepWeb]) -> None:
    write_report(_page(run, result, webs), run.path / REPORT)


def _page(run: RunStore, result: LoopResult, webs: Sequence[StepWeb]) -> Page:
    bodies = [web.body() for web in webs]
    if len(result.steps) > len(bodies):
        bodies.append(_shaped_body(run.path / SHAPE))
    return iterate_page(result, run.manifest(), tuple(bodies))


def _shaped_body(folder: Path) -> ShownBody:
    scene = stored_scene(folder / "web.toml")
    mesh = read_stl(unchanged(folder / "web.stl"))
    return ShownBody(SHAPE, mesh, scene.web_z_mm, scene.pitch_mm / 2)


def _line(steps: Sequence[LoopStep]) -> str:
    share = steps[-1].percent_of(steps[0])
    return (
        f"mass {share['mass']:.1f} %, torsion {share['torsion']:.1f} %, bending {share['bending']:.1f} %, "
        f"torsion per mass {share['torsion_per_mass']:.1f} % of the original"
    )


def _reason(found: Verdict, steps: Sequence[LoopStep], settings: Settings) -> str:
    last = steps[-1]
    if found == "too thin":
        return (
            f"step {last.number}: the web is {last.transition_mm:.1f} mm thick beside a journal, "
            f"less than {settings.least_transition_mm:g} mm"
        )
    best = first_of_the_best(steps[1:-1], lambda step: step.torsion_per_kg)
    gain = 100 * (last.torsion_per_kg / best.torsion_per_kg - 1)
    return (
        f"step {last.number}: torsional stiffness per mass no longer improves "
        f"({gain:+z.2f} % on step {best.number})"
    )
