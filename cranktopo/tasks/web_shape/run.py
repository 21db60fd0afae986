"""A shape optimisation as a run: the parametric web with its solid, drawing, table of dimensions and page."""

from __future__ import annotations

import shlex
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from cranktopo.base.errors import CranktopoError, ExitCode, invalid
from cranktopo.base.files import write_json, write_text
from cranktopo.base.notes import note
from cranktopo.base.progress import StageMemory, resumable_memory
from cranktopo.bodies.prisms import with_bolted
from cranktopo.bodies.seat import warn_of_cut_seat
from cranktopo.bodies.solid.bolted import threads_mm3
from cranktopo.bodies.solid.files import coarse_facet_mm, export_solid, surface_of
from cranktopo.design.assumed import (
    ENVELOPE,
    FATIGUE,
    LOADS,
    SEAT,
    SUPPORTS,
    THROW,
    VIBRATION,
    assumptions,
    stored_assumptions,
)
from cranktopo.design.goal.limit import Goal
from cranktopo.design.goal.scene_goal import require_goal
from cranktopo.design.halves import usual_scale
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.schema import Scene
from cranktopo.design.writing import design_from_run, new_run, toml_text
from cranktopo.engine.balance.kept import balance_kept
from cranktopo.engine.histories import Loads, WebLoads, loads_name
from cranktopo.engine.judged_histories import histories_of
from cranktopo.engine.plan.planning import plan, plan_for_stress
from cranktopo.numerics.gmsh_session import keeping_bodies
from cranktopo.numerics.precision import check_device, double_precision
from cranktopo.numerics.surfaces.files import read_stl
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.report.page import Page
from cranktopo.report.report_file import REPORT, write_report
from cranktopo.report.viewer.scene3d import ShownBody
from cranktopo.runs.directories import WORK, RunStore, check_destination, open_run, status_of
from cranktopo.runs.kind import (
    RESULT_FILES,
    SHAPE,
    reading_results,
    require_kind,
    result_file,
    working_in,
)
from cranktopo.tasks.bound.result import BoundStatement, NoBound
from cranktopo.tasks.bound.stage import bound_for_goal
from cranktopo.tasks.drawing.raw_sheet import raw_pages
from cranktopo.tasks.drawing.sheet import export_drawing, throw_sheets
from cranktopo.tasks.extraction.release import shaped_undercuts
from cranktopo.tasks.fatigue.taken_keys import assumed_by
from cranktopo.tasks.film.stage import film_change
from cranktopo.tasks.importing.imported_body import half_throw_surface
from cranktopo.tasks.importing.original import check_original, original_file
from cranktopo.tasks.refit.family import free_dimensions, with_free
from cranktopo.tasks.refit.fit import note_moved_ranges, usual_limits
from cranktopo.tasks.refit.process import process_limits
from cranktopo.tasks.refit.read_web import WebRead
from cranktopo.tasks.refit.stage import remodel_run
from cranktopo.tasks.web_shape.assembled import assembled
from cranktopo.tasks.web_shape.in_shaft import asks_for_shaft, left_alone, search_in_shaft
from cranktopo.tasks.web_shape.loads_told import METHODS, note_loads
from cranktopo.tasks.web_shape.optimum import ShapeOptimum, ShapeSettings
from cranktopo.tasks.web_shape.page import shape_page
from cranktopo.tasks.web_shape.reachable import check_reachable
from cranktopo.tasks.web_shape.result import ShapeFiles, ShapeResult
from cranktopo.tasks.web_shape.shaft_check import ShaftsBeside
from cranktopo.tasks.web_shape.stage import optimise_shape, stresses_in
from cranktopo.tasks.web_shape.start import scene_start
from cranktopo.throw.manufacturing_limits import ManufacturingLimits, ProcessLimits

TABLES = (THROW, LOADS, VIBRATION, SUPPORTS, ENVELOPE, SEAT, FATIGUE)
"""Tables of a scene that a shape optimisation uses."""
_BEGUN = "begun"
"""Key of the scene whose web the search began with, among the manifest's options."""
_FILES = ShapeFiles()


@dataclass(frozen=True)
class ShapedRun:
    """A finished shape optimisation; `result` is the content of shape.json."""

    folder: Path
    result: ShapeResult


def shape_settings(
    scene: DesignLike, limits: ManufacturingLimits | None = None, loads: Loads = "extremes"
) -> ShapeSettings:
    """Return settings that suit a throw of any size.

    Args:
        loads: load states over which fatigue safety and stress are judged.
    """
    scene = as_scene(scene, whole=False)
    usual, scale = ShapeSettings(), usual_scale(scene)
    cell_mm, mesh_mm = usual.cell_mm / scale, usual.mesh_mm / scale
    return ShapeSettings(cell_mm, mesh_mm, limits=limits or usual_limits(scene), loads=loads)


