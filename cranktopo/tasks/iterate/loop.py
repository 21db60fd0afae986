"""The loop over steps: resumable at every step and inside the optimisation of each."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.files import read_json, write_json, write_text
from cranktopo.base.near_ties import first_of_the_best
from cranktopo.base.progress import Json
from cranktopo.bodies.volume import web_volume_mm3
from cranktopo.design.assumed import assumptions, stored_assumptions
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.new_run import new_run
from cranktopo.design.of_run import design_from_run
from cranktopo.design.schema import Scene
from cranktopo.design.writing import toml_text
from cranktopo.engine.plan.planning import plan, planned_scene
from cranktopo.engine.plan.simulated import Feature
from cranktopo.numerics.surfaces.files import read_stl
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.report.report_file import REPORT, write_report
from cranktopo.report.result_table import comma_separated
from cranktopo.report.viewer.scene3d import ShownBody
from cranktopo.runs.directories import RunStore, check_destination, open_run
from cranktopo.runs.kind import LOOP, RESULT_FILES, SHAPE, require_kind
from cranktopo.runs.status import working_in
from cranktopo.tasks.bound.beside_result import bounds_beside
from cranktopo.tasks.density import stage
from cranktopo.tasks.density.notices import baseline_notice
from cranktopo.tasks.designs.run_webs import best_row
from cranktopo.tasks.fea.evaluation import Evaluation, Info, evaluate
from cranktopo.tasks.fea.targets import Target
from cranktopo.tasks.importing.imported_body import read_half_throw
from cranktopo.tasks.importing.original import check_original, original_file
from cranktopo.tasks.iterate.page import iterate_page
from cranktopo.tasks.iterate.plot import save_steps_plot
from cranktopo.tasks.iterate.result import Outcome
from cranktopo.tasks.iterate.settings import Settings, loop_settings
from cranktopo.tasks.iterate.shape_step import shape_scene, shape_step
from cranktopo.tasks.iterate.step import LoopStep, Verdict, best_step, step_of, verdict
from cranktopo.tasks.iterate.step_solids import read_web, write_envelope, write_original, write_solids
from cranktopo.tasks.iterate.text import LOOP_FILES, shape_line, steps_table
from cranktopo.tasks.iterate.transition import transition_mm
from cranktopo.tasks.optimise.stage import RUN_TABLES, announce, optimise_design, resume_optimisation
from cranktopo.tasks.refit.fit import fit_web
from cranktopo.tasks.refit.shape_error import shape_error
from cranktopo.throw.envelope import StlEnvelope

STEP_FILE = "step.json"
MOST_KEPT = 0.98
"""Largest volume fraction of a step: a little goes even where the re-model lost more than planned."""


def loop_scene(scene: Scene) -> Scene:
    """The design as a loop takes it where no process is asked for: forged unless it names one itself."""
    return scene.with_optimise(process="forged") if scene.optimise.process == "free" else scene


def start_loop(
    scene: Scene,
    settings: Settings | None = None,
    out: Path | None = None,
    design_toml: str | None = None,
    command: Sequence[str] = (),
    info: Info = lambda _: None,
) -> Outcome:
    """Run the loop in a new directory.

    Args:
        scene: the design with all options in it, from `loop_scene` unless its process is to stay free.
        settings: of the loop; by default those of `loop_settings`.
        out: directory; by default a new one under runs/.
        design_toml: text of the design as the user wrote it; by default written from the scene.
        command: the command line, for the manifest.

    Raises:
        CranktopoError: bad input (nothing is written), a failed stage, or interruption (exit code 130).
    """
    check_destination(out)
    settings = settings or loop_settings(scene)
    _check_goal(scene, settings)
    check_original(scene)
    assumed = assumptions(scene, RUN_TABLES)
    announce(stage.prepare(_without_goal(scene)), assumed, info)
    run = new_run(scene, assumed, out, design_toml, command, {LOOP: settings.as_json()})
    return _worked(run, scene, settings, info)


def continue_loop(reference: str, info: Info = lambda _: None) -> Outcome:
    """Continue an interrupted loop: finished steps are read, not repeated.

    Raises:
        CranktopoError: not a loop, or as `start_loop`.
    """
    run = open_run(reference)
    require_kind(run, LOOP)
    run.require_same_inputs()
    scene, settings = design_from_run(run), Settings.from_json(run.manifest()["options"][LOOP])
    return _worked(run, scene, settings, info, resume=True)


def _check_goal(scene: Scene, settings: Settings) -> None:
    """A goal is for the shape optimiser, and one that it can search for."""
    if settings.shape:
        shape_scene(scene)
    elif scene.goal is not None:
        raise CranktopoError(
            "goal: the loop takes volume away step by step; only its shape step knows a goal.",
            hint="Leave out --no-shape, or take [goal] out of the design.",
        )


def _without_goal(scene: Scene) -> Scene:
    """The design as the steps take it."""
    return scene.model_copy(update={"goal": None})


def _worked(run: RunStore, scene: Scene, settings: Settings, info: Info, resume: bool = False) -> Outcome:
    with working_in(run, "finished steps are kept") as check:
        if resume:
            run.resume()
        outcome = _loop(run, _without_goal(scene), settings, info, check)
        if settings.shape:
            check()
            outcome = _handed_over(run, scene, outcome, info)
        outcome = replace(outcome, bound=_bound(_without_goal(scene), outcome, info))
        _write_page(run, outcome)
        data = outcome.as_json()
        write_json(run.path / RESULT_FILES[LOOP], data)
        write_text(run.path / LOOP_FILES["csv"], comma_separated(steps_table(data["steps"])) + "\n")
        save_steps_plot(run.path / LOOP_FILES["plot"], data)
    run.log(outcome.stop_reason)
    return outcome


def _handed_over(run: RunStore, scene: Scene, outcome: Outcome, info: Info) -> Outcome:
    """The outcome with that of the shape optimisation, and its page."""
    best = outcome.best
    info(f"shape: begins with {'the original web' if best is None else f'the web of step {best.number}'}")
    begun = None if best is None else _scene_of(run.path, best.number)
    number = len(outcome.steps)
    outcome = replace(outcome, shaped=shape_step(run, scene, best, number, begun, outcome.settings, info))
    line = shape_line(outcome.as_json())
    info(line)
    run.log(line)
    return outcome


def _bound(scene: Scene, outcome: Outcome, info: Info) -> Json | None:
    """What no web of the envelope can beat, beside the best web of the loop."""
    best = best_row(outcome.as_json())
    if best is None or plan(scene)["bound"].state == "off":
        return None
    return bounds_beside(scene, best["percent_of_original"], None, info)


def _loop(run: RunStore, scene: Scene, settings: Settings, info: Info, check: Callable[[], None]) -> Outcome:
    scenes = [scene]
    steps = [_original(run, scene, settings, info)]
    reason = f"all {settings.steps} steps done"
    lost = ""
    durations: list[float] = []
    for number in range(1, settings.steps + 1):
        folder = run.path / f"step-{number:02d}"
        left = settings.steps - number + 1
        guess = f", about {sum(durations) / len(durations) * left:.0f} s left" if durations else ""
        began = time.monotonic()
        if not (folder / STEP_FILE).is_file():
            info(f"step {number} of {settings.steps}{guess}")
            try:
                _step(run, folder, number, scenes, settings, info)
            except CranktopoError as error:
                if number == 1 or error.code == ExitCode.INTERRUPTED:
                    raise
                lost = reason = f"step {number} was lost, the steps before it stand: {error}"
                info(reason)
                break
            durations.append(time.monotonic() - began)
        steps.append(LoopStep(**read_json(folder / STEP_FILE)["step"]))
        scenes.append(scene_from_dict(read_json(folder / STEP_FILE)["scene"], str(folder)))
        found = verdict(steps, settings.least_transition_mm)
        info(f"step {number}: {_line(steps)}: {found}")
        if found != "better":
            reason = _reason(found, steps, settings)
            break
        check()
        if left > 1:
            _write_page(run, _outcome(run, scene, steps, f"step {number} of {settings.steps} done", settings))
    outcome = replace(_outcome(run, scene, steps, reason, settings), lost=lost)
    _write_page(run, outcome)
    return outcome


def _outcome(
    run: RunStore, scene: Scene, steps: Sequence[LoopStep], reason: str, settings: Settings
) -> Outcome:
    best = best_step(steps, settings.least_transition_mm)
    notices = tuple(filter(None, [baseline_notice(scene)]))
    assumed = stored_assumptions(run.manifest().get("assumed", ()))
    return Outcome(run.path, scene.name, tuple(steps), reason, best, settings, notices, assumed=assumed)


def _write_page(run: RunStore, outcome: Outcome) -> None:
    """The report of what is done so far."""
    bodies = [_body(run.path, step.number) for step in outcome.steps]
    if len(outcome.rows) > len(bodies):
        bodies.append(_shaped_body(run.path / SHAPE))
    write_report(iterate_page(outcome.as_json(), run.manifest(), tuple(bodies)), run.path / REPORT)


def _body(folder: Path, number: int) -> ShownBody:
    name = "original web" if number == 0 else f"step {number}"
    scene, place = _scene_of(folder, number), _place(folder, number)
    return ShownBody(name, read_stl(place / "web.stl"), scene.web_z_mm, scene.pitch_mm / 2)


def _shaped_body(folder: Path) -> ShownBody:
    scene = load_scene(str(folder / "web.toml"))
    return ShownBody(SHAPE, read_stl(folder / "web.stl"), scene.web_z_mm, scene.pitch_mm / 2)


def _place(folder: Path, number: int) -> Path:
    return folder / ("original" if number == 0 else f"step-{number:02d}")


def _scene_of(folder: Path, number: int) -> Scene:
    path = _place(folder, number) / STEP_FILE
    return scene_from_dict(read_json(path)["scene"], str(path))


def _original(run: RunStore, scene: Scene, settings: Settings, info: Info) -> LoopStep:
    folder = run.path / "original"
    if not (folder / STEP_FILE).is_file():
        info("evaluating the original web")
        folder.mkdir(exist_ok=True)
        file = original_file(scene)
        if file is None:
            write_solids(scene, folder, run.started())
        else:
            write_original(file, scene, folder)
        step = step_of(0, _evaluated(scene, settings, file), transition_mm(read_web(folder), scene))
        write_json(folder / STEP_FILE, {"step": vars(step), "scene": scene.model_dump(mode="json")})
    return LoopStep(**read_json(folder / STEP_FILE)["step"])


def _step(
    run: RunStore, folder: Path, number: int, scenes: Sequence[Scene], settings: Settings, info: Info
) -> None:
    """Optimise in the last solid, extract, re-model, evaluate; step.json is written last."""
    began = time.monotonic()
    folder.mkdir(exist_ok=True)
    bounded, fraction = _bounded(folder, number, scenes, settings)
    info(f"  removing {100 * (1 - fraction):.0f} % of the envelope")
    surface = optimised_surface(folder / "optimise", bounded, info)
    info("  re-modelling")
    fitted = fit_web(surface, bounded, settings.limits)
    near = shape_error(fitted.scene, surface)
    scene = scenes[0].model_copy(
        update={
            "web": fitted.scene.web,
            "name": f"{scenes[0].name}-step-{number}",
            "published": None,
            "original": None,
        }
    )
    write_text(folder / "web.toml", toml_text(scene, f"Step {number} of the loop over {scenes[0].name}"))
    write_solids(scene, folder, run.started())
    info("  evaluating")
    found = _evaluated(scene, settings)
    thickness = transition_mm(read_web(folder), scene)
    removed = 100 * (1 - fraction)
    step = step_of(number, found, thickness, 100 * near.web_iou, removed, time.monotonic() - began)
    write_json(folder / STEP_FILE, {"step": vars(step), "scene": scene.model_dump(mode="json")})


def _bounded(folder: Path, number: int, scenes: Sequence[Scene], settings: Settings) -> tuple[Scene, float]:
    """The design inside the last re-modelled solid, and the share of it that stays."""
    scene = scenes[0]
    volume = _envelope_mm3(scene)
    share = scene.optimise.volume_fraction
    target = volume * share ** (number / settings.steps)
    if number > 1:
        volume = web_volume_mm3(scenes[-1])
        path = write_envelope(folder.parent / f"step-{number - 1:02d}")
        envelope = StlEnvelope(shape="stl", file=str(path.resolve()), symmetric=True)
        scene = scene.model_copy(update={"envelope": envelope})
    fraction = min(target / volume, MOST_KEPT)
    return scene.with_effect("bound", "off").with_optimise(volume_fraction=fraction), fraction


def _envelope_mm3(scene: Scene) -> float:
    """Designable volume of one web."""
    domain = stage.prepare(scene).domain
    return float((domain.design_fraction * domain.volume_mm3).sum()) / domain.symmetry_fraction / 2


def optimised_surface(folder: Path, scene: Scene, info: Info) -> SurfaceMesh:
    """Surface of the half throw of an optimisation, continued or read where it was begun or done before.

    Always read from the file: a loop that is continued gives the same webs as one in a single go.
    """
    if not (folder / "manifest.json").is_file():
        text = toml_text(scene, "One step of a loop")
        metrics = optimise_design(scene, folder, text, ["cranktopo", "iterate"]).metrics
    elif open_run(str(folder)).manifest()["status"] != "done":
        metrics = resume_optimisation(str(folder), info=info).metrics
    else:
        metrics = read_json(folder / "metrics.json")
    refusal = metrics["surface"].get("refusal")
    if refusal:
        raise CranktopoError(
            f"{folder}: the optimised web has no sound surface. {refusal}",
            hint="Run the loop on other cells: --resolution-mm.",
            code=ExitCode.CRITERION_NOT_MET,
        )
    return read_half_throw(folder / "web.stl", scene)


def _evaluated(scene: Scene, settings: Settings, file: Path | None = None) -> Evaluation:
    kept: tuple[Feature, ...] = ("bores", "fillets") if file else ()
    return evaluate(Target(scene.name, planned_scene(scene, kept), file), settings.element_size_mm)


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
        f"({gain:+.2f} % on step {best.number})"
    )
