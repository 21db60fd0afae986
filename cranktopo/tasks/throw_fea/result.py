"""One entry of `evaluate --json`: mass, stiffness for every support, mesh, and bounds of the errors."""

from __future__ import annotations

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.result import UNLESS_NONE, Result
from cranktopo.design.assumed import Assumption
from cranktopo.engine.histories import LoadsName


class EvaluatedMass(Result):
    """Masses, kg."""

    throw: float
    web: float
    """Of one web between its faces."""
    second_web: float | None = UNLESS_NONE
    """Present where the halves of the throw differ."""


class SupportNames(Result):
    """The supports that the scene defines."""

    torsion: str
    bending: str


class StiffnessPerMass(Result):
    """Stiffnesses with the supports of the scene over the mass of the throw."""

    torsion_Nm_per_rad_kg: float
    bending_N_per_mm_kg: float


class MeshSize(Result):
    """The mesh of an evaluation."""

    element_size_mm: float
    nodes: int
    order: int = 2
    """Degree of the displacements."""
    triangles: bool = False
    """The body is a surface of triangles, which the mesh replaces."""


class ErrorsBySupport(Result):
    """Bounds of the errors on this mesh by support, %."""

    torsion: dict[str, float | None]
    bending: dict[str, float | None]


class EvaluationSeconds(Result):
    """Wall times."""

    mesh: float
    solve: float
    total: float


class FlyingWebBending(Result):
    """Couple over tilt about the axis across the shaft about which that is least, and most."""

    softest_Nm_per_rad: float
    softest_axis_deg: float
    """Ahead of the throw on the free end's side, in the sense of rotation."""
    stiffest_Nm_per_rad: float


class FlyingWebResult(Result):
    """A flying web between the rigid middle sections of both its crankpins."""

    name: str
    turn_deg: float
    """Of the throw behind it ahead of the one before, in the sense of rotation."""
    mass_kg: float
    """Of both webs that it is made of."""
    torsion: dict[str, float]
    """Torque over relative rotation about the crank axis; held: sections may not move or tilt across."""
    bending: FlyingWebBending
    mesh: MeshSize
    error_estimate_percent: dict[str, float]
    """Of `torsion` and `bending`: the larger one of both stiffnesses."""
    seconds: float

    @property
    def error_percent(self) -> float:
        """The larger of the two error estimates."""
        return max(self.error_estimate_percent.values())


class EvaluationResult(Result):
    """The evaluation of one target."""

    target: str
    mass_kg: EvaluatedMass
    inertia_kg_mm2: float
    unbalance_kg_mm: float
    """Mass times y of the centre of mass."""
    balance_factor_percent: float | None = UNLESS_NONE
    """Percent of the oscillating mass that the throw balances, where the design has such a mass."""
    torsion: dict[str, float | None]
    """By support and unit, as in `free_Nm_per_rad`; None for a spring that nobody knows."""
    bending: dict[str, float | None]
    supports: SupportNames
    stiffness_per_mass: StiffnessPerMass
    mesh: MeshSize
    error_estimate_percent: dict[str, float]
    """Of `torsion` and `bending` with the supports of the scene."""
    error_by_support_percent: ErrorsBySupport
    seconds: EvaluationSeconds
    assumed: tuple[Assumption, ...]
    """Values that the design does not say and the stiffnesses depend on."""
    natural_frequency_Hz: float | None = UNLESS_NONE
    """First torsional natural frequency of the shaft, where requested."""
    fatigue_safety: float | None = UNLESS_NONE
    """Minimum by local stress analysis, where requested."""
    fatigue_place: str | None = UNLESS_NONE
    """Place of that minimum in words; None in results of an earlier version too."""
    fatigue_loads: LoadsName | None = UNLESS_NONE
    """Load states of that minimum: "extremes", "cycle" or "shaft"; None in earlier versions too."""
    fatigue_remarks: tuple[str, ...] | None = UNLESS_NONE
    """Sentences on that minimum: missed checks of the mesh, places not judged, the speed that decides."""
    flying_webs: tuple[FlyingWebResult, ...] | None = UNLESS_NONE
    """Each distinct flying web of the crank, where it has any and its design was evaluated as a crank."""
    stress_MPa: float | None = UNLESS_NONE
    """Largest von Mises stress over the same load states, where requested."""

    @property
    def torsion_Nm_per_rad(self) -> float:
        """Torsional stiffness with the scene's support."""
        return known(self.torsion[f"{self.supports.torsion}_Nm_per_rad"])

    @property
    def bending_N_per_mm(self) -> float:
        """Bending stiffness with the scene's support."""
        return known(self.bending[f"{self.supports.bending}_N_per_mm"])


def known(value: float | None) -> float:
    """Return a value that needs the spring of a bearing.

    Raises:
        CranktopoError: it is None, since the scene has no such spring.
    """
    if value is None:
        raise CranktopoError(
            "supports.bearing_spring_N_per_mm is missing.", hint="Give it in N/mm.", code=ExitCode.INTERNAL
        )
    return value
