"""Everything that a finished run says about itself, read from its directory."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cranktopo.domain.build import Domain
from cranktopo.effects import planned_scene
from cranktopo.errors import CranktopoError
from cranktopo.evaluate.case_stress import CaseStress
from cranktopo.evaluate.evaluation import Progress
from cranktopo.report.steps import DesignSnapshot, steps
from cranktopo.report.stress_file import read_run_stress, solve_run_stress
from cranktopo.scene import Scene
from cranktopo.scene.of_run import scene_of_run
from cranktopo.store import RunStore, read_json, read_result, require_kind, resume_command
from cranktopo.triangles.surface_files import read_stl
from cranktopo.triangles.surface_mesh import SurfaceMesh

# What other commands print with --json, where the run holds it.
_FATIGUE, _ACCURACY = "fatigue.json", "accuracy.json"


@dataclass(frozen=True)
class RunRecord:
    """A finished run.

    Attributes:
        folder: the run directory, as it was named.
        metrics: content of metrics.json.
        manifest: content of manifest.json.
        history: rows of history.csv.
        scene: the scene as it was simulated.
        mesh: surface of the half throw, or None.
        steps: its intermediate designs, as far as they were kept.
        fatigue: content of fatigue.json, or None.
        accuracy: content of accuracy.json, or None.
        stress: of its load cases on the judge's mesh, or None.
    """

    folder: str
    metrics: dict[str, Any]
    manifest: dict[str, Any]
    history: list[dict[str, Any]]
    scene: Scene
    mesh: SurfaceMesh | None
    steps: tuple[DesignSnapshot, ...]
    fatigue: dict[str, Any] | None
    accuracy: dict[str, Any] | None
    stress: CaseStress | None


def read_record(run: RunStore, domain: Domain | None = None, solve: Progress | None = None) -> RunRecord:
    """Read a finished run.

    Args:
        run: the run directory.
        domain: its cells, where they are at hand; built again otherwise.
        solve: solve for the stresses that the run does not keep yet; called with a line of progress.

    Raises:
        CranktopoError: the run is a loop or has no metrics yet, or a file is damaged.
    """
    require_kind(run, "optimise")
    manifest, metrics = run.manifest(), read_result(run)
    if metrics is None:
        raise CranktopoError(
            f"run '{run.path}': not finished, metrics.json is missing.",
            hint=f"Continue it with: {resume_command(run)}",
        )
    scene = planned_scene(scene_of_run(run))
    surface = metrics.get("files", {}).get("stl")
    return RunRecord(
        folder=str(run.path),
        metrics=metrics,
        manifest=manifest,
        history=run.read_history(),
        scene=scene,
        mesh=read_stl(run.path / surface) if surface else None,
        steps=steps(run, scene, domain),
        fatigue=_optional(run.path / _FATIGUE),
        accuracy=_optional(run.path / _ACCURACY),
        stress=_stress(run, scene, surface, solve),
    )


def _stress(run: RunStore, scene: Scene, surface: str | None, solve: Progress | None) -> CaseStress | None:
    if surface is None:
        return None
    found = read_run_stress(run, surface)
    return solve_run_stress(run, scene, surface, solve) if found is None and solve else found


def _optional(path: Path) -> dict[str, Any] | None:
    return read_json(path) if path.is_file() else None
