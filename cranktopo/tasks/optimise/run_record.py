"""Everything that a finished run says about itself: what its page is a function of."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.base.files import from_json
from cranktopo.base.result import Result
from cranktopo.base.seals import read_arrays, write_arrays
from cranktopo.bodies.cells.domain import Domain, build_domain
from cranktopo.bodies.cells.grid import DensityGrid
from cranktopo.design.schema import Scene
from cranktopo.design.writing import design_from_run
from cranktopo.engine.analysis import LoadAnalysis, analyse
from cranktopo.engine.load_case import LoadCase
from cranktopo.engine.plan.planning import plan, planned_scene
from cranktopo.engine.states import load_cases
from cranktopo.numerics.precision import double_precision
from cranktopo.numerics.surfaces.files import read_stl
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.report.viewer.scene3d import DesignSnapshot
from cranktopo.runs.checkpoint import load_iteration, saved_iterations
from cranktopo.runs.directories import RunStore
from cranktopo.runs.kind import require_kind, result_file
from cranktopo.runs.manifest import Manifest, file_hash
from cranktopo.tasks.density.build import build_chain
from cranktopo.tasks.density.material import MaterialInterpolation
from cranktopo.tasks.extraction.checked_surface import web_fields
from cranktopo.tasks.extraction.stage import stored_design
from cranktopo.tasks.optimise.result import RunMetrics
from cranktopo.tasks.refit.result import RefitResult
from cranktopo.tasks.throw_fatigue.result import FatigueResult
from cranktopo.tasks.throw_fea.studies import StudyResult
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.throw_fea.unit_fields import CaseStress, case_stress

_FILE = "stress.npz"


def solve_run_stress(run: RunStore, scene: Scene, surface: str) -> CaseStress:
    """Solve a run's surface for its load cases on body-fitted elements, and keep the stresses in the run."""
    cases = load_cases(scene, plan(scene).enabled)
    path = run.path / surface
    found = case_stress(Target(run.name, scene, path), cases)
    about = {
        "cases": [case.model_dump(by_alias=False) for case in found.cases],
        "element_size_mm": found.element_size_mm,
        "mirrored": found.mirrored,
        "surface_sha256": file_hash(path),
    }
    arrays = {
        "points_mm": found.points_mm.astype(np.float32),
        "von_mises_MPa": found.von_mises_MPa.astype(np.float32),
        "about": np.array(json.dumps(about)),
    }
    write_arrays(run.path / _FILE, arrays, compressed=True)
    return found


def read_run_stress(run: RunStore, surface: str) -> CaseStress | None:
    """Return the stresses that a run keeps for this surface; None where it has none."""
    path = run.path / _FILE
    if not path.is_file():
        return None
    hint = "Delete it and write the report again."
    stored = read_arrays(path, f"'{path}'", hint)
    try:
        about = from_json(str(stored["about"]))
        points, stress = (stored[name].astype(np.float64) for name in ("points_mm", "von_mises_MPa"))
        cases = tuple(LoadCase(**entry) for entry in about["cases"])
        found = CaseStress(cases, points, stress, bool(about["mirrored"]), float(about["element_size_mm"]))
        fits = stress.shape == (len(cases), len(points)) and points.shape[1:] == (3,)
        sound = fits and np.isfinite(points).all() and np.isfinite(stress).all()
    except (KeyError, ValueError, TypeError, AttributeError):
        sound = False
    if not sound:
        raise CranktopoError(f"'{path}': corrupted, holds no stresses.", hint=hint)
    return found if about.get("surface_sha256") == file_hash(run.path / surface) else None


# What other commands print with --json, where the run holds it.
_FATIGUE, _ACCURACY, _REMODEL = "fatigue.json", "accuracy.json", "remodel/remodel.json"
Added = TypeVar("Added", bound=Result)
_MOST_SNAPSHOTS = 60
MOST_CELLS = 6_000_000
"""Of all snapshots together, one byte each before compression; finer grids are averaged over blocks."""


