"""Scene tables of how an engine is arranged: cylinders and throws, balancer shafts, another crank."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Literal

from pydantic import Field

from cranktopo.base.table import (
    CrankAngle,
    Length,
    LengthOrZero,
    Place,
    SceneTable,
    WholeNumber,
    is_unset,
)

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
    """Arrangement of cylinders and throws; without it: in line, evenly firing.

    `V`, `W`: two, or three and more rods side by side on each pin, one of each bank; cylinders are numbered
    bank by bank, each from the free end. `boxer`: flat, opposed, each cylinder on its own pin; odd numbers
    are the first bank, even ones the second. `radial`: cylinders evenly spaced around the shaft and numbered
    so, their rods in one plane on one pin; with two or more rows neighbours belong to rows in turn. Later
    banks and cylinders are ahead of the first in the sense of rotation.
    """

    layout: Literal["in-line", "V", "W", "boxer", "radial"] = "in-line"
    """Arrangement of the cylinders."""
    bank_angle_deg: float | None = Field(default=None, ge=1, le=180, examples=[90.0], allow_inf_nan=False)
    """Angle between the two banks; needed for `V`, 180 for a boxer."""
    bank_angles_deg: tuple[Turn, ...] = Field(default=(), examples=[(0.0, 60.0, 120.0)], exclude_if=is_unset)
    """Direction of each bank of a `W` from the first, in the sense of rotation; needed there."""
    rod_offset_mm: LengthOrZero | None = Field(default=None, examples=[18.0])
    """Distance along the shaft of neighbouring rods on a pin of a `V` or `W`; by default the pin's length
    over their number. 0 in a `W`: one master rod carries the others."""
    pin_splay_deg: float | None = Field(
        default=None, ge=-90, le=90, allow_inf_nan=False, examples=[-30.0], exclude_if=is_unset
    )
    """Split pins of a `V`: angle by which the second rod's half pin is ahead of the first one's, in the sense
    of rotation; the throw's own angle is in the middle of both."""
    cylinder_pitch_mm: Length | None = Field(default=None, examples=[114.0])
    """Distance of neighbouring throws, for `cranktopo balance`; by default the length of a throw."""
    throw_angles_deg: tuple[Turn, ...] = Field(default=(), examples=[(0.0, 180.0)])
    """Angle of each throw about the crank axis from the first, in the sense of rotation, from the free end;
    needed where firing is uneven, by default such that it is even. A `radial` has one row for each."""
    balanced_oscillating_share: float | None = Field(
        default=None, ge=0, le=1, examples=[0.5], allow_inf_nan=False
    )
    """Share of the oscillating masses that the counterweights balance beside all rotating ones; by default 0,
    which `shape` holds the balance at only if it is given."""
    balancer_shaft: tuple[BalancerShaft, ...] = ()

    @property
    def balanced_share(self) -> float:
        """Share of the oscillating masses that the counterweights balance."""
        return self.balanced_oscillating_share or 0.0

    @property
    def banks_deg(self) -> tuple[float, ...]:
        """Directions of the banks whose rods share a pin, from the first; one where no bank does."""
        if self.layout == "V":
            return (0.0, self.bank_angle_deg or 0.0)
        return (self.layout == "W" and self.bank_angles_deg) or (0.0,)


class Opposed(SceneTable):
    """The other crank of an engine with two opposed pistons in each cylinder; the design is one of both.

    The gas is between both pistons: its angles count from the least volume, its `compression_ratio` is that
    of the whole cylinder. Angles of the crank count from the inner dead centre of its own pistons. Loads,
    work, power and free forces are those of this crank alone.
    """

    lead_deg: float = Field(default=0.0, ge=-60, le=60, allow_inf_nan=False, examples=[-12.0])
    """Angle by which the other crank is ahead of this one, each from its own inner dead centre."""
    radius_mm: Length | None = Field(default=None, examples=[40.0])
    """Throw radius of the other crank; by default that of this one."""
    rod_length_mm: Length | None = Field(default=None, examples=[150.0])
    """Rod length of the other crank; by default that of this one."""


def banks_words(layout: str, directions_deg: Sequence[float]) -> str:
    """Return where the banks of a V or W are, or the cylinders of a radial, in words; else empty."""
    different = tuple(dict.fromkeys(directions_deg))
    if layout == "V":
        return f", banks {different[-1]:g} deg apart"
    if layout == "radial":
        return f", cylinders {different[1]:g} deg apart"
    return f", banks at {', '.join(f'{angle:g}' for angle in different)} deg" if layout == "W" else ""
