"""Accuracy studies: their levels, what `accuracy --json` prints of them, and where they are kept."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, Literal

from pydantic import Field

from cranktopo.base.errors import CranktopoError, quoted
from cranktopo.base.files import read_json, write_json
from cranktopo.base.machine import Machine, private_cache, this_machine
from cranktopo.base.notes import note
from cranktopo.base.result import UNLESS_NONE, Result
from cranktopo.base.seals import sealed, unsealed
from cranktopo.design.assumed import Assumption
from cranktopo.numerics.extrapolation import Extrapolation
from cranktopo.tasks.throw_fea.targets import Target

StudyName = Literal["judge", "fillet stress", "optimiser"]
"""Names of the studies as JSON files hold them."""
EVALUATION: Final = "judge"
FILLET_STRESS: Final = "fillet stress"
OPTIMISER: Final = "optimiser"
TITLES: dict[str, str] = {
    EVALUATION: "body-fitted evaluation",
    FILLET_STRESS: FILLET_STRESS,
    OPTIMISER: OPTIMISER,
}
"""Names of the studies as they are printed."""
TORSION, BENDING, STRESS = "torsion_Nm_per_rad", "bending_N_per_mm", "fillet_stress_MPa"
NAME_OF_CASE = {"torsion": TORSION, "bending": BENDING}
"""Name of the stiffness that a load case of the optimiser gives."""


@dataclass(frozen=True)
class Level:
    """A model of a design, solved once.

    Attributes:
        family: levels that differ only in size and converge to one value have the same family.
        size_mm: element size, element size in the fillet, or cell size.
        seconds: wall time without JAX's compilation.
        values: stiffnesses N m/rad and N/mm, peak stress MPa; always from the body-fitted evaluation.
        band_percent: error bound of `values` themselves that comes from another mesh.
        own_bounds_percent: error bounds of `values` by their own mesh, by the same names.
        model: stiffnesses by the optimiser's own model, where there is one.
    """

    study: StudyName
    name: str
    family: str
    settings: dict[str, Any]
    size_mm: float
    unknowns: int
    seconds: float
    peak_memory_MiB: float
    values: dict[str, float]
    band_percent: float = 0.0
    compile_seconds: float = 0.0
    model: dict[str, float] = field(default_factory=dict)
    own_bounds_percent: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class PlannedLevel:
    """A level that is still to be solved; `cost` is relative to the other levels of its study."""

    name: str
    cost: float
    solve: Callable[[], Level]


SCHEMA_VERSION = 3


@dataclass(frozen=True)
class StoredStudy:
    """Study of a design as `accuracy --json` printed it; `slowdown`: of the machine since then."""

    design: str
    slowdown: float
    result: StudyResult

    def levels(self, study: StudyName) -> list[LevelResult]:
        """Return the levels of a study."""
        return [level for level in self.result.rungs if level.ladder == study]


def studies_path() -> Path | None:
    """Return the file of studies in the user's cache; None where there is no cache of the user's own."""
    folder = private_cache("studies")
    return None if folder is None else folder / "accuracy.json"


def key_of(target: Target) -> str:
    """Return the key of a target's study: a design's name, or the path of the surface of a run or file.

    A surface has no name of its own: every run directory `web` would pass for the design `web`.
    """
    return target.name if target.file is None else str(target.file.resolve())


def store_study(key: str, result: StudyResult) -> Path | None:
    """Keep what `accuracy --json` prints; None where nothing was measured or the cache cannot be written."""
    path = studies_path()
    if path is None or not result.rungs:
        return None
    stored = {name: kept for name, kept in _stored().items() if name != key}  # the newest is the last
    try:
        designs = {name: sealed(kept.as_json(), name) for name, kept in {**stored, key: result}.items()}
        write_json(path, {"schema_version": SCHEMA_VERSION, "designs": designs})
    except CranktopoError:
        return None
    return path


def load_study(key: str, study: StudyName) -> StoredStudy | None:
    """Return what was measured under a key, or else the newest other design, that holds a study.

    None where nothing was measured on a machine of this kind. Surfaces have only the evaluation's study.
    """
    stored = _stored()
    if not stored:
        return None
    here, usable = this_machine(), {}  # timed only when there is something to compare
    for name, result in stored.items():
        machine = result.machine
        if machine.same_kind(here) and any(level.ladder == study for level in result.rungs):
            usable[name] = StoredStudy(name, here.reference_s / machine.reference_s, result)
    return usable.get(key) or (list(usable.values())[-1] if usable else None)


def _stored() -> dict[str, StudyResult]:
    """Studies by key; none where there is no file or one of another version; a line tells of damaged ones."""
    path = studies_path()
    try:
        data = {} if path is None else read_json(path)
        valid = data["schema_version"] == SCHEMA_VERSION
        designs = dict(data["designs"]) if valid else {}
    except (OSError, CranktopoError, KeyError, TypeError, ValueError):
        return {}
    found = {}
    for name, kept in designs.items():
        try:
            found[name] = StudyResult.of_json(unsealed(kept, name), name)
        except (CranktopoError, ValueError):
            note(f"'{path}': the study of {quoted(name)} was changed since it was written, so it is left out")
    return found


class LevelResult(Result):
    """A solved level with its errors."""

    ladder: StudyName
    """The study that it belongs to."""
    name: str
    family: str
    settings: dict[str, Any]
    unknowns: int
    seconds: float
    """Wall time without JAX's compilation."""
    compile_seconds: float
    peak_memory_MiB: float
    torsion_Nm_per_rad: float | None = UNLESS_NONE
    bending_N_per_mm: float | None = UNLESS_NONE
    fillet_stress_MPa: float | None = UNLESS_NONE
    model: dict[str, float]
    """Stiffnesses by the optimiser's own model."""
    errors_percent: dict[str, float]
    model_errors_percent: dict[str, float]
    orders: dict[str, float | None]
    own_bounds_percent: dict[str, float] = Field(default_factory=dict)
    """Error bounds of the evaluation on this mesh; empty where the mesh gives none."""
    error_percent: float | None
    """Largest of all errors, without sign; None where there is no limit."""
    uncertainty_percent: float | None
    efficient: bool

    @property
    def bound_percent(self) -> float | None:
        """Error that the level surely does not exceed: by its own mesh, else by the limit and its band."""
        if self.own_bound_percent is not None:
            return self.own_bound_percent
        if self.error_percent is None or self.uncertainty_percent is None:
            return None
        return self.error_percent + self.uncertainty_percent

    @property
    def own_bound_percent(self) -> float | None:
        """The largest bound by its own mesh."""
        return max(self.own_bounds_percent.values(), default=None)


class Recommendation(Result):
    """The cheapest level of a study for an accuracy; None where the budget reached none."""

    ladder: StudyName
    accuracy_percent: float
    rung: str | None
    seconds: float | None


class StudyResult(Result):
    """JSON of `accuracy`."""

    schema_version: int = 1
    design: str
    budget_s: float
    spent_s: float
    interrupted: bool
    machine: Machine
    limits: dict[StudyName, dict[str, Extrapolation]]
    """Extrapolated values by study and quantity."""
    rungs: list[LevelResult]
    recommendations: list[Recommendation]
    failures: list[str]
    assumed: list[Assumption] | None = UNLESS_NONE
    """None in the studies that are kept for later commands."""
    files: dict[str, str] | None = UNLESS_NONE
    """Printed, not stored."""
