"""Elliptical outline centred half-way between the axes."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.table import Length
from cranktopo.throw.primitives import Curve, EllipseCurve
from cranktopo.throw.web import WebTable


class EllipseWeb(WebTable):
    """Elliptical web centred half-way between the axes."""

    outline: Literal["ellipse"]
    semi_axis_throw_mm: Length = Field(examples=[50.0])
    """Semi-axis along the throw."""
    semi_axis_lateral_mm: Length = Field(examples=[32.0])
    """Semi-axis across the throw."""

    @override
    def half_width_mm(self, throw_radius_mm: float, y_mm: Array) -> Array:
        inside = 1.0 - ((y_mm - throw_radius_mm / 2) / self.semi_axis_throw_mm) ** 2
        return np.asarray(self.semi_axis_lateral_mm * np.sqrt(np.maximum(inside, 0.0)))

    @override
    def y_range_mm(self, throw_radius_mm: float) -> tuple[float, float]:
        middle = throw_radius_mm / 2
        return middle - self.semi_axis_throw_mm, middle + self.semi_axis_throw_mm

    @property
    @override
    def largest_half_width_mm(self) -> float:
        return self.semi_axis_lateral_mm

    @override
    def contour(self, throw_radius_mm: float, z_mm: float) -> tuple[Curve, ...]:
        centre = (0.0, throw_radius_mm / 2, z_mm)
        return (EllipseCurve(centre, self.semi_axis_lateral_mm, self.semi_axis_throw_mm),)
