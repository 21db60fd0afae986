"""Scene tables of bolts and bolted joints, and the library of threads and strength classes behind them.

Sources: ISO 261 (pitches), ISO 724 (diameters), ISO 898-1 (stress area, strengths), ISO 273 (medium holes).
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import AfterValidator, Field
from pydantic_core import PydanticCustomError

from cranktopo.base.table import SHOWN, Force, Length, LengthOrZero, Place, SceneTable, Strength

COARSE_PITCH_MM = {
    3: 0.5, 4: 0.7, 5: 0.8, 6: 1.0, 7: 1.0, 8: 1.25, 9: 1.25, 10: 1.5, 11: 1.5, 12: 1.75, 14: 2.0, 16: 2.0,
    18: 2.5, 20: 2.5, 22: 2.5, 24: 3.0, 27: 3.0, 30: 3.5, 33: 3.5, 36: 4.0, 39: 4.0, 42: 4.5, 45: 4.5,
    48: 5.0, 52: 5.0, 56: 5.5, 60: 5.5, 64: 6.0,
}  # fmt: skip
"""Coarse pitches by nominal diameter, ISO 261."""
HOLE_MM = {3: 3.4, 4: 4.5, 5: 5.5, 6: 6.6, 7: 7.6, 8: 9, 10: 11, 12: 13.5, 14: 15.5, 16: 17.5, 18: 20, 20: 22}
"""Clearance holes, medium, ISO 273; those of other diameters are a tenth above the thread."""


@dataclass(frozen=True)
class Thread:
    """An ISO metric thread: nominal diameter and pitch, mm, and what ISO 724 makes of them."""

    diameter_mm: float
    pitch_mm: float

    @property
    def pitch_diameter_mm(self) -> float:
        """Return d2."""
        return self.diameter_mm - 0.75 * math.sqrt(0.75) * self.pitch_mm

    @property
    def core_diameter_mm(self) -> float:
        """Return d3 of the bolt."""
        return self.diameter_mm - 17 / 12 * math.sqrt(0.75) * self.pitch_mm

    @property
    def nut_core_diameter_mm(self) -> float:
        """Return D1 of the nut."""
        return self.diameter_mm - 1.25 * math.sqrt(0.75) * self.pitch_mm

    @property
    def stress_diameter_mm(self) -> float:
        """Return the diameter of the stress area, (d2 + d3) / 2."""
        return (self.pitch_diameter_mm + self.core_diameter_mm) / 2

    @property
    def stress_area_mm2(self) -> float:
        """Return the stress area of ISO 898-1."""
        return math.pi / 4 * self.stress_diameter_mm**2

    @property
    def core_area_mm2(self) -> float:
        """Return the area of the core, of diameter d3."""
        return math.pi / 4 * self.core_diameter_mm**2


@dataclass(frozen=True)
class BoltStrength:
    """Strengths of a class, MPa: tensile, yield (0.2 %), proof, and the endurance of Shigley's table 8-17."""

    ultimate_MPa: float
    yield_MPa: float
    proof_MPa: float
    endurance_MPa: float


StrengthClass = Literal["8.8", "9.8", "10.9", "12.9"]
_CLASSES = {
    "8.8": BoltStrength(800, 640, 580, 129),
    "9.8": BoltStrength(900, 720, 650, 140),
    "10.9": BoltStrength(1040, 940, 830, 162),
    "12.9": BoltStrength(1220, 1100, 970, 190),
}
_LARGE_8_8 = BoltStrength(830, 660, 600, 129)
_LARGEST_SMALL_MM = 16.0
LOST_TURNS = 0.8
"""Turns of engaged thread that carry nothing, VDI 2230 (5.6)."""
_NAME = re.compile(r"M(\d{1,2}(?:\.\d{1,3})?)(?:x(\d(?:\.\d{1,3})?))?")


def thread(name: str) -> Thread:
    """Return the thread of a name such as `M10` or `M10x1`; raises ValueError where it is none."""
    found = _NAME.fullmatch(name)
    diameter = float(found[1]) if found else 0.0
    pitch = float(found[2]) if found and found[2] else COARSE_PITCH_MM.get(int(diameter), 0.0)
    if diameter not in COARSE_PITCH_MM:
        known = ", ".join(map(str, COARSE_PITCH_MM))
        raise ValueError(f"must be such as M10 or M10x1; diameters known of ISO 261: {known} mm")
    least, coarse = 0.04 * diameter, COARSE_PITCH_MM[int(diameter)]
    if not least <= pitch <= coarse:
        raise ValueError(f"must have a pitch from {least:g} to {coarse:g} mm, the coarse one of ISO 261")
    return Thread(diameter, pitch)


def strength(strength_class: StrengthClass, nominal: Thread) -> BoltStrength:
    """Return the strengths of a class at a diameter, ISO 898-1."""
    large = strength_class == "8.8" and nominal.diameter_mm > _LARGEST_SMALL_MM
    return _LARGE_8_8 if large else _CLASSES[strength_class]


def _checked(name: str) -> str:
    try:
        thread(name)
    except ValueError as error:
        raise PydanticCustomError("thread", "{text}", {"text": str(error)}) from None
    return name


_Friction = Annotated[float, Field(ge=0.02, le=0.6, allow_inf_nan=False)]


