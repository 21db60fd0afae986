"""The re-model of a run: fitted web, its files, its shape error to the extracted body, its stiffness."""

from __future__ import annotations

import time
from collections.abc import Mapping
from datetime import datetime
from pathlib import Path

from cranktopo.base.companion import Companion
from cranktopo.base.errors import CranktopoError
from cranktopo.base.files import as_path_if_any, write_json, write_text
from cranktopo.base.notes import note
from cranktopo.bodies.prisms import thread_holes, with_bolted
from cranktopo.bodies.seat import warn_of_cut_seat
from cranktopo.bodies.solid.files import export_solid, surface_of
from cranktopo.design.schema import Scene
from cranktopo.design.writing import design_from_run, toml_text
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.plan.simulated import strip_features
from cranktopo.numerics.surfaces.files import as_stored, write_stl
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, solid_of
from cranktopo.report.report_file import write_report
from cranktopo.report.viewer.scene3d import ShownBody
from cranktopo.runs.destination import moved, unfinished_folder
from cranktopo.runs.directories import check_destination, open_run
from cranktopo.runs.kind import interruptible
from cranktopo.runs.manifest import timestamp, versions
from cranktopo.runs.stored import record_folder
from cranktopo.tasks.drawing.sheet import write_drawing
from cranktopo.tasks.drawing.views import Sheet
from cranktopo.tasks.extraction.release import shaped_undercuts
from cranktopo.tasks.extraction.result import ShapedUndercuts
from cranktopo.tasks.importing.imported_body import read_half_throw
from cranktopo.tasks.refit.family import parameter_unit
from cranktopo.tasks.refit.fit import FIT_LIBRARIES, FittedWeb, fit_web, usual_limits
from cranktopo.tasks.refit.masses import throw_masses, web_masses
from cranktopo.tasks.refit.page import refit_page
from cranktopo.tasks.refit.process import fit_limits
from cranktopo.tasks.refit.result import (
    FittedParameter,
    Overlaps,
    RefitFiles,
    RefitResult,
    RefitStiffness,
    RefitThrows,
    SurfaceDistance,
    UnrepresentedRegion,
    WebMasses,
)
from cranktopo.tasks.refit.shape_error import ShapeError, shape_error
from cranktopo.tasks.throw_fea.evaluation import evaluate
from cranktopo.tasks.throw_fea.targets import Target, resolve_target
from cranktopo.throw.manufacturing_limits import ProcessLimits


def remodel_run(
    reference: str | Path,
    out: Path | str | None = None,
    given: Mapping[str, float | None] | None = None,
    evaluated: bool = True,
) -> RefitResult:
    """Re-model the web of a finished run and write every file.

    Args:
        given: manufacturing limits by the names of `ManufacturingLimits`; the others suit the throw's size.
        out: folder to write to, by default `remodel` in the run; it must not hold files.
        evaluated: whether stiffnesses are compared, which takes three evaluations.

    Raises:
        CranktopoError: not a finished run, a surface that is not sound, or no web within the limits.
    """
    out = as_path_if_any(out)
    began = time.perf_counter()
    run = open_run(reference)
    target = resolve_target(str(run.path))
    folder = out or run.path / "remodel"
    check_destination(folder)
    scene = design_from_run(run)
    limits = fit_limits(scene, usual_limits(scene, **(given or {})))
    surface = _surface(target, scene)
    note(f"{run.name}: fitting a parametric web")
    with Companion(FIT_LIBRARIES) as beside:
        fitted = fit_web(surface, scene, limits, beside)
    near = shape_error(strip_features(fitted.scene, "fillets"), surface)
    with interruptible() as check, unfinished_folder(folder.parent) as unfinished:
        half_throw = as_stored(surface_of(fitted.scene, "half"))
        files = write_refit(fitted, near, half_throw, surface, unfinished, run.started())
        check()
        stiffness = _evaluated(target, fitted.scene) if evaluated else None
        undercuts = shaped_undercuts(half_throw, fitted.scene)
        total_s = time.perf_counter() - began
        weighed = web_masses(scene, fitted.scene, near), throw_masses(scene, fitted.scene, surface)
        result = _result(run.name, fitted, near, weighed, limits, undercuts, stiffness, files, total_s)
        write_json(unfinished / files.result, result.as_json())
        _write_page(result, fitted.scene, half_throw, surface, unfinished)
        check()
        record_folder(unfinished, folder)
        moved(unfinished, folder)
    return result.model_copy(update={"folder": str(folder)})


