"""A balancer shaft as a part: the JSON object of `balancer --json`."""

from __future__ import annotations

from typing import Literal

from cranktopo.base.result import UNLESS_NONE, Result
from cranktopo.engine.balance.balancer_shafts import GearForces
from cranktopo.tasks.bolts.result import JointCheck


class WeightForce(Result):
    """Centrifugal force of one mass on the shaft."""

    z_mm: float
    force_N: float
    deg: float


class ShaftBearingLoad(Result):
    """One bearing of the shaft; the radial parts are those of the masses and of the gear."""

    bearing: str
    z_mm: float
    spring_N_per_mm: float | None
    """Radial stiffness; null is rigid."""
    weights_N: float
    """Force of the masses, which turns with the shaft."""
    gear_N: float
    """Force of the gear, which stands still."""
    max_N: float
    """Both in one direction; of a thrust bearing the axial force of the gear."""
    tilt_mrad: float
    equivalent_N: float
    """Constant force of the same life over turn and spectrum."""
    life_h: float | None
    """Basic rating life by ISO 281; null without a dynamic rating or load."""


class ProbeDeflection(Result):
    """Largest deflection of a place of the shaft at its highest speed."""

    name: str
    z_mm: float
    deflection_mm: float
    permitted_mm: float | None = UNLESS_NONE


class NotchCheck(Result):
    """Fatigue of a groove or hole by local stress analysis.

    The masses bend the shaft always to the same side: their stress is the mean, that of the gear the
    amplitude. Started and stopped, all of it swings from zero.
    """

    name: str
    z_mm: float
    moment_Nm: float
    """Bending moment of masses and gear in one direction."""
    concentration: float
    stress_MPa: float
    """Largest local stress."""
    gradient_per_mm: float
    size_factor: float
    running_safety: float
    """At constant speed."""
    starting_safety: float
    """From standstill to the highest speed and back."""
    reversed_safety: float
    """As if the whole stress were reversed in every turn, as a force that stands still in space makes it."""


class KeptLimit(Result):
    """A quantity that a redesign has to keep within its limit."""

    quantity: str
    unit: str
    sense: Literal["<=", ">="]
    before: float
    """Of the given shaft."""
    after: float
    limit: float

    @property
    def excess(self) -> float:
        """Return by which share the limit is missed; negative where it is kept."""
        return (self.after / self.limit - 1) * (1 if self.sense == "<=" else -1)


class ShaftDimension(Result):
    """A dimension that a redesign was free to change."""

    key: str
    """Key path in the scene of the redesign."""
    start_mm: float | None
    """Of the given shaft; null of a bearing that was added."""
    value_mm: float
    low_mm: float
    high_mm: float


class Redesign(Result):
    """Changes of the given shaft by a redesign."""

    start_kg: float
    result_kg: float
    added_bearings: int
    """Last ones of the bearings."""
    limits: tuple[KeptLimit, ...]
    dimensions: tuple[ShaftDimension, ...]


class BalancerStrength(Result):
    """A balancer shaft of a design as a beam on its bearings."""

    schema_version: int = 1
    design: str
    speed_rpm: float
    mass_kg: float
    """Of the steps, without the masses on them."""
    gear: GearForces | None
    weights: tuple[WeightForce, ...]
    bearings: tuple[ShaftBearingLoad, ...]
    largest_deflection_mm: float
    probes: tuple[ProbeDeflection, ...]
    notches: tuple[NotchCheck, ...]
    joints: tuple[JointCheck, ...]
    """Bolts of the masses."""
    strength_remarks: tuple[str, ...] | None = UNLESS_NONE
    """Limits of what the strengths of the material hold for, such as the section of the shaft."""
    redesign: Redesign | None = UNLESS_NONE
    """With `--redesign`; the strength is then that of the new shaft."""
