"""Scene tables of the connecting rod: both eyes, shank, cap, bush, bolts, and the piston pin."""

from __future__ import annotations

from typing import Annotated, Literal, get_args

from pydantic import Field

from cranktopo.base.table import SHOWN, Length, LengthOrZero, SceneTable
from cranktopo.design.bolt import Bolt, least_member_mm
from cranktopo.design.material import Material

Eye = Literal["small", "big"]
EYES: tuple[Eye, ...] = get_args(Eye)
_Ovalisation = Annotated[float, Field(ge=0.01, le=1000, allow_inf_nan=False)]


class RodBolt(Bolt):
    """One of the two bolts of the cap; its head lies on the cap."""

    grip_mm: Length = Field(examples=[14.0])
    """Length that it clamps: at least the boss of the cap; that of a through bolt is the height of both."""


class PistonPin(SceneTable):
    """The piston pin; it fills the bush, or the bore of the small end where there is none."""

    bore_diameter_mm: LengthOrZero = Field(examples=[13.0])
    """Bore of the pin; 0 is solid."""
    length_mm: Length = Field(examples=[78.0])
    """Length of the pin."""
    boss_distance_mm: Length = Field(examples=[30.0])
    """Distance between the inner faces of the piston's bosses."""
    E_GPa: float = Field(default=210.0, ge=1, le=1000, allow_inf_nan=False)
    """Young's modulus of the pin."""


class Rod(SceneTable):
    """The connecting rod, for `cranktopo rod`: its masses replace those of the rod in `[engine.masses]`.

    Both eyes are rings in the plane of motion, the split goes through the axis of the big end, the shank
    tapers from one eye to the other. Its length is `engine.rod_length_mm`.
    """

    small_end_diameter_mm: Length = Field(examples=[34.0])
    """Outer diameter of the small end."""
    small_end_bore_mm: Length = Field(examples=[24.0])
    """Bore of the small end, without its bush."""
    small_end_width_mm: Length = Field(examples=[28.0])
    """Width of the small end along the piston pin."""
    bush_thickness_mm: LengthOrZero = 0.0
    """Wall of the bush; 0 for none."""
    bush_interference_um: float = Field(default=0.0, ge=0, le=1000, allow_inf_nan=False)
    """Diameter of the bush over that of its bore before it is pressed in, heat included."""
    bush_E_GPa: float = Field(default=115.0, ge=1, le=1000, allow_inf_nan=False)
    """Young's modulus of the bush; the default is that of bronze."""
    bush_density_kg_m3: float = Field(default=8800.0, ge=100, le=30000, allow_inf_nan=False)
    """Density of the bush."""
    big_end_diameter_mm: Length = Field(examples=[62.0])
    """Outer diameter of big end and cap."""
    big_end_bore_mm: Length = Field(examples=[46.0])
    """Bore of the big end, without its shells."""
    big_end_width_mm: Length = Field(examples=[26.0])
    """Width of the big end along the crankpin."""
    shells_kg: float = Field(default=0.0, ge=0, le=1e4, allow_inf_nan=False)
    """Both bearing shells together."""
    boss_width_mm: Length = Field(examples=[78.0])
    """Distance of the outer faces of the bosses of both bolts."""
    boss_above_mm: Length = Field(examples=[16.0])
    """Height of the bosses above the split, toward the small end."""
    boss_below_mm: Length = Field(examples=[14.0])
    """Height of the bosses of the cap."""
    bolt_distance_mm: Length = Field(examples=[62.0])
    """Distance of the axes of both bolts."""
    split_angle_deg: float = Field(default=0.0, ge=0, le=60, allow_inf_nan=False, examples=[45.0])
    """Angle between the split and the plane square to the rod's axis; bosses and bolts are turned with it.
    0 is a square split. The shank must stay on the rod's side of the split."""
    split_friction: float = Field(default=0.15, ge=0.02, le=0.6, allow_inf_nan=False)
    """Coefficient of friction in an oblique split; the default is that of clean steel on steel."""
    shank: Literal["I", "H", "plain"] = Field(default="I", examples=["I"])
    """Section of the shank: `I` has its flanges on both sides in the plane of motion and its pockets toward
    the crank's axis, `H` is turned by a right angle, `plain` is a rectangle."""
    shank_small_mm: Length = Field(examples=[18.0])
    """Height of the shank in the plane of motion, at the axis of the small end."""
    shank_big_mm: Length = Field(examples=[24.0])
    """Height of the shank in the plane of motion, at the axis of the big end."""
    shank_width_mm: Length = Field(examples=[14.0])
    """Width of the shank along the pins."""
    flange_mm: Length = Field(default=3.0, examples=[3.0], json_schema_extra=SHOWN)
    """Thickness of the flanges of `I` and `H`."""
    web_mm: Length = Field(default=3.0, examples=[3.0], json_schema_extra=SHOWN)
    """Thickness of the web of `I` and `H`."""
    shank_fillet_mm: LengthOrZero = 0.0
    """Radius between shank and both eyes in the plane of motion."""
    oil_hole_mm: LengthOrZero = 0.0
    """Diameter of an oil hole from eye to eye; 0 for none."""
    small_end_ovalisation_um: _Ovalisation | None = Field(default=None, examples=[10.0])
    """Permitted ovalisation of the small end: change of its bore's diameter under the largest pull. By
    default there is no limit; usual is half of the pin's clearance."""
    big_end_ovalisation_um: _Ovalisation | None = Field(default=None, examples=[25.0])
    """Permitted ovalisation of the big end; by default half of the big-end bearing's clearance in
    `[bearings]`, without that table there is no limit."""
    material: Material | None = None
    """Material of rod and cap; by default that of the crankshaft."""
    bolt: RodBolt | None = None
    """Each of the two bolts of the cap; its head lies on the cap. Its `member_diameter_mm` is by default that
    of the largest cylinder about it within the joint face: between bore and boss, and across the big end."""
    pin: PistonPin | None = None

    @property
    def pin_diameter_mm(self) -> float:
        """Return the diameter of the piston pin."""
        return self.small_end_bore_mm - 2 * self.bush_thickness_mm

    @property
    def bolt_hole_mm(self) -> float:
        """Return the diameter of the holes of the bolts; 0 where no bolt is given."""
        return self.bolt.hole_mm if self.bolt else 0.0

    @property
    def clamping_bolt(self) -> RodBolt | None:
        """Return the bolt with the diameter of the parts that it clamps: its own, or that of its boss."""
        if self.bolt is None or self.bolt.member_diameter_mm is not None:
            return self.bolt
        edges = (
            (self.boss_width_mm - self.bolt_distance_mm) / 2,
            (self.bolt_distance_mm - self.big_end_bore_mm) / 2,
            self.big_end_width_mm / 2,
        )
        member = max(2 * min(edges), least_member_mm(self.bolt))
        return self.bolt.model_copy(update={"member_diameter_mm": member})
