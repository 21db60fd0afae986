"""Bodies of a counterweight: a sector about the crank axis, and the fillets in the corners at the web."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.throw.counterweight.tangent_circle import TangentCircle
from cranktopo.throw.feature import MirroredPrism
from cranktopo.throw.primitives import Arc, Extrusion, LineSegment, Point, Solid


@dataclass(frozen=True)
class CornerFillet(MirroredPrism):
    """Area between two arcs, from where they leave the flanks to where they reach the outline.

    Its inside lies in counterweight and web, with which it is one body. The circle is that of the right arc.
    """

    circle: TangentCircle

    @override
    def half_width_mm(self, y_mm: Array) -> Array:
        (x, y), (low, high) = self.circle.centre, self.y_range_mm
        chord = np.sqrt(np.maximum(self.circle.radius_mm**2 - (y_mm - y) ** 2, 0.0))
        return np.asarray(np.where((y_mm >= low) & (y_mm <= high), x - chord, 0.0))

    @property
    @override
    def y_range_mm(self) -> tuple[float, float]:
        return self.circle.on_flank[1], self.circle.on_outline[1]

    @property
    @override
    def x_range_mm(self) -> tuple[float, float]:
        widest = max(x for x, _ in self.circle.ends)
        return -widest, widest

    @override
    def solids(self) -> tuple[Solid, ...]:
        """Below it ends at a chord of the counterweight, above at one of the outline."""
        low, high = self.z_mm

        def at(place: tuple[float, float], side: float) -> Point:
            return side * place[0], place[1], low

        (left_flank, left_outline), (right_flank, right_outline) = (
            [at(end, side) for end in self.circle.ends] for side in (-1.0, 1.0)
        )
        bottom: Point = (0.0, -self.circle.reach_mm, low)
        contour = (
            LineSegment(bottom, right_flank),
            Arc(right_flank, at(self.circle.centre, 1.0), right_outline),
            LineSegment(right_outline, left_outline),
            Arc(left_outline, at(self.circle.centre, -1.0), left_flank),
            LineSegment(left_flank, bottom),
        )
        return (Extrusion(contour, (0.0, 0.0, high - low)),)


_SAMPLES = 181
"""Points of the arc where it is compared with others."""


@dataclass(frozen=True)
class Sector(MirroredPrism):
    """A sector about the crank axis, `half_angle` (rad) to both sides of the line away from the crankpin."""

    radius_mm: float
    half_angle: float
    kept: ClassVar[bool] = True
    """Its fillets are not: they follow the scene's outline, which an optimiser replaces."""

    @override
    def half_width_mm(self, y_mm: Array) -> Array:
        chord = np.sqrt(np.maximum(self.radius_mm**2 - y_mm**2, 0.0))
        return np.asarray(np.minimum(chord, np.maximum(-y_mm, 0.0) * math.tan(self.half_angle)))

    @property
    @override
    def outer_dimension(self) -> tuple[str, object]:
        return f"{self.key}.outer_radius_mm", self.radius_mm

    @override
    def ends_mm(self) -> tuple[Array, Array, Array]:
        """Return those of its arc alone, from the bottom to the flanks."""
        x, y = self.rim_mm()
        return -x, x, y

    @override
    def polygon_mm(self, sides: Callable[[float], int]) -> Array:
        x, y = self.rim_mm(max(3, math.ceil(sides(self.radius_mm) * self.half_angle / (2 * math.pi))))
        return np.column_stack([np.r_[0.0, -x[:0:-1], x], np.r_[0.0, y[:0:-1], y]])

    @override
    def inside_mm(self, x_mm: Array, y_mm: Array) -> Array:
        """Signed distance of points of a section from the nearer of flank and arc, positive inside."""
        return np.minimum(self.below_rim_mm(x_mm, y_mm), self.inside_flank_mm(x_mm, y_mm))

    def below_rim_mm(self, x_mm: Array, y_mm: Array) -> Array:
        """Distance from the outer cylinder, positive inside it."""
        return np.asarray(self.radius_mm - np.hypot(x_mm, y_mm))

    def inside_flank_mm(self, x_mm: Array, y_mm: Array) -> Array:
        """Distance from the flank on the points' side of x = 0, positive between both flanks."""
        return np.asarray(-y_mm * math.sin(self.half_angle) - np.abs(x_mm) * math.cos(self.half_angle))

    def rim_mm(self, points: int = _SAMPLES) -> tuple[Array, Array]:
        """Points of its arc at x >= 0, from the bottom to the flank."""
        angle = self.half_angle * np.linspace(0.0, 1.0, points)
        return self.radius_mm * np.sin(angle), -self.radius_mm * np.cos(angle)

    @property
    @override
    def y_range_mm(self) -> tuple[float, float]:
        return -self.radius_mm, 0.0

    @property
    @override
    def y_breaks_mm(self) -> tuple[float, ...]:
        return -self.radius_mm, -self.radius_mm * math.cos(self.half_angle), 0.0

    @property
    @override
    def x_range_mm(self) -> tuple[float, float]:
        half = self.radius_mm * math.sin(self.half_angle)
        return -half, half

    @override
    def solids(self) -> tuple[Solid, ...]:
        low, high = self.z_mm
        x, y = self.radius_mm * math.sin(self.half_angle), -self.radius_mm * math.cos(self.half_angle)
        apex, bottom = (0.0, 0.0, low), (0.0, -self.radius_mm, low)
        left: Point = (-x, y, low)
        right: Point = (x, y, low)
        contour = (
            LineSegment(apex, left),
            Arc(left, apex, bottom),
            Arc(bottom, apex, right),
            LineSegment(right, apex),
        )
        return (Extrusion(contour, (0.0, 0.0, high - low)),)
