"""Scene tables that describe the journals, the throw and the design envelope."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field
from typing_extensions import override

from cranktopo.base.errors import invalid
from cranktopo.base.polygons import Coordinates, polygon_section, self_intersection
from cranktopo.base.spans import Span, disc_section
from cranktopo.base.table import Length, LengthOrZero, Place, SceneTable
from cranktopo.throw.drilling.table import Drilling
from cranktopo.throw.feature import Feature
from cranktopo.throw.fillet import FilletSection


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
    fillet_axial_mm: Length | None = Field(default=None, examples=[4.0])
    """Makes the fillet an ellipse: its semi-axis along the crank, `fillet_mm` being that on the web's face;
    0.5 to 2.5 times `fillet_mm` and smaller than half the length. Left out, the fillet is round."""

    @property
    def radius_mm(self) -> float:
        """Outer radius, mm."""
        return self.outer_diameter_mm / 2

    @property
    def fillet(self) -> FilletSection:
        """Section of its fillets."""
        axial = self.fillet_mm if self.fillet_axial_mm is None else self.fillet_axial_mm
        return FilletSection(self.fillet_mm, axial)

    @property
    def bore_radius_mm(self) -> float:
        """Bore radius, mm (0 = solid)."""
        return self.bore_diameter_mm / 2


class ThrowTable(SceneTable):
    """Crank throw: radius and its two journals."""

    radius_mm: Length = Field(examples=[48.0])
    """Distance of the crankpin's axis from the crank axis: half the stroke."""
    main_journal: Journal
    """The main journal, centred on the crank axis."""
    crankpin: Journal
    """The crankpin, centred on the throw radius."""
    second_main_journal_length_mm: Length | None = Field(default=None, examples=[44.0])
    """Full length of the main journal beyond the second web, half of which is this throw's; by default that
    of `main_journal`."""
    second_crankpin_length_mm: Length | None = Field(default=None, examples=[38.0])
    """Twice the length of the crankpin from the cylinder's axis to the second web; by default the axis is in
    its middle, and it is `crankpin.length_mm`."""
    mirrored_web: Literal["first", "second"] | None = Field(default=None, examples=["first"])
    """The web of a throw with two different ones that this throw has twice: the half beyond the crankpin is
    taken as its mirror image. Written by `--web` of the optimisers; changes nothing but what is assumed."""
    drilling: tuple[Drilling, ...] = Field(default=(), max_length=8)

    @property
    def journals(self) -> tuple[tuple[Journal, float], tuple[Journal, float]]:
        """Main journal and crankpin, each with the place of its axis along the throw, mm."""
        return (self.main_journal, 0.0), (self.crankpin, self.radius_mm)

    def features(self) -> Iterator[tuple[str, Feature]]:
        """Each feature of journals and web together with its key path in the scene."""
        for index, drilling in enumerate(self.drilling):
            yield f"throw.drilling[{index}]", drilling


class Clearance(SceneTable):
    """What web and counterweight keep clear of while they turn, whatever the shape of the envelope.

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

    @property
    def stl_file(self) -> Path | None:
        """Mesh that bounds it; the others have one section and say themselves what it is."""
        return None

    @property
    def bounds_mm(self) -> tuple[float, float, float, float]:
        """Ranges that hold its section: (x_min, x_max, y_min, y_max)."""
        raise NotImplementedError

    def spans(self, y_mm: Coordinates, z_mm: Coordinates) -> Sequence[Span]:
        """Lateral intervals of its section, the same at all heights, at places along the throw, mm."""
        raise NotImplementedError

    @property
    def asymmetry(self) -> str:
        """Key of what is not symmetric in x, or not known to be; empty when it is."""
        return ""

    def check(self) -> None:
        """Refuse dimensions that hold nothing.

        Raises:
            CranktopoError: first inconsistency found.
        """


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
    def spans(self, y_mm: Coordinates, z_mm: Coordinates) -> Sequence[Span]:
        half = np.where((y_mm >= self.y_min_mm) & (y_mm <= self.y_max_mm), self.half_width_mm, 0.0)
        return [(-half, half)]

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
    def spans(self, y_mm: Coordinates, z_mm: Coordinates) -> Sequence[Span]:
        return disc_section(self.radius_mm)(y_mm, z_mm)


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
    def spans(self, y_mm: Coordinates, z_mm: Coordinates) -> Sequence[Span]:
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
    """Design space: the web region inside a closed body from a file, in the frame of `cranktopo.base.frames`.

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
