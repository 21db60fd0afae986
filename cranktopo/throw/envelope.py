"""The design envelope: its tables, sections, checks, and how far points lie outside."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.errors import invalid
from cranktopo.base.spans import Span, disc_section, polygon_section, self_intersection
from cranktopo.base.table import Length, LengthOrZero, Place, SceneTable
from cranktopo.throw.zone import Zone


class Clearance(SceneTable):
    """Room that web and counterweight keep free while they turn, whatever the shape of the envelope.

    Rods beside the web are kept clear of by `envelope.rod_clearance_mm`.
    """

    piston_skirt_mm: LengthOrZero | None = Field(default=None, examples=[38.0])
    """Distance from the piston pin down to the lower edge of the skirt, which comes nearest at bottom dead
    centre; needs `engine.bore_mm` and `engine.rod_length_mm`."""
    crankcase_radius_mm: Length | None = Field(default=None, examples=[85.0])
    """Inner radius of the crankcase about the crank axis."""
    least_gap_mm: LengthOrZero = 1.0
    """Gap that stays to each of them, along the radius to the crankcase, along the cylinder to the piston."""


class _EnvelopeBase(SceneTable):
    clearance: Clearance | None = None
    bearing_clearance_mm: LengthOrZero = 0.0
    """Kept free of material beside the main bearing, along the crank axis."""
    rod_clearance_mm: LengthOrZero = 0.0
    """Kept free of material beside the connecting rod, along the crank axis."""
    frozen: tuple[Zone, ...] = ()
    """Zones in which the web stays as it is: no optimiser takes material away or adds any."""
    removable: tuple[Zone, ...] = ()
    """Zones in which alone material of the web may be taken away; left out: everywhere. What lies beside the
    web may be filled as ever."""

    @property
    def stl_file(self) -> Path | None:
        """Mesh that bounds it; the others have one section and say themselves what it is."""
        return None

    @property
    def bounds_mm(self) -> tuple[float, float, float, float]:
        """Ranges that hold its section: (x_min, x_max, y_min, y_max)."""
        raise NotImplementedError

    def spans(self, y_mm: Array, z_mm: Array) -> Sequence[Span]:
        """Lateral intervals of its section, the same at all heights, at places along the throw, mm."""
        raise NotImplementedError

    @property
    def asymmetry(self) -> str:
        """Key of what is not symmetric in x, or not known to be; empty when it is."""
        return ""

    def outside_mm(self, points: Array) -> tuple[Array, Array] | None:
        """Return how far points (n, 2) with x >= 0 lie outside each side; None without a closed form.

        Returns:
            Excesses (sides, n), mm, and their derivatives by each point (sides, n, 2).
        """
        return None

    def check(self) -> None:
        """Refuse dimensions that hold nothing."""


class BoxEnvelope(_EnvelopeBase):
    """Design space: the web region inside a box, symmetric in x."""

    shape: Literal["box"]
    half_width_mm: Length = Field(examples=[48.0])
    """Half of its width across the throw."""
    y_min_mm: Place = Field(examples=[-34.0])
    """Lower end along the throw."""
    y_max_mm: Place = Field(examples=[82.0])
    """Upper end along the throw; above `y_min_mm`."""

    @property
    @override
    def bounds_mm(self) -> tuple[float, float, float, float]:
        return -self.half_width_mm, self.half_width_mm, self.y_min_mm, self.y_max_mm

    @override
    def spans(self, y_mm: Array, z_mm: Array) -> Sequence[Span]:
        half = np.where((y_mm >= self.y_min_mm) & (y_mm <= self.y_max_mm), self.half_width_mm, 0.0)
        return [(-half, half)]

    @override
    def outside_mm(self, points: Array) -> tuple[Array, Array]:
        _, wide, low, high = self.bounds_mm
        outside = np.stack([points[:, 0] - wide, low - points[:, 1], points[:, 1] - high])
        unit = np.array([[1.0, 0.0], [0.0, -1.0], [0.0, 1.0]])
        return outside, np.broadcast_to(unit[:, None, :], (3, *points.shape))

    @override
    def check(self) -> None:
        if self.y_max_mm <= self.y_min_mm:
            allowed = f"must be above y_min_mm = {self.y_min_mm:g} mm"
            raise invalid("envelope.y_max_mm", self.y_max_mm, allowed)


class CylinderEnvelope(_EnvelopeBase):
    """Design space: the web region inside a cylinder around the crank axis."""

    shape: Literal["cylinder"]
    radius_mm: Length = Field(examples=[82.0])
    """Its radius."""

    @property
    @override
    def bounds_mm(self) -> tuple[float, float, float, float]:
        return -self.radius_mm, self.radius_mm, -self.radius_mm, self.radius_mm

    @override
    def spans(self, y_mm: Array, z_mm: Array) -> Sequence[Span]:
        return disc_section(self.radius_mm)(y_mm, z_mm)

    @override
    def outside_mm(self, points: Array) -> tuple[Array, Array]:
        reach = np.hypot(points[:, 0], points[:, 1])
        return (reach - self.radius_mm)[None], (points / np.maximum(reach, 1e-12)[:, None])[None]


class OutlineEnvelope(_EnvelopeBase):
    """Design space: the web region inside a closed polygon of (x, y) points."""

    shape: Literal["outline"]
    points_mm: tuple[tuple[Place, Place], ...] = Field(
        min_length=3, max_length=2000, examples=[((-40.0, -30.0), (40.0, -30.0), (40.0, 80.0), (-40.0, 80.0))]
    )
    """Corners (x, y) of the polygon, in order."""

    @property
    @override
    def bounds_mm(self) -> tuple[float, float, float, float]:
        x, y = zip(*self.points_mm, strict=True)
        return min(x), max(x), min(y), max(y)

    @override
    def spans(self, y_mm: Array, z_mm: Array) -> Sequence[Span]:
        return polygon_section([np.array(self.points_mm)])(y_mm, z_mm)

    @override
    def check(self) -> None:
        points = np.array(self.points_mm)
        closed = len(points) > 3 and (points[0] == points[-1]).all()
        crossed_at = self_intersection(points[:-1] if closed else points)
        if crossed_at is not None:
            x, y = crossed_at
            raise invalid(
                "envelope.points_mm",
                self.points_mm,
                f"the polygon crosses or touches itself at ({x:.6g}, {y:.6g}) mm",
                "Give its corners in order, each once.",
            )

    @property
    @override
    def asymmetry(self) -> str:
        points = {(round(x, 9), round(y, 9)) for x, y in self.points_mm}
        return "" if points == {(round(-x, 9) + 0.0, y) for x, y in points} else "envelope.points_mm"


class StlEnvelope(_EnvelopeBase):
    """Design space: the web region inside a closed body from a file, in the frame of the design.

    With `symmetric` the body is its own mirror image in x = 0, which is checked, and half of it is enough.
    """

    shape: Literal["stl"]
    file: str = Field(examples=["envelope.stl"])
    """STL in mm or STEP of one body, z along the crank and y along the throw; relative to this file."""
    symmetric: bool = False
    """The body is its own mirror image in x = 0 (checked to 0.05 % of its volume)."""

    @property
    @override
    def stl_file(self) -> Path:
        return Path(self.file)

    @property
    @override
    def asymmetry(self) -> str:
        return "" if self.symmetric else "envelope (a file, not said to be symmetric)"


Envelope = Annotated[
    BoxEnvelope | CylinderEnvelope | OutlineEnvelope | StlEnvelope, Field(discriminator="shape")
]
