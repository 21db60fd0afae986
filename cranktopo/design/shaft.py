"""Scene tables of the bearings, of what is joined to the crankshaft, and of its damping."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from functools import cache
from importlib.resources import files
from typing import Any, Literal

import numpy as np
from pydantic import Field, model_validator

from cranktopo.base.arrays import Array, Mask
from cranktopo.base.table import (
    SHOWN,
    UNLESS_IN_LIBRARY,
    BearingStiffness,
    Inertia,
    Length,
    LengthOrZero,
    LossFactor,
    Mass,
    Reaction,
    SceneTable,
    SmallLength,
    Strength,
    TorsionalDamping,
    TorsionalStiffness,
    TurningSpeed,
    filled_in,
)


@cache
def bearing_library() -> dict[str, dict[str, Any]]:
    """Return the roller bearings shipped with the package, by name."""
    return tomllib.loads((files("cranktopo.design") / "bearings.toml").read_text(encoding="utf-8"))


class RollerBearing(SceneTable):
    """Roller bearing given by the load-displacement table of a roller; a known `name` fills it in."""

    name: str = Field(default="custom", examples=["HK4520"], json_schema_extra=SHOWN)
    """A name of the library fills in every key that is not given; any other name needs own values."""
    kind: Literal["radial", "thrust"] = "radial"
    """Direction in which the bearing carries; only radial ones support a journal."""
    rollers: int = Field(ge=3, le=1000, examples=[38], json_schema_extra=UNLESS_IN_LIBRARY)
    """Number of rollers."""
    displacement_mm: tuple[SmallLength, ...] = Field(
        min_length=3, examples=[(0.001, 0.004, 0.01)], json_schema_extra=UNLESS_IN_LIBRARY
    )
    """Displacements of one roller, increasing."""
    reaction_N: tuple[Reaction, ...] = Field(
        min_length=3, examples=[(33.0, 172.0, 501.0)], json_schema_extra=UNLESS_IN_LIBRARY
    )
    """Reaction of one roller, or of one millimetre of it, at each displacement, increasing."""
    roller_length_mm: Length | None = Field(default=None, examples=[15.3])
    """Length of a roller whose reactions are those of one millimetre, as those of the library are; without it
    they are those of the whole roller."""
    dynamic_rating_kN: float | None = Field(default=None, ge=1e-3, le=1e5, examples=[26.0])
    """Basic dynamic load rating (ISO 281), for the life in `cranktopo balance`; axial of a thrust bearing."""
    roller_diameter_mm: Length | None = Field(default=None, examples=[3.0])
    """Diameter of a roller: with it, the next key and the length `cranktopo shaft` tells the life of a main
    bearing by ISO/TS 16281, with the tilt of its journal, which the rollers resist."""
    pitch_diameter_mm: Length | None = Field(default=None, examples=[63.0])
    """Diameter of the circle through the middles of the rollers."""
    clearance_mm: LengthOrZero = 0.0
    """Internal clearance of the bearing at work, of the diameters, for that life and that tilt."""
    source: str = ""
    """Origin of the values."""

    @property
    def sizes(self) -> tuple[float | None, float | None, float | None]:
        """Diameter and length of a roller, and diameter of their circle, as far as they are given."""
        return self.roller_diameter_mm, self.roller_length_mm, self.pitch_diameter_mm

    @model_validator(mode="before")
    @classmethod
    def _from_library(cls, data: Any) -> Any:
        return filled_in(data, bearing_library(), frozenset({"rollers", "displacement_mm", "reaction_N"}))


class Supports(SceneTable):
    """Supports of the rigid mid-journal sections, per load case, and stiffness of the bearings.

    The radial stiffness of one bearing is given directly, by the clearance of a plain bearing, or by the
    roller table of a roller bearing.
    """

    torsion: Literal["free", "held", "spring"] = "free"
    """Mid-journal sections in torsion: free to move laterally and tilt, held, or on bearing springs."""
    bending: Literal["pinned", "clamped", "spring"] = "pinned"
    """Mid-journal sections in bending: free to tilt, clamped against tilt, or on bearing springs."""
    bearing_spring_N_per_mm: BearingStiffness | None = Field(default=None, examples=[1.07e6])
    """Radial stiffness of one main bearing; this or one of the next two where a support is `spring`."""
    bearing_clearance_mm: SmallLength | None = Field(default=None, examples=[0.03])
    """Radial clearance of a plain bearing: the spring is half the largest gas force over 0.8 of it."""
    roller_bearing: RollerBearing | None = None
    bearing_tilt_spring_Nm_per_rad: TorsionalStiffness | None = Field(default=None, examples=[2.0e5])
    """Moment by which a main bearing of any kind resists that its journal tilts, over the tilt, in a shaft on
    all its bearings. By default that of rollers of given sizes under half the largest gas force, unless there
    are `[bearings]`; else journals tilt freely. A throw alone has `clamped` sections or free ones."""


class Rotor(SceneTable):
    """A disk on the shaft."""

    inertia_kg_m2: Inertia = Field(examples=[0.02])
    """Inertia about the crank axis."""
    stiffness_Nm_per_rad: TorsionalStiffness | None = Field(default=None, examples=[2.0e6])
    """Torsional stiffness of the shaft between it and its neighbour; rigid when it is not given."""
    loss_factor: LossFactor = 0.0
    """Loss factor of that shaft, relative damping over 2 pi; 0 = none. Needs `stiffness_Nm_per_rad`."""

    @property
    def is_elastic(self) -> bool:
        """Tell whether a shaft of its own joins it to its neighbour."""
        return self.stiffness_Nm_per_rad is not None


class Carried(SceneTable):
    """Mass and place of a part on the shaft, whose vibrations bend it, too."""

    mass_kg: Mass | None = Field(default=None, examples=[12.0])
    """Mass that the shaft carries. Without it the part counts in torsion alone; `cranktopo modes` warns."""
    diametral_inertia_kg_m2: Inertia | None = Field(default=None, examples=[0.012])
    """Inertia about a diameter through its centre of mass; by default half of that about the crank axis, as a
    thin disk has it."""
    overhang_mm: LengthOrZero = 0.0
    """Distance of its centre of mass outwards from the end of the crank: the outer face of the last step, or
    the middle of the outer main journal where the crank has no end."""


class CarriedRotor(Rotor, Carried):
    """A disk that the crankshaft carries."""


class Propeller(CarriedRotor):
    """Propeller, of an aircraft or a ship; it takes up the engine's mean torque."""

    inertia_kg_m2: Inertia = Field(examples=[0.6])
    """Inertia about the crank axis, with the water that moves with it."""
    damping_Nms_per_rad: TorsionalDamping = 0.0
    """Torque by which air or water resists its vibration, over the angular velocity of that vibration."""


