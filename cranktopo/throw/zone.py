"""Zones of a web that optimisers leave alone, or to which they are held: boxes, cylinders, bodies."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.spans import Span, disc_section
from cranktopo.base.table import Length, Place, SceneTable


class _Zone(SceneTable):
    z_min_mm: Place | None = Field(default=None, examples=[27.0])
    """Place along the crank axis where it begins, from the middle of the main journal; left out: at the web's
    journal face."""
    z_max_mm: Place | None = Field(default=None, examples=[35.0])
    """Place along the crank axis where it ends, from the middle of the main journal; left out: at the web's
    pin face."""

    @property
    def z_mm(self) -> tuple[float, float]:
        """Range along the crank axis; endless where it ends with the web."""
        low = -math.inf if self.z_min_mm is None else self.z_min_mm
        return low, math.inf if self.z_max_mm is None else self.z_max_mm

    @property
    def body_file(self) -> Path | None:
        """Body that it is; the others have one section and say themselves what it is."""
        return None

    @abstractmethod
    def mirrored(self) -> Self:
        """Its mirror image in x = 0."""

    def check(self) -> tuple[str, str] | None:
        """Return the key of a dimension that holds nothing, and what is allowed; None where all do."""
        if self.z_mm[0] >= self.z_mm[1]:
            return "z_max_mm", "must be above z_min_mm"
        return None


class BoxZone(_Zone):
    """Zone of the web inside a box along the axes of the throw."""

    shape: Literal["box"]
    x_min_mm: Place = Field(examples=[-10.0])
    """Left end across the throw, from the crank axis."""
    x_max_mm: Place = Field(examples=[10.0])
    """Right end across the throw."""
    y_min_mm: Place = Field(examples=[20.0])
    """Lower end along the throw, from the crank axis toward the crankpin."""
    y_max_mm: Place = Field(examples=[30.0])
    """Upper end along the throw."""

    def spans(self, y_mm: Array, z_mm: Array) -> Sequence[Span]:
        """Lateral intervals of its section within its heights, at places along the throw, mm."""
        inside = (y_mm >= self.y_min_mm) & (y_mm <= self.y_max_mm)
        start = np.full(inside.shape, self.x_min_mm)
        return [(start, np.where(inside, self.x_max_mm, start))]

    @override
    def mirrored(self) -> Self:
        return self.model_copy(update={"x_min_mm": 0.0 - self.x_max_mm, "x_max_mm": 0.0 - self.x_min_mm})

    @override
    def check(self) -> tuple[str, str] | None:
        for axis in "xy":
            if getattr(self, f"{axis}_min_mm") >= getattr(self, f"{axis}_max_mm"):
                return f"{axis}_max_mm", f"must be above {axis}_min_mm"
        return super().check()


class CylinderZone(_Zone):
    """Zone of the web inside a cylinder along the crank axis."""

    shape: Literal["cylinder"]
    x_mm: Place = 0.0
    """Its axis across the throw, from the crank axis."""
    y_mm: Place = Field(examples=[24.0])
    """Its axis along the throw, from the crank axis toward the crankpin."""
    diameter_mm: Length = Field(examples=[20.0])
    """Diameter."""

    def spans(self, y_mm: Array, z_mm: Array) -> Sequence[Span]:
        """Lateral intervals of its section within its heights, at places along the throw, mm."""
        ((left, right),) = disc_section(self.diameter_mm / 2, self.y_mm)(y_mm, z_mm)
        return [(self.x_mm + left, self.x_mm + right)]

    @override
    def mirrored(self) -> Self:
        return self.model_copy(update={"x_mm": 0.0 - self.x_mm})


class BodyZone(_Zone):
    """Zone of the web inside a closed body from a file, in the frame of the design."""

    shape: Literal["body"]
    file: str = Field(examples=["zone.step"])
    """STL in mm or STEP of one body, z along the crank and y along the throw; relative to this file."""
    symmetric: bool = False
    """The body is its own mirror image in x = 0."""

    @property
    @override
    def body_file(self) -> Path:
        return Path(self.file)

    @override
    def mirrored(self) -> Self:
        return self if self.symmetric else self.model_copy(update={"file": f"mirror image of {self.file}"})


Zone = Annotated[BoxZone | CylinderZone | BodyZone, Field(discriminator="shape")]


def zones_asymmetry(frozen: Sequence[Zone], removable: Sequence[Zone]) -> str:
    """Key of the first zone without its mirror image in x = 0; empty where all have one."""
    for name, zones in (("frozen", frozen), ("removable", removable)):
        for index, zone in enumerate(zones):
            if zone.mirrored() not in zones:
                return f"envelope.{name}[{index}]"
    return ""
