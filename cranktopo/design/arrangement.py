"""Scene tables of the engine's arrangement: banks, throws, share of balance, balancer shafts."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from cranktopo.base.table import CrankAngle, Length, LengthOrZero, Place, SceneTable, WholeNumber

Turn = Annotated[float, Field(ge=0, lt=360, allow_inf_nan=False)]
"""An angle about the crank axis, deg."""


class Gear(SceneTable):
    """Helical gear that drives a balancer shaft."""

    power_kW: float = Field(ge=1e-6, le=1e5, allow_inf_nan=False, examples=[1.0])
    """Power that it passes on: what the shaft's bearings and oil take."""
    pitch_radius_mm: Length = Field(examples=[34.6])
    """Radius of its pitch circle."""
    helix_deg: float = Field(default=0.0, ge=0, le=60, allow_inf_nan=False)
    """Helix angle at the pitch circle; 0 for a spur gear."""
    pressure_deg: float = Field(default=20.0, ge=5, le=45, allow_inf_nan=False)
    """Pressure angle in the section normal to the teeth."""


class BalancerShaft(SceneTable):
    """A balancer shaft (Lanchester); its unbalance, phase and place are found where they are not given.

    It turns at `order` times the speed of the crank. A pair that turns with and against the crank balances a
    force along the cylinders.
    """

    order: Annotated[Literal[1, 2], WholeNumber] = Field(examples=[2])
    """Its speed over that of the crank."""
    turns: Literal["with", "against"] = Field(examples=["against"])
    """Sense of its rotation: with the crank or against it."""
    balances: Literal["force", "moment"] = "force"
    """One mass against a free force, or two opposite masses against a free moment."""
    distance_mm: Length | None = Field(default=None, examples=[200.0])
    """Distance along the shaft of the two masses of a shaft that balances a moment; needed there."""
    z_mm: Place | None = Field(default=None, examples=[0.0])
    """Place of the mass of a shaft that balances a force, along the crank from its middle, toward the
    takeoff; by default where it also takes most of the moment of its order."""
    unbalance_kg_mm: float | None = Field(default=None, ge=0, le=1e7, examples=[5.0], allow_inf_nan=False)
    """Mass times radius of each of its masses; by default what the engine needs."""
    phase_deg: CrankAngle | None = Field(default=None, examples=[180.0])
    """Direction of its mass (of two: of that nearer to the takeoff) at firing top dead centre of the first
    cylinder that fires, from the engine's plane of symmetry, in the crank's sense of rotation; by default
    what the engine needs."""
    gear: Gear | None = None


class Arrangement(SceneTable):
    """How cylinders and throws are arranged; without it: in line, evenly firing.

    `V`: two rods side by side on each pin; cylinder 1 to n/2 are the first bank, the others the second, each
    from the free end. `boxer`: flat, opposed, each cylinder on its own pin; odd numbers are the first bank,
    even ones the second. The second bank is ahead of the first in the sense of rotation.
    """

    layout: Literal["in-line", "V", "boxer"] = "in-line"
    """Arrangement of the cylinders."""
    bank_angle_deg: float | None = Field(default=None, ge=1, le=180, examples=[90.0], allow_inf_nan=False)
    """Angle between the two banks; needed for `V`, 180 for a boxer."""
    rod_offset_mm: LengthOrZero | None = Field(default=None, examples=[18.0])
    """Distance along the shaft of the two rods on a pin of a `V`; by default half the pin's length."""
    cylinder_pitch_mm: Length | None = Field(default=None, examples=[114.0])
    """Distance of neighbouring throws, for `cranktopo balance`; by default the length of a throw."""
    throw_angles_deg: tuple[Turn, ...] = Field(default=(), examples=[(0.0, 180.0)])
    """Angle of each throw about the crank axis from the first, in the sense of rotation, from the free end;
    needed where firing is uneven, by default such that it is even."""
    balanced_oscillating_share: float = Field(default=0.0, ge=0, le=1, allow_inf_nan=False)
    """Share of the oscillating masses that the counterweights balance beside all rotating ones."""
    balancer_shaft: tuple[BalancerShaft, ...] = ()
