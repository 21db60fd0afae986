"""Scene tables of the engine's arrangement: banks, throws, share of balance, balancer shafts, with checks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from cranktopo.base.errors import invalid
from cranktopo.base.table import CrankAngle, Length, LengthOrZero, Place, SceneTable, WholeNumber

if TYPE_CHECKING:
    from cranktopo.design.engine import Engine
    from cranktopo.design.schema import Scene

_PATH = "engine.arrangement"
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


def check_arrangement(scene: Scene) -> None:
    """Check that layout, banks, throws and balancer shafts fit together.

    Raises:
        CranktopoError: first inconsistency found.
    """
    engine = scene.engine
    if engine is None or engine.arrangement is None:
        return
    _check_layout(engine, engine.arrangement)
    _check_lengths(scene, engine.arrangement)
    _check_throws(engine, engine.arrangement)
    for number, shaft in enumerate(engine.arrangement.balancer_shaft):
        _check_shaft(f"{_PATH}.balancer_shaft[{number}]", shaft, engine.arrangement.balancer_shaft[:number])


def _check_layout(engine: Engine, arranged: Arrangement) -> None:
    bank, layout = arranged.bank_angle_deg, arranged.layout
    if layout == "V" and bank is None:
        raise invalid(f"{_PATH}.bank_angle_deg", None, "must be given for a V, >= 1 and <= 180 deg")
    if layout == "in-line" and bank is not None:
        raise invalid(
            f"{_PATH}.bank_angle_deg", bank, "an in-line engine has one bank", f"Give {_PATH}.layout = 'V'."
        )
    if layout == "boxer" and bank not in (None, 180.0):
        raise invalid(f"{_PATH}.bank_angle_deg", bank, "must be 180 deg for a boxer", "Leave it out.")
    if layout != "in-line" and engine.cylinders % 2:
        raise invalid("engine.cylinders", engine.cylinders, f"must be even for {_PATH}.layout = '{layout}'")


def _check_lengths(scene: Scene, arranged: Arrangement) -> None:
    pin, offset, pitch = scene.throw.crankpin.length_mm, arranged.rod_offset_mm, arranged.cylinder_pitch_mm
    if offset is not None and arranged.layout != "V":
        raise invalid(f"{_PATH}.rod_offset_mm", offset, "only a V has two rods on a pin", "Leave it out.")
    for key, value, fits in (
        ("rod_offset_mm", offset, offset is None or offset < pin),
        ("cylinder_pitch_mm", pitch, pitch is None or pitch > pin),
    ):
        if not fits:
            than = "smaller" if key == "rod_offset_mm" else "larger"
            raise invalid(
                f"{_PATH}.{key}", value, f"must be {than} than throw.crankpin.length_mm = {pin:g} mm"
            )


def _check_throws(engine: Engine, arranged: Arrangement) -> None:
    key, angles = f"{_PATH}.throw_angles_deg", arranged.throw_angles_deg
    if not angles:
        _check_even_firing(engine)
        return
    if len(angles) != engine.throws:
        raise invalid(key, list(angles), f"must have one angle per throw ({engine.throws})")
    if angles[0]:
        raise invalid(key, list(angles), "must begin with 0: angles count from the first throw")
    _ = engine.firing_angles_deg  # refuses throws that contradict the firing order


def _check_even_firing(engine: Engine) -> None:
    """Even firing is possible only where both rods of a pin ask for the same angle of it."""
    for cylinder in range(1, engine.cylinders + 1):
        first = engine.throw_of(cylinder) + 1
        gap = (engine.even_angle_deg(cylinder) - engine.even_angle_deg(first) + 180.0) % 360.0 - 180.0
        if abs(gap) > 1e-6:
            raise invalid(
                "engine.firing_order",
                list(engine.order),
                f"cannot be even: cylinders {first} and {cylinder} on one pin would need throws "
                f"{abs(gap):g} deg apart, and split pins (two pins with a web between them) are not modelled",
                f"Give {_PATH}.throw_angles_deg, or another order or bank angle.",
            )


def _check_shaft(path: str, shaft: BalancerShaft, before: tuple[BalancerShaft, ...]) -> None:
    moment = shaft.balances == "moment"
    if moment and shaft.distance_mm is None:
        raise invalid(f"{path}.distance_mm", None, "must be given where balances = 'moment'")
    if not moment and shaft.distance_mm is not None:
        raise invalid(
            f"{path}.distance_mm",
            shaft.distance_mm,
            "a shaft that balances a force has one mass",
            "Leave it out, or give balances = 'moment'.",
        )
    if moment and shaft.z_mm is not None:
        raise invalid(
            f"{path}.z_mm", shaft.z_mm, "two opposite masses act alike wherever they are", "Leave it out."
        )
    free = shaft.unbalance_kg_mm is None or shaft.phase_deg is None
    alike = [
        s for s in before if (s.order, s.turns, s.balances) == (shaft.order, shaft.turns, shaft.balances)
    ]
    if alike and (free or any(s.unbalance_kg_mm is None or s.phase_deg is None for s in alike)):
        raise invalid(
            path,
            f"order {shaft.order}, {shaft.turns} the crank, {shaft.balances}",
            "is there twice and cannot be found from the engine's needs",
            "Give unbalance_kg_mm and phase_deg of both, or leave one out.",
        )
