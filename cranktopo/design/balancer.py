"""Scene tables of one balancer shaft as a part: its steps, masses, bearings, gear, notches."""

from __future__ import annotations

import math
from itertools import accumulate
from typing import Annotated, Literal

from pydantic import Field

from cranktopo.base.table import (
    Length,
    LengthOrZero,
    Mass,
    Place,
    SceneTable,
    SmallLength,
    Stiffness,
    TurningSpeed,
)
from cranktopo.design.arrangement import Gear
from cranktopo.design.bolt import Bolt
from cranktopo.design.material import Material
from cranktopo.design.shaft import RollerBearing
from cranktopo.design.shape import Range

_Angle = Annotated[float, Field(ge=-360, le=360, allow_inf_nan=False)]


class ShaftStep(SceneTable):
    """A cylinder of the shaft; the first begins at z = 0, each next one where the one before ends."""

    length_mm: Length = Field(examples=[60.0])
    """Length along the shaft."""
    diameter_mm: Length = Field(examples=[45.0])
    """Outer diameter."""
    bore_mm: LengthOrZero = 0.0
    """Diameter of its bore."""
    free_diameter_mm: Range | None = Field(default=None, examples=[[40.0, 50.0]])
    """Range of the outer diameter in `balancer --redesign`; without it the diameter stays."""
    free_bore_mm: Range | None = Field(default=None, examples=[[0.0, 30.0]])
    """Range of the bore's diameter in `balancer --redesign`; without it the bore stays."""


class ShaftWeight(SceneTable):
    """A mass on the shaft that makes its unbalance, of one piece with it or bolted on."""

    z_mm: Place = Field(examples=[100.0])
    """Place along the shaft."""
    unbalance_kg_mm: Mass = Field(examples=[45.0])
    """Mass times the distance of its centre of mass from the axis."""
    deg: _Angle = 0.0
    """Direction about the axis."""
    bolts: int = Field(default=2, ge=1, le=64)
    """Number of bolts that hold it, each with the same share of its centrifugal force along its axis."""
    bolt: Bolt | None = None


class BalancerBearing(SceneTable):
    """A bearing of the shaft: rigid, a spring, or rollers."""

    z_mm: Place = Field(examples=[0.0])
    """Place along the shaft."""
    spring_N_per_mm: Stiffness | None = Field(default=None, examples=[5.0e6])
    """Radial stiffness; by default that of the roller bearing, or rigid without one."""
    roller_bearing: RollerBearing | None = None
    free_z_mm: Range | None = Field(default=None, examples=[[270.0, 285.0]])
    """Range of its place in `balancer --redesign`; without it the place stays."""


class ShaftGear(Gear):
    """The gear that drives the shaft; forces stand still in space while the shaft turns."""

    z_mm: Place = Field(examples=[-20.0])
    """Place along the shaft."""
    deg: _Angle = 0.0
    """Direction from the axis to the mesh, in space."""


class ShaftNotch(SceneTable):
    """A groove around the shaft or a hole across it, where its fatigue is judged."""

    name: str = Field(default="groove", pattern=r"^[A-Za-z0-9][A-Za-z0-9 ._-]*$", examples=["groove"])
    """Name in tables."""
    kind: Literal["groove", "hole"] = Field(default="groove", examples=["groove"])
    """A round groove, or a hole across the shaft."""
    z_mm: Place = Field(examples=[50.0])
    """Place along the shaft."""
    diameter_mm: Length = Field(examples=[42.5])
    """Diameter at the bottom of the groove, or of the hole."""
    radius_mm: Length = Field(default=0.5, examples=[0.5])
    """Radius at the bottom of the groove."""


class ShaftProbe(SceneTable):
    """A place whose deflection counts, such as a spline."""

    name: str = Field(default="spline", pattern=r"^[A-Za-z0-9][A-Za-z0-9 ._-]*$", examples=["spline"])
    """Name in tables."""
    z_mm: Place = Field(examples=[200.0])
    """Place along the shaft."""
    permitted_mm: SmallLength | None = Field(default=None, examples=[0.05])
    """Largest deflection that is permitted."""


class SpeedStep(SceneTable):
    """A speed of the spectrum and its share of the running time."""

    at_rpm: TurningSpeed = Field(examples=[2000.0])
    """Speed of the shaft."""
    share: float = Field(ge=1e-6, le=1, allow_inf_nan=False, examples=[1.0])
    """Share of the time; shares count by their sum."""


class BalancerRedesign(SceneTable):
    """Wants and additions of `cranktopo balancer --redesign`; steps and bearings say what it may change."""

    deflection_mm: SmallLength | None = Field(default=None, examples=[0.025])
    """Largest deflection of every `[[balancer.probe]]`; by default what each permits, or has."""
    bearing: tuple[BalancerBearing, ...] = Field(default=(), max_length=8)
    """Bearings that it adds to those of the shaft."""


class BalancerPart(SceneTable):
    """A balancer shaft as a part, for `cranktopo balancer`: a beam on its bearings.

    What an engine needs of balancer shafts is in `[[engine.arrangement.balancer_shaft]]`.
    """

    max_speed_rpm: TurningSpeed = Field(examples=[2460.0])
    """Highest speed of the shaft, at which forces and deflections are given."""
    treatment_factor: float = Field(default=1.0, ge=0.5, le=3, allow_inf_nan=False)
    """Strength of its surface over that of an untreated one, such as hardened, by tests or a standard."""
    material: Material | None = None
    """Its material; by default that of the crankshaft."""
    gear: ShaftGear | None = None
    step: tuple[ShaftStep, ...] = Field(default=(), max_length=64)
    weight: tuple[ShaftWeight, ...] = Field(default=(), max_length=32)
    bearing: tuple[BalancerBearing, ...] = Field(default=(), max_length=32)
    notch: tuple[ShaftNotch, ...] = Field(default=(), max_length=32)
    probe: tuple[ShaftProbe, ...] = Field(default=(), max_length=32)
    speed: tuple[SpeedStep, ...] = Field(default=(), max_length=64)
    redesign: BalancerRedesign | None = None

    @property
    def placed(self) -> tuple[ShaftWeight | BalancerBearing | ShaftNotch | ShaftProbe | ShaftGear, ...]:
        """Return all that has a place along the shaft."""
        gear = (self.gear,) if self.gear else ()
        return (*self.weight, *self.bearing, *self.notch, *self.probe, *gear)

    @property
    def length_mm(self) -> float:
        """Return the length of the shaft."""
        return sum(step.length_mm for step in self.step)

    @property
    def unnotched_mm3(self) -> float:
        """Return the volume of the steps without their bores."""
        return sum(math.pi / 4 * s.length_mm * (s.diameter_mm**2 - s.bore_mm**2) for s in self.step)

    @property
    def steps(self) -> tuple[tuple[ShaftStep, float, float], ...]:
        """Return every step with the places where it begins and ends, mm."""
        ends = [*accumulate((step.length_mm for step in self.step), initial=0.0)]
        return tuple(zip(self.step, ends, ends[1:], strict=False))

    def section_at(self, z_mm: float) -> tuple[float, float]:
        """Return outer diameter and bore at a place, mm; at a step the thinner side."""
        at = [step for step, start, end in self.steps if start - 1e-9 <= z_mm <= end + 1e-9]
        thin = min(at, key=lambda step: step.diameter_mm**4 - step.bore_mm**4)
        return thin.diameter_mm, thin.bore_mm
