"""One rung of a ladder: a model, what it cost, and what it found."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

StudyName = Literal["judge", "fillet stress", "optimiser"]
TORSION, BENDING, STRESS = "torsion_Nm_per_rad", "bending_N_per_mm", "fillet_stress_MPa"
NAME_OF_CASE = {"torsion": TORSION, "bending": BENDING}
"""Name of the stiffness that a load case of the optimiser gives."""


@dataclass(frozen=True)
class Level:
    """A model of a design, solved once.

    Attributes:
        ladder: which ladder it stands on.
        name: shown, unique on its ladder.
        family: rungs that differ in nothing but their size, and converge to one value.
        settings: what makes it this rung.
        size_mm: element size, element size in the fillet, or cell size.
        unknowns: degrees of freedom.
        seconds: wall time, JAX's compilation not counted.
        peak_memory_MiB: largest resident memory.
        values: stiffnesses N m/rad and N/mm, peak stress MPa; of the judge in every ladder.
        band_percent: bound of the judge's error of the values, where they are taken as they are.
        compile_seconds: JAX's compilation, which the next process finds stored.
        model: stiffnesses by the optimiser's own model, where it has one.
        spent_seconds: wall time of everything, the judging of the result included.
    """

    ladder: StudyName
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
    spent_seconds: float = 0.0
