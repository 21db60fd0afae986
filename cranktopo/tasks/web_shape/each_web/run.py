"""The webs of a whole crank as a run: searches in folders of their own, one design, one page."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from cranktopo.base.errors import CranktopoError, ExitCode, invalid
from cranktopo.base.files import write_json
from cranktopo.base.notes import Pace, indented, note
from cranktopo.base.progress import Json, resumable_memory
from cranktopo.design.assumed import assumptions, stored_assumptions
from cranktopo.design.crank_throws import throw_count
from cranktopo.design.free_dimensions import (
    COUNTERWEIGHT_RANGES,
    DIMENSIONS,
    free_range_mm,
    is_of_counterweight,
)
from cranktopo.design.goal.limit import Goal, Limit
from cranktopo.design.goal.outcome import GoalWords
from cranktopo.design.halves import require_equal_halves
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.schema import Scene
from cranktopo.design.shape import FreeDimensions
from cranktopo.design.writing import design_from_run, new_run
from cranktopo.engine.balance.kept import balance_kept
from cranktopo.engine.gas import pressure_curve
from cranktopo.numerics.precision import check_device
from cranktopo.report.page import Page
from cranktopo.report.report_file import REPORT, write_report
from cranktopo.runs.directories import WORK, RunStore, check_destination, open_run
from cranktopo.runs.kind import (
    EACH_WEB,
    RESULT_FILES,
    reading_results,
    require_kind,
    result_file,
    working_in,
)
from cranktopo.tasks.fatigue.taken_keys import assumed_by
from cranktopo.tasks.web_shape.each_web.groups import ALIKE_PERCENT, WebGroup, is_mirrored, web_groups
from cranktopo.tasks.web_shape.each_web.loaded_shaft import LoadedShaft, loaded_shaft
from cranktopo.tasks.web_shape.each_web.page import each_web_page
from cranktopo.tasks.web_shape.each_web.result import EachWebResult
from cranktopo.tasks.web_shape.each_web.rounds import CrankSearch
from cranktopo.tasks.web_shape.loads_told import METHODS, loads_left_off, note_loads
from cranktopo.tasks.web_shape.optimum import ShapeSettings
from cranktopo.tasks.web_shape.run import (
    TABLES,
    kept_settings,
    settings_of,
    shape_goal,
    shape_settings,
)

_ONE, _OWN = "one-web", "own-webs"


@dataclass(frozen=True)
class EachWebRun:
    """A finished run; `result` is the content of each-web.json."""

    folder: Path
    result: EachWebResult


def shape_each_web(
    scene: DesignLike,
    settings: ShapeSettings | None = None,
    out: Path | str | None = None,
    design_toml: str | None = None,
    command: Sequence[str] = (),
) -> EachWebRun:
    """Optimise the dimensions of every distinct web of a shaft in a new run, under its loads in the shaft.

    Args:
        settings: of every search; load states are those of the shaft in any case.
        design_toml, command: as of `shape_design`.

    Raises:
        CranktopoError: bad input, no web that keeps the limits, or interruption (exit code 130).
    """
    scene = balance_kept(_without_free_journals(as_scene(scene)))
    out = check_destination(out)
    check_device()
    _check(scene)
    settings = settings or shape_settings(scene)
    assumed = assumed_by(assumptions(scene, TABLES), METHODS)
    note_loads(scene, None, assumed)
    options: dict[str, Any] = {EACH_WEB: kept_settings(replace(settings, loads="extremes"))}
    run = new_run(scene, assumed, out, design_toml, command, options)
    return _worked(run, scene, settings)


def resume_each_web(reference: str | Path) -> EachWebRun:
    """Continue an interrupted run: finished searches and shafts are read, not repeated.

    Raises:
        CranktopoError: not such a run, a changed input, or as `shape_each_web`.
    """
    run = open_run(reference)
    require_kind(run, EACH_WEB)
    run.require_same_inputs()
    data = run.manifest().options[EACH_WEB]
    with reading_results(run):
        settings = settings_of(data)
    run.resume()
    return _worked(run, design_from_run(run), settings)


def finished_page(run: RunStore) -> Page:
    """Return the page of a finished run from its files; raises CranktopoError."""
    return each_web_page(EachWebResult.read(result_file(run)), run.manifest())


def _check(scene: Scene) -> None:
    """Check that the webs are alike to begin with, and that something asks for them to differ."""
    if scene.crank is not None and not scene.crank.uniform:
        raise scene.invalid(
            "crank.throws", "with --each-web all begin with one web", "Give a design whose throws are alike."
        )
    if scene.original is not None:
        raise scene.invalid(
            "original.file", "the body of a web says nothing of its place", "Take [original] out."
        )
    if scene.supports.bending == "clamped":
        raise scene.invalid(
            "supports.bending", "the sections of a shaft tilt in their bearings", "Set it to 'pinned'."
        )
    if scene.engine is not None and scene.engine.arranged.cylinder_pitch_mm is not None:
        raise scene.invalid(
            "engine.arrangement.cylinder_pitch_mm",
            "different throws give the distances of the cylinders themselves",
            "Leave it out.",
        )
    if scene.engine is None or pressure_curve(scene) is None:
        raise invalid(
            "engine.gas", None, "the loads of a shaft over the cycle need it", "Add an [engine.gas] table."
        )
    most = 2 * throw_count(scene)
    if any(web > most for group in scene.shape.same_webs for web in group):
        raise scene.invalid("shape.same_webs", f"the crank has webs 1 to {most}", "Correct the numbers.")
    require_equal_halves(scene)
    _safety_limit(scene, shape_goal(scene))


def _safety_limit(scene: Scene, goal: Goal) -> Limit:
    """Return the least safety, which alone sees the loads; raises CranktopoError where there is none."""
    if "stress" in goal.quantities or goal.quantity == "fatigue_safety":
        raise CranktopoError(
            f"{scene.name}: --each-web keeps a least fatigue safety; goals and limits of stress or the most "
            "safety are of one web.",
            hint="Take --minimise mass or --maximise torsion_per_mass, with --limit 'fatigue_safety >= ...'.",
            code=ExitCode.USAGE,
        )
    found = goal.limits_of("fatigue_safety")
    if len(found) != 1 or found[0].sense != ">=":
        raise CranktopoError(
            f"{scene.name}: without a least fatigue safety all webs of a shaft are the same to every limit.",
            hint="Give --limit 'fatigue_safety >= 100 %' or a number, or leave --each-web out.",
            code=ExitCode.USAGE,
        )
    return found[0]


def _without_free_journals(scene: Scene) -> Scene:
    """Return the scene without the free dimensions that two webs have in common."""
    free = [name for name in DIMENSIONS if free_range_mm(scene, name) and not is_of_counterweight(name)]
    if not free:
        return scene
    note(f"{scene.name}: {', '.join(free)} not free here: webs of their own share their journals")
    free_web = scene.shape.free.model_dump(include=COUNTERWEIGHT_RANGES)
    shape = scene.shape.model_copy(update={"free": FreeDimensions(**free_web)})
    return scene.model_copy(update={"shape": shape})


def _worked(run: RunStore, scene: Scene, settings: ShapeSettings) -> EachWebRun:
    began = time.perf_counter()
    with working_in(run, "finished searches are kept") as check:
        work, goal = resumable_memory(run.path / WORK, check), shape_goal(scene)
        limit = _safety_limit(scene, goal)
        original = LoadedShaft.of_json(work.once("design", lambda: _design_shaft(scene, settings)))
        required = limit.required(original.figures.safety)
        assert required is not None
        groups = web_groups(scene.shaft_angles_deg, original.figures.safeties, scene.shape.same_webs)
        _tell(scene, original, groups)
        pace = Pace(f"{scene.name}, each web", len(groups) + 3, quiet_s=0.0)
        search = CrankSearch(run.path, _without_bound(scene), settings, work, original, required, pace)
        every = WebGroup(tuple(range(1, 2 * throw_count(scene) + 1)))
        alike = search.variant(_ONE, (every,))
        decides, one = alike.safety_decides, alike.variant
        own = search.variant(_OWN, groups, alike).variant if decides else one
        found = EachWebResult(
            design=scene.name,
            goal=GoalWords.model_validate({goal.sense: goal.quantity}),
            limits={one.quantity: one.condition for one in goal.limits if one is not limit},
            required_safety=required,
            alike_percent=ALIKE_PERCENT,
            same_webs=tuple(tuple(sorted(webs)) for webs in scene.shape.same_webs),
            mirrored=is_mirrored(scene.shaft_angles_deg),
            original=original.figures,
            one_web=one,
            each_web=own,
            safety_decides=decides,
            saved_percent=100 * (1 - own.shaft.mass_kg / one.shaft.mass_kg),
            seconds=time.perf_counter() - began,
            left_off=loads_left_off(scene, None) or None,
            assumed=stored_assumptions(run.manifest().assumed),
            files={"design": own.design, "one_web": one.design, "report": REPORT},
        )
        write_json(run.path / RESULT_FILES[EACH_WEB], found.as_json())
        write_report(each_web_page(found, run.manifest()), run.path / REPORT)
    run.log("limits kept" if found.held else "limits missed")
    return EachWebRun(run.path, found)


def _design_shaft(scene: Scene, settings: ShapeSettings) -> Json:
    note(f"{scene.name}: the shaft with the design's web")
    with indented():
        return loaded_shaft(scene, settings.fillet_fraction).as_json()


def _without_bound(scene: Scene) -> Scene:
    """Return the scene without the proof of a bound: it knows no safety, so it is the same for all webs."""
    return scene.with_effect("bound", "off")


def _tell(scene: Scene, original: LoadedShaft, groups: Sequence[WebGroup]) -> None:
    safeties = original.figures.safeties
    least_safeties = "; ".join(f"{group.words} at least {group.least(safeties):.3f}" for group in groups)
    note(f"{scene.name}: safety in the shaft on all its bearings: {least_safeties}")
    if len(groups) == 1:
        raise CranktopoError(
            f"{scene.name}: all webs are to be equal: their least safeties in the shaft differ by less than "
            f"{ALIKE_PERCENT:g} %, or shape.same_webs names them together.",
            hint="Leave --each-web out.",
        )
