"""The record of a finished run, from memory or read from its directory, and its page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from cranktopo.base.errors import CranktopoError
from cranktopo.base.files import read_json
from cranktopo.bodies.cells.domain import build_domain
from cranktopo.design.of_run import design_from_run
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import analyse
from cranktopo.engine.plan.planning import planned_scene
from cranktopo.numerics.precision import double_precision
from cranktopo.numerics.surfaces.files import read_stl
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.report.report_file import REPORT, write_report
from cranktopo.report.viewer.scene3d import DesignSnapshot
from cranktopo.runs.directories import RunStore, open_run
from cranktopo.runs.kind import read_result, require_kind, resume_command, shown_results
from cranktopo.tasks.density.chain import build_chain
from cranktopo.tasks.extraction.snapshots import snapshots
from cranktopo.tasks.fea.case_stress import CaseStress
from cranktopo.tasks.fea.evaluation import Info
from cranktopo.tasks.optimise.page import run_page
from cranktopo.tasks.optimise.record import RunRecord
from cranktopo.tasks.optimise.run_stress import read_run_stress, solve_run_stress

# What other commands print with --json, where the run holds it.
_FATIGUE, _ACCURACY, _REMODEL = "fatigue.json", "accuracy.json", "remodel/remodel.json"


def report_run(run: RunStore | str, path: Path | None = None, stress_progress: Info | None = None) -> Path:
    """Write the report of a finished run and return its file.

    Args:
        run: the run directory, or how the user names it.
        path: .html or .md; report.html in the run by default.
        stress_progress: where given, stresses that the run does not keep yet are solved.

    Raises:
        CranktopoError: the run is not finished, a file of it is damaged, or the report cannot be written.
    """
    store = open_run(run) if isinstance(run, str) else run
    target = path or store.path / REPORT
    with shown_results(store):
        page = run_page(read_record(store, stress_progress))
    write_report(page, target)
    return target


def read_record(run: RunStore, stress_progress: Info | None = None) -> RunRecord:
    """The record of a finished run from its directory.

    Raises:
        CranktopoError: a loop, a run without metrics, or a damaged file.
    """
    require_kind(run, "optimise")
    metrics = read_result(run)
    if metrics is None:
        raise CranktopoError(
            f"run '{run.path}': not finished, metrics.json is missing.",
            hint=f"Continue it with: {resume_command(run)}",
        )
    scene = planned_scene(design_from_run(run))
    surface = metrics.get("files", {}).get("stl")
    mesh = read_stl(run.path / surface) if surface else None
    stress = _stress(run, scene, surface, stress_progress) if surface else None
    return record_of(run, metrics, run.read_history(), scene, mesh, _snapshots(run, scene), stress)


def record_of(
    run: RunStore,
    metrics: Mapping[str, Any],
    history: Sequence[Mapping[str, Any]],
    scene: Scene,
    mesh: SurfaceMesh | None,
    designs: tuple[DesignSnapshot, ...],
    stress: CaseStress | None = None,
) -> RunRecord:
    """The record of a run whose results are in memory; what other commands added is read from it."""
    return RunRecord(
        folder=str(run.path),
        metrics=metrics,
        manifest=run.manifest(),
        history=history,
        scene=scene,
        loads=analyse(scene) if scene.engine else None,
        mesh=mesh,
        snapshots=designs,
        fatigue=_optional(run.path / _FATIGUE),
        accuracy=_optional(run.path / _ACCURACY),
        stress=stress,
        remodel=_optional(run.path / _REMODEL),
    )


def _snapshots(run: RunStore, scene: Scene) -> tuple[DesignSnapshot, ...]:
    if scene.envelope is None:
        return ()
    with double_precision():
        domain = build_domain(scene, scene.optimise.resolution_mm)
        return snapshots(run, domain, build_chain(scene, domain))


def _stress(run: RunStore, scene: Scene, surface: str, progress: Info | None) -> CaseStress | None:
    found = read_run_stress(run, surface)
    return solve_run_stress(run, scene, surface, progress) if found is None and progress else found


def _optional(path: Path) -> dict[str, Any] | None:
    return read_json(path) if path.is_file() else None
