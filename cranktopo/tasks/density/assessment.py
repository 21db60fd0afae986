"""Stiffness, mass and every quantity of a goal of a body in the optimiser's model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class CaseResult:
    """Stiffness of the full throw under one load case.

    Attributes:
        stiffness: N m/rad for torsion, N/mm for a pin force, None for a body force.
    """

    name: str
    kind: str
    compliance_N_mm: float
    stiffness: float | None
    cg_iterations: int
    relative_residual: float


@dataclass(frozen=True)
class Assessment:
    """Assessment of a body in the optimiser's model.

    Attributes:
        throw_kg: mass between the two mid-main-journal planes, kg.
        quantities: every quantity of a goal or limit by its name, in the unit of `scene.goal.QUANTITIES`.
    """

    cases: tuple[CaseResult, ...]
    throw_kg: float
    web_kg: float
    quantities: Mapping[str, float]

    def stiffness_per_mass(self) -> dict[str, float]:
        """Return the stiffness per mass of the throw, by load case name, in N m/(rad kg) or N/(mm kg)."""
        return {c.name: c.stiffness / self.throw_kg for c in self.cases if c.stiffness is not None}
