"""One level of an accuracy study: a model, what it cost, and what it gave."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Final, Literal

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
        name: printed, unique within its study.
        family: levels that differ only in size and converge to one value have the same family.
        size_mm: element size, element size in the fillet, or cell size.
        unknowns: degrees of freedom.
        seconds: wall time without JAX's compilation.
        values: stiffnesses N m/rad and N/mm, peak stress MPa; always from the body-fitted evaluation.
        band_percent: error bound of `values` themselves, where the evaluation gives one.
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


@dataclass(frozen=True)
class PlannedLevel:
    """A level that is still to be solved; `cost` is relative to the other levels of its study."""

    name: str
    cost: float
    solve: Callable[[], Level]
