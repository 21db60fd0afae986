"""Round pocket with its axis parallel to the crank axis, from a web face or right through."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import Field
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.errors import invalid
from cranktopo.base.table import Length, Place
from cranktopo.throw.face_pocket import FacePocket
from cranktopo.throw.feature import Body
from cranktopo.throw.fitted import Named, Region
from cranktopo.throw.fitted_pocket import FittedPocket
from cranktopo.throw.hole import RoundHole, check_depth, depth_range_mm
from cranktopo.throw.primitives import Circle, FeatureDrawing, number_lines

if TYPE_CHECKING:
    from cranktopo.throw.throw_view import ThrowView

_TINY = 1e-12


class CylinderPocket(FacePocket):
    """Cylindrical pocket with its axis parallel to the crank axis."""

    shape: Literal["cylinder"]
    face: Literal["through", "journal", "pin"] = "through"
    """Web face that it starts from; `through` = a hole through the web."""
    y_mm: Place = Field(examples=[24.0])
    """Centre along the throw, from the crank axis toward the crankpin."""
    diameter_mm: Length = Field(examples=[6.0])
    """Diameter."""
    depth_mm: Length | None = Field(default=None, examples=[5.0])
    """Depth below the face; needed unless it goes through."""

    @override
    def bodies(self, scene: ThrowView, key: str) -> tuple[Body, ...]:
        z_mm = depth_range_mm(scene, self.face, self.depth_mm)
        return (RoundHole(key, z_mm, self.x_mm, self.y_mm, self.diameter_mm / 2),)

    @override
    def check_alone(self, scene: ThrowView, key: str) -> None:
        if (self.depth_mm is None) != (self.face == "through"):
            if self.depth_mm is None:
                allowed, hint = f"is missing with face = {self.face!r}", "Give it, or face = 'through'."
            else:
                allowed, hint = "has no meaning with face = 'through'", "Remove it, or name another face."
            raise invalid(f"{key}.depth_mm", self.depth_mm, allowed, hint)
        if self.depth_mm is not None:
            check_depth(scene, f"{key}.depth_mm", self.depth_mm)

    @override
    def drawing(self, scene: ThrowView) -> FeatureDrawing:
        centre, hidden = (self.x_mm, self.y_mm), self.face == "journal"
        numbers = self.model_dump(exclude={"shape", "face"}, exclude_none=True)
        return FeatureDrawing(
            front=(Circle(centre, self.diameter_mm / 2, hidden, f"⌀{self.diameter_mm:g}"),),
            lines=number_lines(f"POCKET {self.shape}, {self.face}", numbers),
        )


class FittedCylinder(FittedPocket):
    """A cylinder pocket of the re-model."""

    shape: ClassVar[str] = "cylinder"
    sizes: ClassVar[tuple[str, ...]] = ("diameter",)

    @classmethod
    @override
    def in_region(cls, region: Region) -> Self | None:
        if region.kind == "window":
            return cls("through", region.pair)
        return None if region.face is None else cls(region.face, region.pair)

    @override
    def walls_mm(self, named: Named, across: Array, along: Array) -> list[Array]:
        return [np.sqrt(across**2 + along**2 + _TINY) - named["diameter"] / 2]

    @override
    def gap_mm(self, named: Named, x_mm: Any, y_mm: Any) -> Any:
        across, along = x_mm - named.get("x", 0.0), y_mm - named["y"]
        return np.sqrt(across**2 + along**2 + _TINY) - named["diameter"] / 2

    @override
    def size_guess(self, area_mm2: float, across_mm: float, along_mm: float) -> list[float]:
        return [2 * float(np.sqrt(area_mm2 / np.pi))]