def shape_design(
    scene: DesignLike,
    settings: ShapeSettings | None = None,
    out: Path | str | None = None,
    design_toml: str | None = None,
    command: Sequence[str] = (),
    begun: Scene | RunStore | None = None,
) -> ShapedRun:
    """Optimise the dimensions of a scene's web in a new run; nothing is written before all is validated.

    Args:
        design_toml: text of the design as the user wrote it; by default written from the scene.
        command: the command line, for the manifest.
        begun: scene whose web the search begins with, or a run whose re-model is made for it; by default the
            design itself. Percent limits refer to the design's own web in any case.

    Raises:
        CranktopoError: bad input, no web that keeps the limits, or interruption (exit code 130).
    """
    scene = as_scene(scene, whole=False)
    out = check_destination(out)
    check_device()
    check_original(scene)
    scene = balance_kept(scene)
    goal = shape_goal(scene)
    plan(scene, goal=goal)
    if scene.envelope is None:
        raise invalid("envelope", None, "a shape optimisation needs one", "Add an [envelope] table.")
    settings = settings or shape_settings(scene)
    stress = plan_for_stress(scene)
    if stresses_in(goal.quantities):
        histories_of(scene, settings.loads, stress.enabled)  # refuses loads that the scene does not tell
    assumed = assumed_by(assumptions(scene, TABLES), METHODS)
    if not isinstance(settings.loads, WebLoads):  # of the webs of a shaft it is told once
        shaft_alone = scene.effects.continuous_shaft == "on" and not left_alone(scene, goal)
        note_loads(scene, None if shaft_alone else settings.loads, assumed)
        if asks_for_shaft(scene, goal, settings) and (why := left_alone(scene, goal)):
            note(f"{scene.name}: effect continuous_shaft has no part here, as {why}: a throw is alone")
    if isinstance(begun, RunStore):
        begun = _remodelled(begun, settings.limits)
    settings = replace(settings, limits=process_limits(scene, settings.limits))
    start = scene_start(scene, settings.limits, begun)
    if start.left_out:
        note(f"left out of the start: {'; '.join(start.left_out)}")
    begin = {} if begun is None else {_BEGUN: begun.model_dump(mode="json")}
    check_reachable(scene, goal, settings.cell_mm)
    run = new_run(scene, assumed, out, design_toml, command, {SHAPE: kept_settings(settings), **begin})
    return _worked(run, scene, settings, start)


def resume_shape(reference: str | Path, loads: WebLoads | None = None) -> ShapedRun:
    """Continue an interrupted shape optimisation: finished searches and evaluations are read, not repeated.

    Args:
        loads: of a web in its shaft, which the run of the whole shaft keeps.

    Raises:
        CranktopoError: not such a run, a changed input, or as `shape_design`.
    """
    run = open_run(reference)
    require_kind(run, SHAPE)
    run.require_same_inputs()
    options = run.manifest().options
    begun = options.get(_BEGUN)
    with reading_results(run):
        data = options[SHAPE]
        settings = settings_of({**data, "loads": loads or data["loads"]})
    if loads is None and data["loads"] == "shaft":
        raise CranktopoError(
            f"run '{run.path}': is the search of one web of `cranktopo shape --each-web`.",
            hint=f"Continue the whole: cranktopo shape --resume {shlex.quote(str(run.path.parent))}",
            code=ExitCode.USAGE,
        )
    scene = design_from_run(run)
    first = begun and scene_from_dict(begun, str(run.path / "manifest.json"))
    run.resume()
    return _worked(run, scene, settings, scene_start(scene, settings.limits, first))


def shape_in(
    folder: Path,
    scene: Scene,
    settings: ShapeSettings,
    command: Sequence[str],
    begun: Scene | RunStore | None = None,
) -> ShapeResult:
    """Return what a shape optimisation in a folder gives: begun, continued, or read where it is done.

    Arguments and errors as of `shape_design`.
    """
    status = status_of(folder)
    if status is None:
        return shape_design(scene, settings, folder, None, command, begun).result
    if status == "done":
        return ShapeResult.read(result_file(open_run(folder)))
    return resume_shape(folder, settings.loads if isinstance(settings.loads, WebLoads) else None).result


def kept_settings(settings: ShapeSettings) -> dict[str, Any]:
    """Return settings as a manifest has them: load states of webs in a shaft stay with the whole shaft."""
    plain = replace(settings, loads="extremes")
    return {**asdict(plain), "loads": loads_name(settings.loads)}


def settings_of(data: Mapping[str, Any]) -> ShapeSettings:
    """Return the settings that a manifest has."""
    return ShapeSettings(**{**data, "limits": ProcessLimits(**data["limits"])})


def _remodelled(run: RunStore, limits: ManufacturingLimits) -> Scene:
    """Return the parametric web fitted to a density optimisation that has none yet."""
    note(f"{run.name}: has no re-model yet, so it is made first: cranktopo remodel {run.path}")
    refit = remodel_run(str(run.path), given=vars(limits), evaluated=False)
    return load_scene(str(Path(refit.folder or ".") / refit.files.design))


def shape_goal(scene: Scene) -> Goal:
    """Return the goal of a scene with its limits, those by default among them."""
    return require_goal(scene, "shape optimisation", "torsion_per_mass")


