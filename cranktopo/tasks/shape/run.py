"""A shape optimisation as a run: the parametric web with its solid, drawing, table of dimensions and page."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from cranktopo.base.errors import invalid
from cranktopo.base.files import write_json, write_text
from cranktopo.base.progress import KeptWork, Work
from cranktopo.bodies.solid.files import export_solid, surface_of
from cranktopo.design.assumed import (
    ENVELOPE,
    FATIGUE,
    LOADS,
    SUPPORTS,
    THROW,
    VIBRATION,
    assumed_text,
    assumptions,
)
from cranktopo.design.goal.limit import Goal
from cranktopo.design.goal.wanted import require_goal
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.manufacturing_limits import ManufacturingLimits
from cranktopo.design.new_run import new_run
from cranktopo.design.of_run import design_from_run
from cranktopo.design.scale import usual_scale
from cranktopo.design.schema import Scene
from cranktopo.design.writing import toml_text
from cranktopo.engine.plan.planning import plan
from cranktopo.numerics.precision import check_device, double_precision
from cranktopo.numerics.surfaces.files import read_stl
from cranktopo.report.report_file import REPORT, write_report
from cranktopo.report.viewer.scene3d import ShownBody
from cranktopo.runs.directories import RunStore, check_destination, open_run
from cranktopo.runs.kind import RESULT_FILES, SHAPE, require_kind
from cranktopo.runs.status import working_in
from cranktopo.tasks.bound.bound_for_result import bound_for_goal
from cranktopo.tasks.bound.result import read_bound
from cranktopo.tasks.drawing.stage import export_drawing
from cranktopo.tasks.fea.evaluation import Info
from cranktopo.tasks.importing.imported_body import half_throw_surface
from cranktopo.tasks.importing.original import check_original, original_file
from cranktopo.tasks.refit.family import free_dimensions, with_free
from cranktopo.tasks.refit.fit import usual_limits
from cranktopo.tasks.refit.read_web import WebRead
from cranktopo.tasks.refit.stage import remodel_run
from cranktopo.tasks.shape.assemble_result import assemble_result
from cranktopo.tasks.shape.page import shape_page
from cranktopo.tasks.shape.result import ShapeResult
from cranktopo.tasks.shape.stage import ShapeOptimum, ShapeSettings, optimise_shape
from cranktopo.tasks.shape.start import scene_start

_TABLES = (THROW, LOADS, VIBRATION, SUPPORTS, ENVELOPE, FATIGUE)
"""Tables of a scene that a shape optimisation uses."""
_KEPT = "work.json"
_BEGUN = "begun"
"""Key of the scene whose web the search began with, among the manifest's options."""
_FILES = {"design": "web.toml", "step": "web.step", "stl": "web.stl", "drawing": "drawing.pdf"}


@dataclass(frozen=True)
class ShapedRun:
    """A finished shape optimisation; `result` is the content of shape.json."""

    folder: Path
    result: ShapeResult


def shape_settings(scene: Scene, limits: ManufacturingLimits | None = None) -> ShapeSettings:
    """Return settings that suit a throw of any size."""
    usual, scale = ShapeSettings(), usual_scale(scene)
    kept = limits or usual_limits(scene)
    return ShapeSettings(usual.cell_mm / scale, usual.mesh_mm / scale, limits=kept)


def shape_design(
    scene: Scene,
    settings: ShapeSettings | None = None,
    out: Path | None = None,
    design_toml: str | None = None,
    command: Sequence[str] = (),
    info: Info = lambda _: None,
    begun: Scene | RunStore | None = None,
) -> ShapedRun:
    """Optimise the dimensions of a scene's web in a new run; nothing is written before all is validated.

    Args:
        scene: the design with its goal.
        out: run directory; by default a new one under runs/.
        design_toml: text of the design as the user wrote it; by default written from the scene.
        command: the command line, for the manifest.
        begun: scene whose web the search begins with, or a run whose re-model is made for it; by default the
            design itself. Percent limits refer to the design's own web in any case.

    Raises:
        CranktopoError: bad input, no web that keeps the limits, or interruption (exit code 130).
    """
    check_destination(out)
    check_device()
    check_original(scene)
    _goal(scene)
    if scene.envelope is None:
        raise invalid("envelope", None, "a shape optimisation needs one", "Add an [envelope] table.")
    settings = settings or shape_settings(scene)
    assumed = assumptions(scene, _TABLES)
    if assumed:
        info(assumed_text(assumed))
    if isinstance(begun, RunStore):
        begun = _remodelled(begun, settings.limits, info)
    start = scene_start(scene, settings.limits, begun)
    if start.left_out:
        info(f"left out of the start: {'; '.join(start.left_out)}")
    begin = {} if begun is None else {_BEGUN: begun.model_dump(mode="json")}
    run = new_run(scene, assumed, out, design_toml, command, {SHAPE: asdict(settings), **begin})
    return _worked(run, scene, settings, start, info)


