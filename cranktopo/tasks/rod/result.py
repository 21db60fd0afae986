"""The strength of the rod: the JSON object of `rod --json`."""

from __future__ import annotations

from cranktopo.base.result import UNLESS_NONE, Result
from cranktopo.tasks.bolts.result import JointCheck
from cranktopo.tasks.rod.pin import PinCheck


class RodMasses(Result):
    """Masses of the rod from its geometry; those of the ends are what the engine's forces use."""

    total_kg: float
    body_kg: float
    """Rod and cap without bush, shells and bolts."""
    below_split_kg: float
    """Cap with its shell and the heads of the bolts."""
    reciprocating_kg: float
    rotating_kg: float
    centre_from_big_end_mm: float
    inertia_kg_mm2: float
    """About the centre of mass, for swinging."""


class RodSectionCheck(Result):
    """One place of the rod under the extremes of the cycle; stresses positive in tension."""

    section: str
    place_mm: float
    """Distance from the axis of the big end."""
    area_mm2: float
    push_N: float
    """Largest compression."""
    pull_N: float
    """Largest tension."""
    whip_MPa: float
    """Largest bending stress of the rod's own mass at speed; null where it is not in the section."""
    max_MPa: float
    min_MPa: float
    yield_safety: float
    fatigue_safety: float


class Buckling(Result):
    """The shank as a strut in one plane, by Navier and Rankine."""

    plane: str
    """`motion`: hinged at both pins; `pins`: held at both eyes."""
    length_mm: float
    """Buckling length."""
    slenderness: float
    euler_N: float
    rankine_N: float
    """Load at which the stress below reaches the yield strength."""
    stress_MPa: float
    """Compression with the allowance for buckling, under the largest push."""
    yield_safety: float


class FreeDimension(Result):
    """A dimension of the rod that the search was free to change."""

    name: str
    start_mm: float
    value_mm: float
    low_mm: float
    high_mm: float


class LighterRod(Result):
    """A rod that was searched: of two values the first is that of the design's own rod."""

    start_kg: float
    result_kg: float
    smallest_yield_safety: tuple[float, float]
    """Of all sections and struts."""
    smallest_fatigue_safety: tuple[float, float]
    speed_rpm: float
    """Highest speed, of the next two."""
    crankpin_pull_N: tuple[float, float]
    """Largest radial force on the crankpin away from the crank."""
    rotating_unbalance_kg_mm: tuple[float, float]
    """The rod's part of the unbalance of a throw."""
    dimensions: tuple[FreeDimension, ...]


class RodStrength(Result):
    """The rod of a design over the cycle at speed and overspeed."""

    schema_version: int = 1
    design: str
    shank: str
    speeds_rpm: tuple[float, ...]
    method: str
    """Method of the fatigue safeties."""
    masses: RodMasses
    push_N: float
    """Largest force of the piston pin on the rod toward the crank."""
    push_deg: float
    pull_N: float
    """Largest force of the piston pin on the rod away from the crank."""
    pull_deg: float
    bush_pressure_MPa: float
    held_deg: float
    """Angle from the crown of the small end to where the shank holds it."""
    sections: tuple[RodSectionCheck, ...]
    buckling: tuple[Buckling, ...]
    pin: PinCheck | None
    bolt: JointCheck | None
    lighter: LighterRod | None = UNLESS_NONE
    """Dimensions that `--lighter` changed; the strength is then that of the lighter rod."""
