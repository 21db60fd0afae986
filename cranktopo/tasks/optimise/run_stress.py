"""Stresses that a run keeps for its report: stress.npz, tied to the surface that they were solved on."""

from __future__ import annotations

import json

import numpy as np

from cranktopo.base.errors import CranktopoError
from cranktopo.base.files import write_npz
from cranktopo.design.schema import Scene
from cranktopo.engine.cases import load_cases
from cranktopo.engine.load_case import LoadCase
from cranktopo.engine.plan.planning import plan
from cranktopo.runs.directories import RunStore
from cranktopo.runs.manifest import file_hash
from cranktopo.tasks.fea.evaluation import Info
from cranktopo.tasks.fea.targets import Target
from cranktopo.tasks.fea.unit_fields import CaseStress, case_stress

_FILE = "stress.npz"


def solve_run_stress(run: RunStore, scene: Scene, surface: str, progress: Info) -> CaseStress:
    """Solve a run's surface for its load cases on body-fitted elements, and keep the stresses in the run.

    Raises:
        CranktopoError: no valid mesh, a failed solve, or the file cannot be written.
    """
    cases = load_cases(scene, plan(scene).enabled)
    path = run.path / surface
    found = case_stress(Target(run.name, scene, path), cases, progress=progress)
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
    write_npz(run.path / _FILE, arrays, compressed=True)
    return found


def read_run_stress(run: RunStore, surface: str) -> CaseStress | None:
    """Return the stresses that a run keeps for its surface; None where it has none, or none of this surface.

    Raises:
        CranktopoError: the file is damaged.
    """
    path = run.path / _FILE
    if not path.is_file():
        return None
    try:
        with np.load(path, allow_pickle=False) as file:
            about = json.loads(str(file["about"]))
            points, stress = (file[name].astype(np.float64) for name in ("points_mm", "von_mises_MPa"))
            cases = tuple(LoadCase(**entry) for entry in about["cases"])
    except Exception as error:  # zipfile, numpy and json raise a dozen types on damaged bytes
        raise CranktopoError(
            f"'{path}': corrupted, cannot be read ({error}).", hint="Delete it and write the report again."
        ) from None
    if about["surface_sha256"] != file_hash(run.path / surface):
        return None
    return CaseStress(cases, points, stress, about["mirrored"], about["element_size_mm"])
