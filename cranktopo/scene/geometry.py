"""Scene tables that describe the throw, the web and the design envelope."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field

from cranktopo.scene.base import Length, LengthOrZero, Place, SceneTable


class Journal(SceneTable):
    """A main journal or crankpin: a cylinder with an axial bore (0 = solid) and a fillet (0 = sharp)."""

    outer_diameter_mm: Length = Field(examples=[42.0])
    """Outer diameter."""
    bore_diameter_mm: LengthOrZero = 0.0
    """Diameter of the axial bore, which runs on through the web; 0 = solid."""
    length_mm: Length = Field(examples=[38.0])
    """Full length between the webs; the half throw has half of it."""
    fillet_mm: LengthOrZero = 0.0
    """Radius of the fillet to the web; 0 = sharp. Smaller than half the length."""

    @property
    def radius_mm(self) -> float:
        """Outer radius, mm."""
        return self.outer_diameter_mm / 2

    @property
    def bore_radius_mm(self) -> float:
        """Bore radius, mm (0 = solid)."""
        return self.bore_diameter_mm / 2


class Throw(SceneTable):
    """Crank throw: radius and its two journals."""

    radius_mm: Length = Field(examples=[48.0])
    """Distance of the crankpin's axis from the crank axis: half the stroke."""
    main_journal: Journal
    """The main journal, centred on the crank axis."""
    crankpin: Journal
    """The crankpin, centred on the throw radius."""

    @property
    def journals(self) -> tuple[tuple[Journal, float], tuple[Journal, float]]:
        """Main journal and crankpin, each with the place of its axis along the throw, mm."""
        return (self.main_journal, 0.0), (self.crankpin, self.radius_mm)


class CylinderPocket(SceneTable):
    """Cylindrical pocket with its axis parallel to the crank axis."""

    shape: Literal["cylinder"]
    face: Literal["through", "journal", "pin"] = "through"
    """Web face that it starts from; `through` = a hole through the web."""
    x_mm: Place = 0.0
    """Centre across the throw, from the crank axis."""
    y_mm: Place = Field(examples=[24.0])
    """Centre along the throw, from the crank axis toward the crankpin."""
    diameter_mm: Length = Field(examples=[6.0])
    """Diameter."""
    depth_mm: Length | None = Field(default=None, examples=[5.0])
    """Depth below the face; needed unless it goes through."""


class SidePocket(SceneTable):
    """Slot cut from both lateral faces, symmetric in x.

    Length and height are those of its floor, the innermost face; its walls open outward by the draft angle.
    Its middle lies `offset_mm` from the web's mid-plane toward the pin.
    """

    shape: Literal["side"]
    y_mm: Place = Field(examples=[24.0])
    """Centre along the throw, from the crank axis toward the crankpin."""
    length_mm: Length = Field(examples=[20.0])
    """Length of its floor along the throw; longer than the outline: a groove that runs out at both ends."""
    height_mm: Length = Field(examples=[8.0])
    """Height of its floor along the crank axis."""
    depth_mm: Length = Field(examples=[5.0])
    """Depth of its floor below the largest half-width of the web."""
    offset_mm: Place = 0.0
    """Distance of its middle from the web's mid-plane, toward the pin."""
    draft_deg: float = Field(default=0.0, ge=0, le=60)
    """Draft angle: the walls open outward by it."""

    @property
    def slope(self) -> float:
        """How much each wall opens per mm toward the side."""
        return math.tan(math.radians(self.draft_deg))


class BoxPocket(SceneTable):
    """Box-shaped pocket cut from one web face."""

    shape: Literal["box"]
    face: Literal["journal", "pin"] = Field(examples=["pin"])
    """Web face that it starts from."""
    x_mm: Place = 0.0
    """Centre across the throw, from the crank axis."""
    y_mm: Place = Field(examples=[0.0])
    """Centre along the throw, from the crank axis toward the crankpin."""
    size_x_mm: Length = Field(examples=[10.0])
    """Size across the throw."""
    size_y_mm: Length = Field(examples=[10.0])
    """Size along the throw."""
    depth_mm: Length = Field(examples=[4.0])
    """Depth below the face."""


Pocket = Annotated[CylinderPocket | SidePocket | BoxPocket, Field(discriminator="shape")]


class EndBevel(SceneTable):
    """Bevel across one end of the web, on the face that carries no journal there.

    On the journal face it takes off the crankpin's end of the web, on the pin face the main journal's. It
    starts at `y_mm` on its face and reaches `depth_mm` below that face at the very end of the outline; it is
    straight across the web, and along the throw an arc that rises `crown_mm` over its chord (0 = plane).
    """

    face: Literal["journal", "pin"] = Field(examples=["journal"])
    """Face that it is cut from: `journal` bevels the crankpin's end of the web, `pin` the main journal's."""
    y_mm: Place = Field(examples=[60.0])
    """Where it meets that face, along the throw from the crank axis."""
    depth_mm: Length = Field(examples=[8.0])
    """Depth below that face at the very end of the outline; smaller than the web's thickness."""
    crown_mm: LengthOrZero = 0.0
    """Rise of its arc over the chord; 0 = plane."""


