"""The compared quantities of a throw: name, unit, how to print, and which way is better. The only such table.

Tables, plots, pages and verdicts look a quantity up here; what holds values of it, holds them by its key.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from cranktopo.tasks.fea.evaluation import Evaluation

_ErrorKind = Literal["torsion", "bending", "safety"]


@dataclass(frozen=True)
class Quantity:
    """Something that webs are compared by.

    Attributes:
        key: its name among values, percentages and changes, e.g. `torsion_per_mass`.
        unit: as machine names end, e.g. `kNm_per_rad_kg`; empty for a pure number.
        digits: decimals when it is printed.
        better: +1 where more is better, -1 where less is.
        error: which error estimate it carries; None where it is exact.
    """

    key: str
    label: str
    unit: str
    digits: int
    better: Literal[-1, 1]
    error: _ErrorKind | None = None

    @property
    def column(self) -> str:
        """Machine name of its values, unit included."""
        return f"{self.key}_{self.unit}" if self.unit else self.key

    @property
    def percent_column(self) -> str:
        """Machine name of its values in percent of a reference."""
        return f"{self.key}_percent"


MASS = Quantity("mass", "mass of the throw", "kg", 3, -1)
TORSION = Quantity("torsion", "torsional stiffness", "kNm_per_rad", 2, 1, "torsion")
BENDING = Quantity("bending", "bending stiffness", "kN_per_mm", 2, 1, "bending")
TORSION_PER_MASS = Quantity(
    "torsion_per_mass", "torsional stiffness per mass", "kNm_per_rad_kg", 2, 1, "torsion"
)
BENDING_PER_MASS = Quantity("bending_per_mass", "bending stiffness per mass", "kN_per_mm_kg", 2, 1, "bending")
INERTIA = Quantity("inertia", "inertia about the crank axis", "kg_mm2", 0, -1)
UNBALANCE = Quantity("unbalance", "unbalance", "kg_mm", 2, -1)
SAFETY = Quantity("safety", "fatigue safety", "", 3, 1, "safety")

STIFFNESS = (TORSION, BENDING)
PER_MASS = (TORSION_PER_MASS, BENDING_PER_MASS)
COMPARED = (MASS, *STIFFNESS, *PER_MASS, INERTIA, UNBALANCE)
"""What every comparison shows; safety is added where fatigue was assessed."""


def throw_values(mass_kg: float, torsion_Nm_per_rad: float, bending_N_per_mm: float) -> dict[str, float]:
    """Mass, stiffnesses and ratios by key, in the units of the table."""
    torsion, bending = torsion_Nm_per_rad / 1000, bending_N_per_mm / 1000
    return {
        MASS.key: mass_kg,
        TORSION.key: torsion,
        BENDING.key: bending,
        TORSION_PER_MASS.key: torsion / mass_kg,
        BENDING_PER_MASS.key: bending / mass_kg,
    }


def evaluation_values(evaluation: Evaluation) -> dict[str, float]:
    """Return all quantities of an evaluation by key, in the units of the table."""
    return {
        **throw_values(evaluation.throw_kg, evaluation.torsion_Nm_per_rad, evaluation.bending_N_per_mm),
        INERTIA.key: evaluation.inertia_kg_mm2,
        UNBALANCE.key: evaluation.unbalance_kg_mm,
    }


def percent_of(values: Mapping[str, float], reference: Mapping[str, float]) -> dict[str, float]:
    """Values in percent of those of a reference, by key."""
    return {key: 100 * value / reference[key] for key, value in values.items()}
