"""Scene tables that describe the throw, the web and the design envelope."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field

from cranktopo.scene.base import Finite, NonNegative, Positive, SceneTable


class Journal(SceneTable):
    """A main journal or crankpin: a cylinder with an axial bore (0 = solid) and a fillet (0 = sharp)."""

    outer_diameter_mm: Positive
    bore_diameter_mm: NonNegative = 0.0
    length_mm: Positive
    fillet_mm: NonNegative = 0.0

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

    radius_mm: Positive
    main_journal: Journal
    crankpin: Journal

    @property
    def journals(self) -> tuple[tuple[Journal, float], tuple[Journal, float]]:
        """Main journal and crankpin, each with the place of its axis along the throw, mm."""
        return (self.main_journal, 0.0), (self.crankpin, self.radius_mm)


class CylinderPocket(SceneTable):
    """Cylindrical pocket with its axis parallel to the crank axis."""

    shape: Literal["cylinder"]
    face: Literal["through", "journal", "pin"] = "through"
    x_mm: Finite = 0.0
    y_mm: Finite
    diameter_mm: Positive
    depth_mm: Positive | None = None


class SidePocket(SceneTable):
    """Slot cut from both lateral faces, symmetric in x.

    Length and height are those of its floor, the innermost face; its walls open outward by the draft angle.
    Its middle lies `offset_mm` from the web's mid-plane toward the pin.
    """

    shape: Literal["side"]
    y_mm: Finite
    length_mm: Positive
    height_mm: Positive
    depth_mm: Positive
    offset_mm: Finite = 0.0
    draft_deg: float = Field(default=0.0, ge=0, le=60)

    @property
    def slope(self) -> float:
        """How much each wall opens per mm toward the side."""
        return math.tan(math.radians(self.draft_deg))


class BoxPocket(SceneTable):
    """Box-shaped pocket cut from one web face."""

    shape: Literal["box"]
    face: Literal["journal", "pin"]
    x_mm: Finite = 0.0
    y_mm: Finite
    size_x_mm: Positive
    size_y_mm: Positive
    depth_mm: Positive


Pocket = Annotated[CylinderPocket | SidePocket | BoxPocket, Field(discriminator="shape")]


class EndBevel(SceneTable):
    """Bevel across one end of the web, on the face that carries no journal there.

    On the journal face it takes off the crankpin's end of the web, on the pin face the main journal's. It
    starts at `y_mm` on its face and reaches `depth_mm` below that face at the very end of the outline; it is
    straight across the web, and along the throw an arc that rises `crown_mm` over its chord (0 = plane).
    """

    face: Literal["journal", "pin"]
    y_mm: Finite
    depth_mm: Positive
    crown_mm: NonNegative = 0.0


class _WebBase(SceneTable):
    thickness_mm: Positive
    bevel: tuple[EndBevel, ...] = Field(default=(), max_length=2)
    pocket: tuple[Pocket, ...] = ()


class ObroundWeb(_WebBase):
    """Slot-shaped web: both round ends centred on the axes."""

    outline: Literal["obround"]
    width_mm: Positive


class RectangleWeb(_WebBase):
    """Rectangular web reaching `overhang_mm` beyond each axis."""

    outline: Literal["rectangle"]
    width_mm: Positive
    overhang_mm: Positive
    corner_radius_mm: NonNegative = 0.0


class EllipseWeb(_WebBase):
    """Elliptical web centred half-way between the axes."""

    outline: Literal["ellipse"]
    semi_axis_throw_mm: Positive
    semi_axis_lateral_mm: Positive


class TaperedWeb(_WebBase):
    """Convex hull of a circle on the crank axis and a circle on the pin axis."""

    outline: Literal["tapered"]
    main_radius_mm: Positive
    pin_radius_mm: Positive


class ProfileWeb(_WebBase):
    """Half-widths at stations along the throw direction, joined by a curve of continuous curvature.

    A half-width of 0 at an end closes the outline with a round end.
    """

    outline: Literal["profile"]
    stations_mm: tuple[Finite, ...] = Field(min_length=3)
    half_widths_mm: tuple[NonNegative, ...] = Field(min_length=3)

    @property
    def round_ends(self) -> tuple[bool, bool]:
        """Whether the lower and the upper end are round and not cut straight across."""
        return self.half_widths_mm[0] == 0, self.half_widths_mm[-1] == 0


Web = Annotated[
    ObroundWeb | RectangleWeb | EllipseWeb | TaperedWeb | ProfileWeb, Field(discriminator="outline")
]


class _EnvelopeBase(SceneTable):
    bearing_clearance_mm: NonNegative = 0.0
    rod_clearance_mm: NonNegative = 0.0


class BoxEnvelope(_EnvelopeBase):
    """Design space: the web slab inside a box, symmetric in x."""

    shape: Literal["box"]
    half_width_mm: Positive
    y_min_mm: Finite
    y_max_mm: Finite


class CylinderEnvelope(_EnvelopeBase):
    """Design space: the web slab inside a cylinder around the crank axis."""

    shape: Literal["cylinder"]
    radius_mm: Positive


class OutlineEnvelope(_EnvelopeBase):
    """Design space: the web slab inside a closed polygon of (x, y) points."""

    shape: Literal["outline"]
    points_mm: tuple[tuple[Finite, Finite], ...] = Field(min_length=3)


class StlEnvelope(_EnvelopeBase):
    """Design space: the web slab inside a closed surface mesh, mm, in the frame of `cranktopo.frames`.

    With `symmetric` the mesh is its own mirror image in x = 0, which is checked, and half of it is enough.
    """

    shape: Literal["stl"]
    file: str
    symmetric: bool = False


Envelope = Annotated[
    BoxEnvelope | CylinderEnvelope | OutlineEnvelope | StlEnvelope, Field(discriminator="shape")
]
