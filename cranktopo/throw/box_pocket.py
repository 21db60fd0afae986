"""Rectangular pocket from a web face."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import Field
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.table import Length, Place
from cranktopo.throw.face_pocket import FacePocket
from cranktopo.throw.feature import Body
from cranktopo.throw.fitted import Named, Region
from cranktopo.throw.fitted_pocket import FittedPocket
from cranktopo.throw.hole import RectangularHole, check_depth, depth_range_mm
from cranktopo.throw.primitives import FeatureDrawing, Polyline, number_lines

if TYPE_CHECKING:
    from cranktopo.throw.throw_view import ThrowView

_TINY = 1e-12


class BoxPocket(FacePocket):
    """Box-shaped pocket cut from one web face."""

    shape: Literal["box"]
    face: Literal["journal", "pin"] = Field(examples=["pin"])
    """Web face that it starts from."""
    y_mm: Place = Field(examples=[0.0])
    """Centre along the throw, from the crank axis toward the crankpin."""
    size_x_mm: Length = Field(examples=[10.0])
    """Size across the throw."""
    size_y_mm: Length = Field(examples=[10.0])
    """Size along the throw."""
    depth_mm: Length = Field(examples=[4.0])
    """Depth below the face."""

    @override
    def bodies(self, scene: ThrowView, key: str) -> tuple[Body, ...]:
        half_x, half_y = self.size_x_mm / 2, self.size_y_mm / 2
        low, high = (self.x_mm - half_x, self.y_mm - half_y), (self.x_mm + half_x, self.y_mm + half_y)
        return (RectangularHole(key, depth_range_mm(scene, self.face, self.depth_mm), low, high),)

    @override
    def check_alone(self, scene: ThrowView, key: str) -> None:
        check_depth(scene, f"{key}.depth_mm", self.depth_mm)

    @override
    def drawing(self, scene: ThrowView) -> FeatureDrawing:
        half_x, half_y = self.size_x_mm / 2, self.size_y_mm / 2
        corners = ((-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1))
        edge = tuple((self.x_mm + i * half_x, self.y_mm + j * half_y) for i, j in corners)
        numbers = self.model_dump(exclude={"shape", "face"})
        return FeatureDrawing(
            front=(Polyline(edge, self.face == "journal"),),
            lines=number_lines(f"POCKET {self.shape}, {self.face}", numbers),
        )


class FittedBox(FittedPocket):
    """A box pocket of the re-model."""

    shape: ClassVar[str] = "box"
    sizes: ClassVar[tuple[str, ...]] = ("size_x", "size_y")

    @classmethod
    @override
    def in_region(cls, region: Region) -> Self | None:
        return None if region.kind == "window" or region.face is None else cls(region.face, region.pair)

    @override
    def walls_mm(self, named: Named, across: Array, along: Array) -> list[Array]:
        return [np.abs(across) - named["size_x"] / 2, np.abs(along) - named["size_y"] / 2]

    @override
    def gap_mm(self, named: Named, x_mm: Any, y_mm: Any) -> Any:
        over_x = np.abs(x_mm - named.get("x", 0.0)) - named["size_x"] / 2
        over_y = np.abs(y_mm - named["y"]) - named["size_y"] / 2
        outside = np.sqrt(np.maximum(over_x, 0.0) ** 2 + np.maximum(over_y, 0.0) ** 2 + _TINY)
        return outside + np.minimum(np.maximum(over_x, over_y), 0.0)

    @override
    def size_guess(self, area_mm2: float, across_mm: float, along_mm: float) -> list[float]:
        return [across_mm, along_mm]