def resume_shape(reference: str, info: Info = lambda _: None) -> ShapedRun:
    """Continue an interrupted shape optimisation: finished searches and evaluations are read, not repeated.

    Raises:
        CranktopoError: not such a run, a changed input, or as `shape_design`.
    """
    run = open_run(reference)
    require_kind(run, SHAPE)
    run.require_same_inputs()
    options = run.manifest()["options"]
    data, begun = options[SHAPE], options.get(_BEGUN)
    settings = ShapeSettings(**{**data, "limits": ManufacturingLimits(**data["limits"])})
    scene = design_from_run(run)
    first = None if begun is None else scene_from_dict(begun, str(run.path / "manifest.json"))
    run.resume()
    return _worked(run, scene, settings, scene_start(scene, settings.limits, first), info)


def _remodelled(run: RunStore, limits: ManufacturingLimits, info: Info) -> Scene:
    """Return the parametric web fitted to a density optimisation that has none yet."""
    info(f"{run.name}: has no re-model yet, so it is made first: cranktopo remodel {run.path}")
    made = remodel_run(str(run.path), given=vars(limits), evaluated=False, info=info)
    return load_scene(str(Path(made.folder or ".") / made.files["design"]))


def _goal(scene: Scene) -> Goal:
    return require_goal(scene, "shape optimisation", "torsion_per_mass")


def _worked(run: RunStore, scene: Scene, settings: ShapeSettings, start: WebRead, info: Info) -> ShapedRun:
    began, goal = time.perf_counter(), _goal(scene)
    with working_in(run, "finished searches are kept") as check, double_precision():
        work = Work(info, KeptWork(run.path / _KEPT), check)
        optimum = optimise_shape(scene, goal, settings, work, start)
        judge = optimum.judge_seconds
        seconds = {"search": time.perf_counter() - began - judge, "judge": judge}
        bound = (
            work.once("bound", lambda: bound_for_goal(scene, goal, settings.cell_mm, info).as_json())
            if plan(scene, goal=goal)["bound"].state == "on"
            else None
        )
        seconds["bound"] = time.perf_counter() - began - sum(seconds.values())
        info("writing the solid and the drawing")
        files = _write(run, scene, optimum)
        seconds["total"] = time.perf_counter() - began
        layout, values = with_free(start.layout, start.values, scene, free_dimensions(scene), start.sizes)
        begin = dict(zip(layout.names, map(float, values), strict=True))
        found = assemble_result(scene, optimum, begin, seconds)
        reached = {"reached_percent": found.goal.reached_percent}
        more = {
            "bound": bound and read_bound({"bound": bound | reached}),
            "assumed": tuple(run.manifest().get("assumed", ())),
            "files": {**files, "report": REPORT},
        }
        found = found.model_copy(update=more)
        write_json(run.path / RESULT_FILES[SHAPE], found.as_json())
        page = shape_page(found, run.manifest(), scene, _bodies(run, scene, optimum))
        write_report(page, run.path / REPORT)
    run.log(f"{found.status}: {found.stop_reason}")
    return ShapedRun(run.path, found)


def _write(run: RunStore, scene: Scene, optimum: ShapeOptimum) -> dict[str, str]:
    """Return scene, exact solids and drawing of the best web; returns their names by kind."""
    shaped = optimum.result.web.scene
    heading = (
        f"Web of {scene.name} with the best dimensions for: {optimum.goal.sense} {optimum.goal.quantity}."
    )
    write_text(run.path / _FILES["design"], toml_text(shaped, heading))
    export_solid(shaped, "half", run.path / _FILES["step"], started=run.started())
    export_solid(shaped, "half", run.path / _FILES["stl"])
    export_drawing(shaped, run.path / _FILES["drawing"])
    return dict(_FILES)


def _bodies(run: RunStore, scene: Scene, optimum: ShapeOptimum) -> tuple[ShownBody, ...]:
    """Return the result and the original, the half throw of each."""
    file = original_file(scene)
    before = surface_of(scene, "half") if file is None else half_throw_surface(file, scene)
    result = optimum.result.web.scene
    shown = (
        ("result", read_stl(run.path / _FILES["stl"]), result),
        ("original web", before, scene),
    )
    return tuple(ShownBody(name, mesh, of.web_z_mm, of.pitch_mm / 2) for name, mesh, of in shown)