def write_refit(
    fitted: FittedWeb,
    near: ShapeError,
    half_throw: SurfaceMesh,
    surface: SurfaceMesh,
    folder: Path,
    started: datetime | None = None,
) -> RefitFiles:
    """Write the scene, STEP and STL of the half throw and the drawing of a fitted web.

    The surface that it was fitted to is drawn as dashed lines; `folder` exists. STEP and drawing are dated
    `started`, now by default. Returns the names of the files.

    Raises:
        CranktopoError: the CAD kernel cannot build the solid, or a file cannot be written.
    """
    scene = fitted.scene
    files = RefitFiles(design=f"{scene.name}.toml")
    note(f"{scene.name}: writing the solid and the drawing")
    warn_of_cut_seat(scene)
    heading = f"Web fitted to the optimised body of {scene.name}; overlap {100 * near.web_iou:.1f} %."
    write_text(folder / files.design, toml_text(scene, heading))
    export_solid(scene, "half", folder / files.step, started=started)
    write_stl(folder / files.stl, half_throw)
    drawings = [folder / files.drawing, folder / files.drawing_svg]
    solid = solid_of(half_throw, "half throw") - thread_holes(scene)
    sheet = Sheet(scene, solid, solid_of(surface, "surface to be re-modelled"))
    write_drawing([sheet], throw_balance(scene), drawings, started)
    return files


def _write_page(
    result: RefitResult, scene: Scene, half_throw: SurfaceMesh, surface: SurfaceMesh, folder: Path
) -> None:
    bodies = tuple(
        ShownBody(name, mesh, scene.web_z_mm, scene.pitch_mm / 2)
        for name, mesh in (("re-modelled", with_bolted(half_throw, scene)), ("body of the run", surface))
    )
    page = refit_page(result, bodies, versions(), timestamp()[:10])
    write_report(page, folder / result.files.report)


def _surface(target: Target, scene: Scene) -> SurfaceMesh:
    if target.file is None:
        raise CranktopoError(f"target '{target.name}': has no surface.", hint="Give a finished run.")
    return read_half_throw(target.file, scene)


def _evaluated(target: Target, scene: Scene) -> RefitStiffness:
    """Evaluate the body, which has no fillets, the web without its own for a like comparison, and the web."""
    bare = Target(f"{scene.name}, no fillets", strip_features(scene, "fillets"))
    body, sharp, whole = (evaluate(what, None) for what in (target, bare, Target(scene.name, scene)))
    torsion = sharp.torsion_Nm_per_rad / body.torsion_Nm_per_rad
    return RefitStiffness(
        body=body.result,
        fitted_without_fillets=sharp.result,
        fitted=whole.result,
        difference_percent={
            "torsion": 100 * (torsion - 1),
            "bending": 100 * (sharp.bending_N_per_mm / body.bending_N_per_mm - 1),
            "torsion_per_mass": 100 * (torsion / sharp.throw_kg * body.throw_kg - 1),
        },
    )


def _result(
    run: str,
    fitted: FittedWeb,
    near: ShapeError,
    weighed: tuple[WebMasses, RefitThrows],
    limits: ProcessLimits,
    undercuts: ShapedUndercuts,
    stiffness: RefitStiffness | None,
    files: RefitFiles,
    total_s: float,
) -> RefitResult:
    scene, body_mm3 = fitted.scene, near.body_web_volume_mm3
    return RefitResult(
        run=run,
        design=scene.name,
        web=scene.web.model_dump(mode="json"),
        parameters=[
            FittedParameter(name=name, value=value, unit=parameter_unit(name))
            for name, value in zip(fitted.names, fitted.values, strict=True)
        ],
        iou=Overlaps(web=near.web_iou, half_throw=near.iou),
        distance_mm=SurfaceDistance(
            mean=near.mean_distance_mm, max=near.max_distance_mm, max_at=list(near.farthest_mm)
        ),
        web_mass_kg=weighed[0],
        throws=weighed[1],
        stiffness=stiffness,
        trials=list(fitted.trials),
        overlap_by_start=list(fitted.overlaps),
        not_represented=[UnrepresentedRegion.of(region, body_mm3) for region in fitted.residual_regions],
        rules=limits,
        undercuts=undercuts,
        files=files,
        seconds={"total": total_s},
    )