class _WebBase(SceneTable):
    thickness_mm: Length = Field(examples=[19.0])
    """Thickness along the crank axis."""
    bevel: tuple[EndBevel, ...] = Field(default=(), max_length=2)
    pocket: tuple[Pocket, ...] = ()
    """What is taken out of the outline's solid; `shape` chooses the kind."""


class ObroundWeb(_WebBase):
    """Slot-shaped web: both round ends centred on the axes."""

    outline: Literal["obround"]
    width_mm: Length = Field(examples=[50.0])
    """Width across the throw."""


class RectangleWeb(_WebBase):
    """Rectangular web reaching `overhang_mm` beyond each axis."""

    outline: Literal["rectangle"]
    width_mm: Length = Field(examples=[50.0])
    """Width across the throw."""
    overhang_mm: Length = Field(examples=[25.0])
    """Length beyond each axis."""
    corner_radius_mm: LengthOrZero = 0.0
    """Radius of the corners."""


class EllipseWeb(_WebBase):
    """Elliptical web centred half-way between the axes."""

    outline: Literal["ellipse"]
    semi_axis_throw_mm: Length = Field(examples=[50.0])
    """Semi-axis along the throw."""
    semi_axis_lateral_mm: Length = Field(examples=[32.0])
    """Semi-axis across the throw."""


class TaperedWeb(_WebBase):
    """Convex hull of a circle on the crank axis and a circle on the pin axis."""

    outline: Literal["tapered"]
    main_radius_mm: Length = Field(examples=[32.0])
    """Radius of the circle on the crank axis."""
    pin_radius_mm: Length = Field(examples=[25.0])
    """Radius of the circle on the pin axis."""


class ProfileWeb(_WebBase):
    """Half-widths at stations along the throw, joined by a curve of continuous curvature.

    A half-width of 0 at an end closes the outline with a round end.
    """

    outline: Literal["profile"]
    stations_mm: tuple[Place, ...] = Field(
        min_length=3, examples=[(-24.0, -15.0, 5.0, 24.0, 45.0, 64.0, 72.0)]
    )
    """Places along the throw from the crank axis, increasing."""
    half_widths_mm: tuple[LengthOrZero, ...] = Field(
        min_length=3, examples=[(0.0, 19.0, 31.0, 34.0, 30.0, 19.0, 0.0)]
    )
    """Half-width at each station; 0 at an end makes that end round."""

    @property
    def round_ends(self) -> tuple[bool, bool]:
        """Whether the lower and the upper end are round and not cut straight across."""
        return self.half_widths_mm[0] == 0, self.half_widths_mm[-1] == 0


Web = Annotated[
    ObroundWeb | RectangleWeb | EllipseWeb | TaperedWeb | ProfileWeb, Field(discriminator="outline")
]


class _EnvelopeBase(SceneTable):
    bearing_clearance_mm: LengthOrZero = 0.0
    """Kept free of material beside the main bearing, along the crank axis."""
    rod_clearance_mm: LengthOrZero = 0.0
    """Kept free of material beside the connecting rod, along the crank axis."""


class BoxEnvelope(_EnvelopeBase):
    """Design space: the web slab inside a box, symmetric in x."""

    shape: Literal["box"]
    half_width_mm: Length = Field(examples=[48.0])
    """Half of its width across the throw."""
    y_min_mm: Place = Field(examples=[-34.0])
    """Lower end along the throw."""
    y_max_mm: Place = Field(examples=[82.0])
    """Upper end along the throw; above `y_min_mm`."""


class CylinderEnvelope(_EnvelopeBase):
    """Design space: the web slab inside a cylinder around the crank axis."""

    shape: Literal["cylinder"]
    radius_mm: Length = Field(examples=[82.0])
    """Its radius."""


class OutlineEnvelope(_EnvelopeBase):
    """Design space: the web slab inside a closed polygon of (x, y) points."""

    shape: Literal["outline"]
    points_mm: tuple[tuple[Place, Place], ...] = Field(
        min_length=3, examples=[((-40.0, -30.0), (40.0, -30.0), (40.0, 80.0), (-40.0, 80.0))]
    )
    """Corners (x, y) of the polygon, in order."""


class StlEnvelope(_EnvelopeBase):
    """Design space: the web slab inside a closed body from a file, in the frame of `cranktopo.frames`.

    With `symmetric` the body is its own mirror image in x = 0, which is checked, and half of it is enough.
    """

    shape: Literal["stl"]
    file: str = Field(examples=["envelope.stl"])
    """STL in mm or STEP of one body, z along the crank and y along the throw; relative to this file."""
    symmetric: bool = False
    """The body is its own mirror image in x = 0 (checked to 0.05 % of its volume)."""


Envelope = Annotated[
    BoxEnvelope | CylinderEnvelope | OutlineEnvelope | StlEnvelope, Field(discriminator="shape")
]
