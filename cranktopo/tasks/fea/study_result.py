"""accuracy.json: what the levels of an accuracy study cost and what they gave."""

from __future__ import annotations

from typing import Any

from cranktopo.base.machine import Machine
from cranktopo.base.result import UNLESS_NONE, Result
from cranktopo.design.assumed import Assumption
from cranktopo.numerics.extrapolation import Extrapolation
from cranktopo.tasks.fea.level import StudyName


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
    error_percent: float | None
    """Largest of all errors, without sign; None where there is no limit."""
    uncertainty_percent: float | None
    efficient: bool


class Recommendation(Result):
    """The cheapest level of a study for an accuracy; None where the budget reached none."""

    ladder: StudyName
    accuracy_percent: float
    rung: str | None
    seconds: float | None


class StudyResult(Result):
    """What `accuracy --json` prints."""

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
