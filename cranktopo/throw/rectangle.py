"""Rectangular outline with rounded corners."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.errors import invalid
from cranktopo.base.table import Length, LengthOrZero
from cranktopo.throw.primitives import Curve, Rectangle
from cranktopo.throw.web import WebTable


class RectangleWeb(WebTable):
    """Rectangular web reaching `overhang_mm` beyond each axis."""

    outline: Literal["rectangle"]
    width_mm: Length = Field(examples=[50.0])
    """Width across the throw."""
    overhang_mm: Length = Field(examples=[25.0])
    """Length beyond each axis."""
    corner_radius_mm: LengthOrZero = 0.0
    """Radius of the corners."""

    @override
    def half_width_mm(self, throw_radius_mm: float, y_mm: Array) -> Array:
        corner, middle = self.corner_radius_mm, throw_radius_mm / 2
        beyond = np.abs(y_mm - middle) - (middle + self.overhang_mm - corner)
        round_mm = np.sqrt(np.maximum(corner**2 - np.maximum(beyond, 0.0) ** 2, 0.0))
        return np.where(beyond <= corner, self.width_mm / 2 - corner + round_mm, 0.0)

    @override
    def y_range_mm(self, throw_radius_mm: float) -> tuple[float, float]:
        return -self.overhang_mm, throw_radius_mm + self.overhang_mm

    @property
    @override
    def largest_half_width_mm(self) -> float:
        return self.width_mm / 2

    @override
    def kinks_mm(self, throw_radius_mm: float) -> tuple[float, ...]:
        low, high = self.y_range_mm(throw_radius_mm)
        return low + self.corner_radius_mm, high - self.corner_radius_mm

    @override
    def contour(self, throw_radius_mm: float, z_mm: float) -> tuple[Curve, ...]:
        low, high = self.y_range_mm(throw_radius_mm)
        corner = (-self.width_mm / 2, low, z_mm)
        return (Rectangle(corner, self.width_mm, high - low, self.corner_radius_mm),)

    @override
    def check_outline(self, throw_radius_mm: float) -> None:
        half_length = throw_radius_mm / 2 + self.overhang_mm
        if self.corner_radius_mm >= self.width_mm / 2:
            allowed = f"must be smaller than half of web.width_mm ({self.width_mm / 2:g} mm)"
            hint = "Use the obround outline for fully round ends."
        elif self.corner_radius_mm > half_length:
            allowed = f"must be at most half of the web's length ({half_length:g} mm)"
            hint = "Reduce it or increase web.overhang_mm."
        else:
            return
        raise invalid("web.corner_radius_mm", self.corner_radius_mm, allowed, hint)