class Coupling(Rotor):
    """Elastic coupling behind the flywheel, or behind the crankshaft where there is none."""

    inertia_kg_m2: Inertia = Field(examples=[0.05])
    """Inertia of its driven half; the driving half belongs to the flywheel. Behind a gear that turns i times
    as fast as the crankshaft, inertia, stiffness and damping count i squared times."""
    stiffness_Nm_per_rad: TorsionalStiffness = Field(examples=[2.0e4])
    """Dynamic torsional stiffness."""
    loss_factor: LossFactor = 0.0
    """Loss factor of its elements: 0.1 to 0.2 for rubber; relative damping over 2 pi."""


class Damper(Carried):
    """Torsional vibration damper at the free end: a ring, joined to its hub by rubber or a viscous fluid."""

    kind: Literal["rubber", "viscous"] = Field(examples=["viscous"])
    """`rubber` needs stiffness and loss factor; `viscous` damping, and stiffness where it has springs."""
    ring_inertia_kg_m2: Inertia = Field(examples=[0.03])
    """Inertia of the ring; of a viscous damper the ring in the fluid."""
    hub_inertia_kg_m2: Inertia = Field(examples=[0.01])
    """Inertia of all that is fixed to the shaft: the hub, and the housing of a viscous damper."""
    damping_Nms_per_rad: TorsionalDamping | None = Field(
        default=None, examples=[6.0], json_schema_extra=SHOWN
    )
    """Torque between ring and hub over their relative angular velocity."""
    stiffness_Nm_per_rad: TorsionalStiffness | None = Field(default=None, examples=[5.0e4])
    """Dynamic torsional stiffness between ring and hub."""
    loss_factor: LossFactor | None = Field(default=None, examples=[0.15])
    """Loss factor of the rubber."""