class Bolt(SceneTable):
    """A bolt, what it clamps, and how it is tightened."""

    thread: Annotated[str, AfterValidator(_checked)] = Field(examples=["M10"])
    """ISO metric thread, such as `M10` (coarse) or `M10x1`."""
    strength_class: StrengthClass = Field(default="10.9", examples=["10.9"])
    """Strength class of ISO 898-1."""
    grip_mm: Length = Field(examples=[40.0])
    """Length that it clamps."""
    shank_mm: LengthOrZero = 0.0
    """Part of the grip without thread."""
    shank_diameter_mm: Length | None = Field(default=None, examples=[8.0])
    """Diameter of the shank; by default that of the thread."""
    held_in: Literal["tapped_hole", "nut"] = "tapped_hole"
    """Part that the thread is screwed into; `nut` is a through bolt."""
    engagement_mm: Length | None = Field(default=None, examples=[15.0])
    """Length of engaged thread; by default 1.5 diameters in a tapped hole, 0.8 in a nut."""
    head_diameter_mm: Length | None = Field(default=None, examples=[15.0])
    """Diameter of the bearing face of the head; by default 1.46 thread diameters."""
    hole_diameter_mm: Length | None = Field(default=None, examples=[11.0])
    """Hole that it runs through; by default the medium one of ISO 273."""
    member_diameter_mm: Length | None = Field(default=None, examples=[25.0])
    """Diameter of the clamped parts about it; by default wide enough for the whole cone of pressure, for
    `[rod.bolt]` what its boss holds."""
    thread_friction: _Friction = 0.12
    """Coefficient of friction in the thread."""
    head_friction: _Friction = 0.12
    """Coefficient of friction below the head."""
    tightening_factor: float = Field(default=1.6, ge=1, le=4, allow_inf_nan=False)
    """Largest over smallest preload by the scatter of tightening: 1.6 for a torque wrench, 1.2 by angle."""
    utilisation: float = Field(default=0.9, ge=0.1, le=1, allow_inf_nan=False)
    """Share of the yield strength that the largest preload takes with the torsion of tightening."""
    preload_N: Force | None = Field(default=None, examples=[30000.0])
    """Largest preload; by default that of the utilisation."""
    load_introduction: float = Field(default=0.5, ge=0, le=1, allow_inf_nan=False)
    """Factor n of VDI 2230 for where the load enters: 1 below head and nut, small at the split."""
    embedding_um: float = Field(default=8.0, ge=0, le=100, allow_inf_nan=False)
    """Settling of thread, head and split."""

    @property
    def nominal(self) -> Thread:
        """Return its thread."""
        return thread(self.thread)

    @property
    def shank_area_mm2(self) -> float:
        """Return the area of the shank."""
        return math.pi / 4 * (self.shank_diameter_mm or self.nominal.diameter_mm) ** 2

    @property
    def stressed_diameter_mm(self) -> float:
        """Return d0 of VDI 2230, the diameter of the stress area or of a thinner shank."""
        shank = self.shank_diameter_mm if self.shank_mm else None
        return min(self.nominal.stress_diameter_mm, shank or math.inf)

    @property
    def stressed_area_mm2(self) -> float:
        """Return the area of the weakest section."""
        return math.pi / 4 * self.stressed_diameter_mm**2

    @property
    def head_mm(self) -> float:
        """Return the diameter of the bearing face of the head."""
        return self.head_diameter_mm or 1.46 * self.nominal.diameter_mm

    @property
    def hole_mm(self) -> float:
        """Return the diameter of the hole."""
        diameter = self.nominal.diameter_mm
        return self.hole_diameter_mm or HOLE_MM.get(int(diameter), 1.1 * diameter)

    @property
    def engaged_mm(self) -> float:
        """Return the length of engaged thread."""
        factor = 0.8 if self.held_in == "nut" else 1.5
        return self.engagement_mm or factor * self.nominal.diameter_mm


def least_member_mm(bolt: Bolt) -> float:
    """Return the least diameter of the parts about a bolt that leaves them a section."""
    return 1.05 * bolt.hole_mm


class BoltedJoint(Bolt):
    """One bolt of a joint with its load, judged by `cranktopo bolts`; several stand as several tables.

    The clamped parts are of the design's material. The bolts of `[rod.bolt]` are judged there too.
    """

    name: str = Field(default="joint", pattern=r"^[A-Za-z0-9][A-Za-z0-9 ._-]*$", examples=["counterweight"])
    """Name in tables."""
    holds: Literal["web.counterweight"] | None = Field(default=None, examples=["web.counterweight"])
    """Part that it holds: `web.counterweight` is one with a density of its own, which pulls at the bolts
    outward with its centrifugal force at the highest speed of the engine."""
    bolts: int = Field(default=2, ge=1, le=64)
    """Number of bolts that share the force of what `holds` names, each along its axis."""
    places_mm: tuple[tuple[Place, Place], ...] = Field(default=(), max_length=64, examples=[[[12.0, 0.0]]])
    """Places of these bolts, x across the throw and z along the crank axis, from the middle of the
    counterweight's thickness; each with its mirror image in x. Their axes run along the throw. Bolts and
    their holes are drawn, exported and weighed; left out: there are no holes."""
    max_force_N: float | None = Field(
        default=None, ge=-1e9, le=1e9, allow_inf_nan=False, examples=[5000.0], json_schema_extra=SHOWN
    )
    """Largest force on one bolt along its axis; positive parts the joint. Left out where `holds` gives it."""
    min_force_N: float = Field(default=0.0, ge=-1e9, le=1e9, allow_inf_nan=False)
    """Smallest force on one bolt along its axis."""
    clamp_force_N: float = Field(default=0.0, ge=0, le=1e9, allow_inf_nan=False)
    """Force on the split that must remain, such as against sliding."""
    permitted_pressure_MPa: Strength | None = Field(default=None, examples=[850.0])
    """Largest pressure below the head; by default the tensile strength of the material."""