def _worked(run: RunStore, scene: Scene, settings: ShapeSettings, start: WebRead) -> ShapedRun:
    began, goal = time.perf_counter(), shape_goal(scene)
    with working_in(run, "finished searches are kept") as check, double_precision(), keeping_bodies():
        work = resumable_memory(run.path / WORK, check)
        if shaft := search_in_shaft(scene, goal, settings, work):
            settings = replace(settings, loads=shaft.loads)
        shafts = ShaftsBeside(scene, goal, settings, work)
        optimum = optimise_shape(scene, goal, settings, work, start, shafts.begin_original)
        judge = sum(web.seconds for web in (optimum.original, *(one.web for one in optimum.rounds)))
        seconds = {"search": time.perf_counter() - began - judge, "judge": judge}
        shafts.begin(optimum.result.web.scene)
        bound = _bound(scene, goal, settings.cell_mm, optimum.original.values, work)
        seconds["bound"] = time.perf_counter() - began - sum(seconds.values())
        note("writing the solid and the drawing")
        half = _write(run, scene, optimum)
        written = time.perf_counter()
        checked, unjudged = shafts.judged()
        seconds["shaft"] = time.perf_counter() - written
        seconds["total"] = time.perf_counter() - began
        layout, values = with_free(start.layout, start.values, scene, free_dimensions(scene), start.sizes)
        begin = dict(zip(layout.names, map(float, values), strict=True))
        in_shaft = shaft.judged(optimum.result.web.scene, goal, work) if shaft else None
        found = assembled(scene, optimum, begin, seconds, settings.loads, in_shaft)
        reached = {"reached_percent": found.goal.reached_percent}
        shaped = optimum.result.web.scene
        note_moved_ranges(shaped, scene)
        more = {
            "bound": bound and bound.model_copy(update=reached),
            "assumed": stored_assumptions(run.manifest().assumed),
            "shaft_check": checked,
            "shaft_unjudged": unjudged or None,
            "undercuts": shaped_undercuts(_as_forged(half, shaped), shaped),
        }
        found = found.model_copy(update=more)
        write_json(run.path / RESULT_FILES[SHAPE], found.as_json())
        bodies = _bodies(scene, shaped, half)
        write_report(shape_page(found, run.manifest(), scene, bodies), run.path / REPORT)
    run.log(f"{found.status}: {found.stop_reason}")
    films = film_change(scene, optimum.result.web.scene)  # thickness of a web is taken from the bearings
    if films:
        note(films)
    return ShapedRun(run.path, found)


def _bound(
    scene: Scene, goal: Goal, cell_mm: float, original: Mapping[str, float], work: StageMemory
) -> BoundStatement | NoBound | None:
    if plan(scene, goal=goal)["bound"].state != "on":
        return None
    kept = work.once("bound", lambda: bound_for_goal(scene, goal, cell_mm, original).as_json())
    return (NoBound if "none" in kept else BoundStatement).of_json(kept, "bound")


def _write(run: RunStore, scene: Scene, optimum: ShapeOptimum) -> SurfaceMesh:
    """Write scene, exact solids and drawing of the best web; return the triangles of its half throw."""
    shaped, goal = optimum.result.web.scene, optimum.goal
    heading = f"Web of {scene.name} with the best dimensions for: {goal.sense} {goal.quantity}."
    warn_of_cut_seat(shaped)
    write_text(run.path / _FILES.design, toml_text(shaped, heading))
    export_solid(shaped, "half", run.path / _FILES.step, started=run.started())
    export_solid(shaped, "half", run.path / _FILES.stl)
    half = read_stl(run.path / _FILES.stl)
    sheets = throw_sheets(shaped, half)
    export_drawing(shaped, run.path / _FILES.drawing, sheets, raw_pages(shaped, sheets))
    return half


def finished_page(run: RunStore) -> Page:
    """Return the page of a finished shape optimisation from its files; raises CranktopoError."""
    found = ShapeResult.read(result_file(run))
    scene, shaped = design_from_run(run), load_scene(str(run.unchanged(_FILES.design)))
    bodies = _bodies(scene, shaped, read_stl(run.unchanged(_FILES.stl)))
    return shape_page(found, run.manifest(), scene, bodies)


def _as_forged(half: SurfaceMesh, shaped: Scene) -> SurfaceMesh:
    """Return the half throw before holes for the bolts of a counterweight are drilled: no die has them."""
    return surface_of(shaped, "half", coarse_facet_mm(shaped)) if threads_mm3(shaped) else half


def _bodies(scene: Scene, shaped: Scene, found: SurfaceMesh) -> tuple[ShownBody, ...]:
    file, facet_mm = original_file(scene), coarse_facet_mm(scene)
    before = surface_of(scene, "half", facet_mm) if file is None else half_throw_surface(file, scene)
    named = (("result", found, shaped), ("original web", before, scene))
    return tuple(
        ShownBody(name, with_bolted(mesh, of), of.web_z_mm, of.pitch_mm / 2) for name, mesh, of in named
    )