@dataclass(frozen=True)
class RunRecord:
    """A finished optimise run.

    Attributes:
        scene: as it was simulated.
        loads: of its engine; None without one.
        mesh: surface of the half throw, mm; None where the density has none.
        snapshots: its intermediate designs, as far as they were kept.
        fatigue, accuracy, refit: what those commands left in the run, if they did.
        stress: of its load cases by the body-fitted evaluation, where it was solved.
    """

    folder: str
    metrics: RunMetrics
    manifest: Manifest
    history: Sequence[Mapping[str, Any]]
    scene: Scene
    loads: LoadAnalysis | None
    mesh: SurfaceMesh | None
    snapshots: tuple[DesignSnapshot, ...]
    fatigue: FatigueResult | None
    accuracy: StudyResult | None
    stress: CaseStress | None
    refit: RefitResult | None = None


def read_record(run: RunStore, stresses: bool = False) -> RunRecord:
    """Return the record of a finished run from its directory."""
    require_kind(run, "optimise")
    metrics = RunMetrics.read(result_file(run))
    scene = planned_scene(design_from_run(run))
    surface = metrics.files.get("stl")
    mesh = read_stl(run.unchanged(surface)) if surface else None
    stress = _stress(run, scene, surface, stresses) if surface else None
    return record_of(run, metrics, run.read_history(), scene, mesh, _snapshots(run, scene), stress)


def record_of(
    run: RunStore,
    metrics: RunMetrics,
    history: Sequence[Mapping[str, Any]],
    scene: Scene,
    mesh: SurfaceMesh | None,
    designs: tuple[DesignSnapshot, ...],
    stress: CaseStress | None = None,
) -> RunRecord:
    """Return the record of a run whose results are in memory; what other commands added is read from it."""
    return RunRecord(
        folder=str(run.path),
        metrics=metrics,
        manifest=run.manifest(),
        history=history,
        scene=scene,
        loads=analyse(scene) if scene.engine else None,
        mesh=mesh,
        snapshots=designs,
        fatigue=_added(run, _FATIGUE, FatigueResult),
        accuracy=_added(run, _ACCURACY, StudyResult),
        stress=stress,
        refit=_added(run, _REMODEL, RefitResult),
    )


def _added(run: RunStore, name: str, kind: type[Added]) -> Added | None:
    """Return what another command added to a run; None where it did not; raises CranktopoError."""
    return kind.read(run.unchanged(name)) if (run.path / name).is_file() else None


def _snapshots(run: RunStore, scene: Scene) -> tuple[DesignSnapshot, ...]:
    if scene.envelope is None:
        return ()
    with double_precision():
        domain = build_domain(scene, scene.optimise.resolution_mm)
        return snapshots(run, domain, build_chain(scene, domain))


def _stress(run: RunStore, scene: Scene, surface: str, solved: bool) -> CaseStress | None:
    found = read_run_stress(run, surface)
    return solve_run_stress(run, scene, surface) if found is None and solved else found


def snapshots(
    run: RunStore, domain: Domain, density_chain: MaterialInterpolation
) -> tuple[DesignSnapshot, ...]:
    """Return at most 60 designs of a run in order, the first and the last included; none where it keeps none.

    Call inside `double_precision()`; `density_chain` is the filter chain of the run's own cells.
    """
    numbers = evenly_spread(saved_iterations(run.path), _MOST_SNAPSHOTS)
    found = []
    for number in numbers:
        x, beta = load_iteration(run.path, number)
        grid = web_fields(domain, stored_design(run, density_chain, x, beta))[0]
        found.append(DesignSnapshot(number, coarsened(grid, len(numbers))))
    return tuple(found)


def evenly_spread(numbers: Sequence[int], most: int) -> list[int]:
    """Return at most so many of the numbers, evenly spread, with both ends."""
    if len(numbers) <= most:
        return list(numbers)
    return [numbers[round(i * (len(numbers) - 1) / (most - 1))] for i in range(most)]


def coarsened(grid: DensityGrid, count: int) -> DensityGrid:
    """Return one of `count` grids, averaged over the smallest blocks that keep all within `MOST_CELLS`."""
    size = next(n for n in range(1, 100) if count * grid.density.size <= MOST_CELLS * n**3)
    if size == 1:
        return grid
    return DensityGrid(grid.origin_mm, grid.cell_mm * size, _block_means(grid.density, size))


def _block_means(field: Array, size: int) -> Array:
    """Return means over blocks; the last blocks of an axis are filled up with void."""
    padded = np.pad(field, [(0, -n % size) for n in field.shape])
    blocks = padded.reshape([part for n in padded.shape for part in (n // size, size)])
    return blocks.mean(axis=(1, 3, 5))