ROTORS = ("pulley", "flywheel", "coupling", "driven", "propeller")
"""Keys of the parts that turn with the crankshaft, from the free end; a damper is on that end as well."""


def passed_through(barred_rpm: Iterable[tuple[float, float]], speeds_rpm: Array) -> Mask:
    """Tell of each speed whether it lies inside a range that an engine only passes through; ends do not."""
    speeds = np.asarray(speeds_rpm)
    found = np.zeros(speeds.shape, dtype=bool)
    for low, high in barred_rpm:
        found |= (low < speeds) & (speeds < high)
    return found


class ShaftTable(SceneTable):
    """Inertias that turn with the crankshaft, and its damping: the model of torsional vibration.

    From the free end to the takeoff: damper, pulley, the throws, flywheel, coupling, driven machine or
    propeller. Values behind a gear that turns i times as fast as the crankshaft are those of the part times
    i squared: inertia, stiffness and damping alike.
    """

    speed_min_rpm: TurningSpeed | None = Field(default=None, examples=[700.0])
    """Lowest speed that is looked at; by default a third of `engine.speed_rpm`. Where it is given, safety
    counts there as well, with the pressure of that speed, else with that of `engine.speed_rpm`."""
    speed_max_rpm: TurningSpeed | None = Field(default=None, examples=[2800.0])
    """Highest speed that is looked at; by default the overspeed, and 1.05 times the engine's speed
    where none is given."""
    throw_stiffness_Nm_per_rad: TorsionalStiffness | None = Field(default=None, examples=[1.5e5])
    """Torsional stiffness of a throw; by default that of finite elements in `vibration` and `fatigue`, and
    the mean of Carter's and Ker Wilson's formulae in the plan and the load cases of optimisations."""
    throw_stiffnesses_Nm_per_rad: tuple[TorsionalStiffness, ...] | None = Field(
        default=None, min_length=1, max_length=32, examples=[[1.48e5, 1.52e5, 1.52e5, 1.48e5]]
    )
    """The same of every throw, from the free end; one between neighbours is stiffer than the outer ones."""
    cylinder_damping_Nms_per_rad: TorsionalDamping = 0.0
    """Absolute damping of a cylinder (friction): torque over the angular velocity of its throw's vibration.
    A throw has it once for each of its rods."""
    throw_damping_Nms_per_rad: TorsionalDamping = 0.0
    """Relative damping: torque between neighbouring throws over their relative angular velocity."""
    throw_loss_factor: LossFactor = 0.02
    """Relative damping of the crankshaft, throws and ends, as loss factor; 0.02 is a dynamic magnifier of 50
    by itself. A shaft that another part gives by `stiffness_Nm_per_rad` has that part's `loss_factor`."""
    permitted_shear_MPa: Strength | None = Field(default=None, examples=[40.0])
    """Largest nominal alternating shear stress of journals and pins; speeds above it are to be barred."""
    barred_rpm: tuple[tuple[TurningSpeed, TurningSpeed], ...] | None = Field(
        default=None, min_length=1, max_length=8, examples=[[[350.0, 381.0]]], json_schema_extra=SHOWN
    )
    """Ranges of speed, from the lower to the higher end, that the engine only passes through: torques of the
    vibrating shaft, load states and safeties leave them out."""
    pulley: CarriedRotor | None = None
    """Pulley, gear or fan at the free end."""
    damper: Damper | None = None
    flywheel: CarriedRotor | None = None
    """Flywheel at the takeoff."""
    coupling: Coupling | None = None
    driven: CarriedRotor | None = None
    """Driven machine behind coupling or flywheel; it takes up the engine's mean torque."""
    propeller: Propeller | None = None

    @property
    def gives_stiffness(self) -> bool:
        """Tell whether it gives the torsional stiffness of the throws."""
        return self.throw_stiffness_Nm_per_rad is not None or self.throw_stiffnesses_Nm_per_rad is not None

    @property
    def elastic_rotors(self) -> dict[str, Rotor]:
        """Parts that a shaft of their own joins to their neighbour, by key, from the free end."""
        named = {name: getattr(self, name) for name in ROTORS}
        return {name: rotor for name, rotor in named.items() if rotor is not None and rotor.is_elastic}

    @property
    def has_takeoff(self) -> bool:
        """Tell whether anything is joined to the takeoff."""
        return any((self.flywheel, self.coupling, self.driven, self.propeller))
