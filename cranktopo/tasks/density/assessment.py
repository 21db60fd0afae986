"""Stiffness, mass and every quantity of a goal of a body in the optimiser's model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from cranktopo.design.schema import Scene

_FACTOR_PERCENT = {"torsion": 60.0, "bending": 90.0}
_ORDER = {"torsion": 1.5, "bending": 1.1}
_HELD = 2.0
"""A journal that may not tilt bends the web: its torsional stiffness has about twice the error."""
_FEATURED = 1.15
"""With a counterweight or an oil drilling four to six cells through the web miss the torsional stiffness by
up to a tenth more."""


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


def model_error_percent(scene: Scene, cell_mm: float) -> dict[str, float]:
    """Return the bound of the error of the stiffnesses of a throw without fillets, %, by kind of load case.

    A power of the cell over the thickness of the web, fitted from above to the errors of `python -m
    tests.benchmarks.voxel_accuracy --throws` on webs of 14 to 37 mm, and `--features` with counterweights and
    drillings. That of bending is the order at a sharp re-entrant ring, 1.09 (Williams, 1952); torsion is less
    sensitive to the rings.
    """
    share = cell_mm / scene.web.thickness_mm
    found = {kind: factor * share ** _ORDER[kind] for kind, factor in _FACTOR_PERCENT.items()}
    if scene.supports.torsion == "held":
        found["torsion"] *= _HELD
    if scene.web.counterweight is not None or scene.throw.drilling:
        found["torsion"] *= _FEATURED
    return found
