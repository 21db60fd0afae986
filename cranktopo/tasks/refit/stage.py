"""The re-model of a run: fitted web, its files, its shape error to the extracted body, its stiffness."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

from cranktopo.base.errors import CranktopoError
from cranktopo.base.files import write_json, write_text
from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.solid.files import export_solid
from cranktopo.design.manufacturing_limits import ManufacturingLimits
from cranktopo.design.of_run import design_from_run
from cranktopo.design.schema import Scene
from cranktopo.design.writing import toml_text
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.plan.simulated import without
from cranktopo.numerics.surfaces.files import read_stl
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, solid_of
from cranktopo.report.report_file import REPORT, write_report
from cranktopo.report.viewer.scene3d import ShownBody
from cranktopo.runs.directories import check_destination, open_run
from cranktopo.runs.folders import moved, unfinished_folder
from cranktopo.runs.interruption import interruptible
from cranktopo.runs.manifest import timestamp, versions
from cranktopo.tasks.drawing.sheet import write_drawing
from cranktopo.tasks.drawing.views import Sheet
from cranktopo.tasks.fea.evaluation import Evaluation, Info, evaluate
from cranktopo.tasks.fea.targets import Target, resolve_target
from cranktopo.tasks.importing.imported_body import read_half_throw
from cranktopo.tasks.refit.family import unit_of
from cranktopo.tasks.refit.fit import FittedWeb, fit_web
from cranktopo.tasks.refit.page import remodel_page
from cranktopo.tasks.refit.shape_error import ShapeError, shape_error
from cranktopo.tasks.refit.usual_size import usual_limits

SCHEMA_VERSION = 1


@dataclass(frozen=True)
class RemodelEvaluations:
    """Evaluations of the extracted body (which has no fillets), of the fitted web without its fillets, for a
    like comparison, and of the fitted web as it is.
    """

    body: Evaluation
    sharp: Evaluation
    fitted: Evaluation


def remodel_run(
    reference: str,
    out: Path | None = None,
    given: Mapping[str, float | None] | None = None,
    evaluated: bool = True,
    info: Info = lambda _: None,
) -> dict[str, Any]:
    """Re-model the web of a finished run and write every file; returns what is in remodel.json.

    Args:
        given: manufacturing limits by the names of `ManufacturingLimits`; the others suit the throw's size.
        out: folder to write to, by default `remodel` in the run; it must not hold files.
        evaluated: whether stiffnesses are compared, which takes three evaluations.

    Raises:
        CranktopoError: not a finished run, a surface that is not sound, or no web within the limits.
    """
    began = time.perf_counter()
    run = open_run(reference)
    target = resolve_target(str(run.path))
    folder = out or run.path / "remodel"
    check_destination(folder)
    scene = design_from_run(run)
    limits = usual_limits(scene, **(given or {}))
    surface = _surface(target, scene)
    info(f"{run.name}: fitting a parametric web")
    fitted = fit_web(surface, scene, limits)
    near = shape_error(without(fitted.scene, "fillets"), surface)
    with interruptible() as check, unfinished_folder(folder.parent) as unfinished:
        files = write_remodel(fitted, near, surface, unfinished, info, run.started())
        check()
        stiffness = _evaluated(target, fitted.scene, info) if evaluated else None
        data = _as_json(run.name, fitted, near, limits, stiffness, files)
        data["seconds"] = {"total": time.perf_counter() - began}
        write_json(unfinished / files["json"], data)
        _write_page(data, fitted.scene, surface, unfinished)
        check()
        moved(unfinished, folder)
    return {**data, "folder": str(folder)}


def write_remodel(
    fitted: FittedWeb,
    near: ShapeError,
    surface: SurfaceMesh,
    folder: Path,
    info: Info,
    started: datetime | None = None,
) -> dict[str, str]:
    """Write the scene, STEP and STL of the half throw and the drawing of a fitted web.

    The body is drawn as dashed lines; `folder` exists. STEP and drawing are dated `started`, now by default.
    Returns the names of the files by kind.

    Raises:
        CranktopoError: the CAD kernel cannot build the solid, or a file cannot be written.
    """
    scene = fitted.scene
    files = {"design": f"{scene.name}.toml", "step": "half_throw.step", "stl": "half_throw.stl"}
    files |= {
        "drawing": "drawing.png",
        "drawing_svg": "drawing.svg",
        "json": "remodel.json",
        "report": REPORT,
    }
    info(f"{scene.name}: writing the solid and the drawing")
    heading = f"Web fitted to the optimised body of {scene.name}; overlap {100 * near.web_iou:.1f} %."
    write_text(folder / files["design"], toml_text(scene, heading))
    export_solid(scene, "half", folder / files["step"], started=started)
    export_solid(scene, "half", folder / files["stl"])
    drawings = [folder / files["drawing"], folder / files["drawing_svg"]]
    half_throw = solid_of(read_stl(folder / files["stl"]), "half throw")
    sheet = Sheet(scene, half_throw, solid_of(surface, "surface to be re-modelled"))
    write_drawing([sheet], throw_balance(scene), drawings, started)
    return files


def _write_page(data: dict[str, Any], scene: Scene, surface: SurfaceMesh, folder: Path) -> None:
    """The report: the web and the body that it was fitted to, and all that was measured."""
    fitted = read_stl(folder / data["files"]["stl"])
    bodies = tuple(
        ShownBody(name, mesh, scene.web_z_mm, scene.pitch_mm / 2)
        for name, mesh in (("re-modelled", fitted), ("body of the run", surface))
    )
    page = remodel_page(data, bodies, versions(), timestamp()[:10])
    write_report(page, folder / data["files"]["report"])


def _surface(target: Target, scene: Scene) -> SurfaceMesh:
    if target.file is None:
        raise CranktopoError(f"target '{target.name}': has no surface.", hint="Give a finished run.")
    return read_half_throw(target.file, scene)


def _evaluated(target: Target, scene: Scene, info: Info) -> RemodelEvaluations:
    sharp = Target(f"{scene.name}, no fillets", without(scene, "fillets"))
    body, bare, whole = (evaluate(what, None, info) for what in (target, sharp, Target(scene.name, scene)))
    return RemodelEvaluations(body, bare, whole)


def _as_json(
    run: str,
    fitted: FittedWeb,
    near: ShapeError,
    limits: ManufacturingLimits,
    stiffness: RemodelEvaluations | None,
    files: dict[str, str],
) -> dict[str, Any]:
    scene = fitted.scene
    density = density_kg_per_mm3(scene.material.density_kg_m3)
    units = {name: unit_of(name) for name in fitted.names}
    return {
        "schema_version": SCHEMA_VERSION,
        "run": run,
        "design": scene.name,
        "web": scene.web.model_dump(mode="json"),
        "parameters": [
            {"name": name, "value": value, "unit": units[name]}
            for name, value in zip(fitted.names, fitted.values, strict=True)
        ],
        "iou": {"web": near.web_iou, "half_throw": near.iou},
        "distance_mm": {
            "mean": near.mean_distance_mm,
            "max": near.max_distance_mm,
            "max_at": list(near.farthest_mm),
        },
        "web_mass_kg": {
            "fitted": density * near.web_volume_mm3,
            "body": density * near.body_web_volume_mm3,
            "difference_percent": 100 * (near.web_volume_mm3 / near.body_web_volume_mm3 - 1),
        },
        "stiffness": None if stiffness is None else _stiffness_json(stiffness),
        "trials": [asdict(trial) for trial in fitted.trials],
        "overlap_by_start": list(fitted.overlaps),
        "not_represented": [
            {**asdict(region), "share_percent": 100 * region.volume_mm3 / near.body_web_volume_mm3}
            for region in fitted.residual_regions
        ],
        "rules": asdict(limits),
        "files": files,
    }


def _stiffness_json(found: RemodelEvaluations) -> dict[str, Any]:
    """Evaluations, and the difference of the fitted web without fillets from the body, %."""
    body, sharp = found.body, found.sharp
    return {
        "body": body.as_json(),
        "fitted_without_fillets": sharp.as_json(),
        "fitted": found.fitted.as_json(),
        "difference_percent": {
            "torsion": 100 * (sharp.torsion_Nm_per_rad / body.torsion_Nm_per_rad - 1),
            "bending": 100 * (sharp.bending_N_per_mm / body.bending_N_per_mm - 1),
            "torsion_per_mass": 100
            * (sharp.torsion_Nm_per_rad / sharp.throw_kg / body.torsion_Nm_per_rad * body.throw_kg - 1),
        },
    }
