"""Outlines of a web; another one is registered in `Web`, any other feature in `web.py`."""

from __future__ import annotations

import math
from abc import abstractmethod
from typing import Annotated, Literal

import numpy as np
from pydantic import Field
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.errors import invalid
from cranktopo.base.table import Length, LengthOrZero
from cranktopo.throw.primitives import Arc, Curve, EllipseCurve, LineSegment, Rectangle
from cranktopo.throw.profile import ProfileWeb
from cranktopo.throw.web import WebTable


class _HullWeb(WebTable):
    @property
    @abstractmethod
    def radii_mm(self) -> tuple[float, float]:
        """Radii of the round ends about the crank axis and the pin axis, whose convex hull the web is."""

    @override
    def half_width_mm(self, throw_radius_mm: float, y_mm: Array) -> Array:
        return _half_width(*self.radii_mm, throw_radius_mm, y_mm)

    @override
    def y_range_mm(self, throw_radius_mm: float) -> tuple[float, float]:
        main, pin = self.radii_mm  # one circle may hold the other
        return min(-main, throw_radius_mm - pin), max(main, throw_radius_mm + pin)

    @property
    @override
    def largest_half_width_mm(self) -> float:
        return max(self.radii_mm)

    @override
    def kinks_mm(self, throw_radius_mm: float) -> tuple[float, ...]:
        main, pin = self.radii_mm
        sine = (main - pin) / throw_radius_mm
        return () if abs(sine) >= 1 else (main * sine, throw_radius_mm + pin * sine)

    @override
    def contour(self, throw_radius_mm: float, z_mm: float) -> tuple[Curve, ...]:
        main, pin = self.radii_mm
        if abs(main - pin) >= throw_radius_mm:
            raise invalid(
                "web.main_radius_mm",
                main,
                f"must differ from web.pin_radius_mm = {pin:g} mm by less than the throw radius "
                f"{throw_radius_mm:g} mm",
            )
        return _contour(main, pin, throw_radius_mm, z_mm)


class ObroundWeb(_HullWeb):
    """Slot-shaped web: both round ends centred on the axes."""

    outline: Literal["obround"]
    width_mm: Length = Field(examples=[50.0])
    """Width across the throw."""

    @property
    @override
    def radii_mm(self) -> tuple[float, float]:
        return self.width_mm / 2, self.width_mm / 2


class TaperedWeb(_HullWeb):
    """Convex hull of a circle on the crank axis and a circle on the pin axis."""

    outline: Literal["tapered"]
    main_radius_mm: Length = Field(examples=[32.0])
    """Radius of the circle on the crank axis."""
    pin_radius_mm: Length = Field(examples=[25.0])
    """Radius of the circle on the pin axis."""

    @property
    @override
    def radii_mm(self) -> tuple[float, float]:
        return self.main_radius_mm, self.pin_radius_mm


def _half_width(main_radius: float, pin_radius: float, distance: float, y: Array) -> Array:
    """Convex hull of a circle at the origin and one at (0, distance)."""
    main, pin = (
        np.sqrt(np.maximum(r**2 - (y - c) ** 2, 0.0)) for r, c in ((main_radius, 0.0), (pin_radius, distance))
    )
    circles = np.maximum(main, pin)
    sine = (main_radius - pin_radius) / distance
    if abs(sine) >= 1.0:
        return circles
    # The common tangent touches both circles where their radii make this angle with the lateral axis.
    cosine = math.sqrt(1.0 - sine**2)
    tangent = (main_radius - y * sine) / cosine
    between = (y >= main_radius * sine) & (y <= distance + pin_radius * sine)
    return np.where(between, tangent, circles)


def _contour(main: float, pin: float, radius: float, z: float) -> tuple[Curve, ...]:
    sine = (main - pin) / radius
    cosine = math.sqrt(1 - sine**2)
    right_main, right_pin, left_pin, left_main = (
        (side * r * cosine, y + r * sine, z)
        for side, r, y in ((1, main, 0.0), (1, pin, radius), (-1, pin, radius), (-1, main, 0.0))
    )
    top, bottom = (0.0, radius + pin, z), (0.0, -main, z)
    centre_main, centre_pin = (0.0, 0.0, z), (0.0, radius, z)
    return (
        LineSegment(right_main, right_pin),
        Arc(right_pin, centre_pin, top),
        Arc(top, centre_pin, left_pin),
        LineSegment(left_pin, left_main),
        Arc(left_main, centre_main, bottom),
        Arc(bottom, centre_main, right_main),
    )


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


Web = Annotated[
    ObroundWeb | RectangleWeb | EllipseWeb | TaperedWeb | ProfileWeb, Field(discriminator="outline")
]
