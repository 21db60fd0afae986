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
from cranktopo.throw.primitives import Arc, Curve, Extrusion, LineSegment, Point, Solid


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
class RoundCorner:
    """The circle at x > 0 that touches a sector's rim and flank from inside, and where it does."""

    centre: tuple[float, float]
    on_rim: tuple[float, float]
    on_flank: tuple[float, float]


@dataclass(frozen=True)
class Sector(MirroredPrism):
    """A sector about the crank axis, `half_angle` (rad) to both sides of the line away from the crankpin.

    The corners between its rim and its flanks may be round.
    """

    radius_mm: float
    half_angle: float
    corner_mm: float = 0.0
    kept: ClassVar[bool] = True
    """Its fillets are not: they follow the scene's outline, which an optimiser replaces."""

    @property
    def corner(self) -> RoundCorner:
        """Its round corner; one of radius 0 is the point in which rim and flank meet."""
        r, inner, (sine, cosine) = self.corner_mm, self.radius_mm - self.corner_mm, self._flank
        along = math.sqrt(inner**2 - r**2)
        centre = along * sine - r * cosine, -along * cosine - r * sine
        share = self.radius_mm / inner
        return RoundCorner(centre, (share * centre[0], share * centre[1]), (along * sine, -along * cosine))

    @property
    def _flank(self) -> tuple[float, float]:
        return math.sin(self.half_angle), math.cos(self.half_angle)

    @override
    def half_width_mm(self, y_mm: Array) -> Array:
        chord = np.sqrt(np.maximum(self.radius_mm**2 - y_mm**2, 0.0))
        sharp = np.minimum(chord, np.maximum(-y_mm, 0.0) * math.tan(self.half_angle))
        if not self.corner_mm:
            return np.asarray(sharp)
        corner = self.corner
        x, y = corner.centre
        arc = x + np.sqrt(np.maximum(self.corner_mm**2 - (y_mm - y) ** 2, 0.0))
        return np.where((y_mm > corner.on_rim[1]) & (y_mm < corner.on_flank[1]), arc, sharp)

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
        along = math.ceil(sides(self.radius_mm) * self.half_angle / (2 * math.pi))
        x, y = self.rim_mm(max(3, 2 * along if self.corner_mm else along))
        return np.column_stack([np.r_[0.0, -x[:0:-1], x], np.r_[0.0, y[:0:-1], y]])

    @override
    def inside_mm(self, x_mm: Array, y_mm: Array) -> Array:
        """Signed distance of points of a section from flank, arc or corner, positive inside."""
        sharp = np.minimum(self.below_rim_mm(x_mm, y_mm), self.inside_flank_mm(x_mm, y_mm))
        if not self.corner_mm:
            return np.asarray(sharp)
        (x, y), (sine, cosine) = self.corner.centre, self._flank
        across, up = np.abs(x_mm) - x, y_mm - y
        beyond = (across * sine - up * cosine > 0) & (up * x - across * y > 0)
        return np.where(beyond, self.inside_corner_mm(x_mm, y_mm), sharp)

    def below_rim_mm(self, x_mm: Array, y_mm: Array) -> Array:
        """Distance from the outer cylinder, positive inside it."""
        return np.asarray(self.radius_mm - np.hypot(x_mm, y_mm))

    def inside_flank_mm(self, x_mm: Array, y_mm: Array) -> Array:
        """Distance from the flank on the points' side of x = 0, positive between both flanks."""
        return np.asarray(-y_mm * math.sin(self.half_angle) - np.abs(x_mm) * math.cos(self.half_angle))

    def inside_corner_mm(self, x_mm: Array, y_mm: Array) -> Array:
        """Distance from the cylinder of the corner on the points' side of x = 0, positive inside it."""
        x, y = self.corner.centre
        return np.asarray(self.corner_mm - np.hypot(np.abs(x_mm) - x, y_mm - y))

    def rim_mm(self, points: int = _SAMPLES) -> tuple[Array, Array]:
        """Points of its arc and its round corner at x >= 0, from the bottom to the flank."""
        if not self.corner_mm:
            angle = self.half_angle * np.linspace(0.0, 1.0, points)
            return self.radius_mm * np.sin(angle), -self.radius_mm * np.cos(angle)
        (x, y), on_rim = self.corner.centre, self.corner.on_rim
        round_points = max(2, points // 4)
        angle = np.linspace(0.0, math.atan2(on_rim[0], -on_rim[1]), points - round_points)
        turn = np.linspace(math.atan2(y, x), self.half_angle, round_points + 1)[1:]
        return (
            np.append(self.radius_mm * np.sin(angle), x + self.corner_mm * np.cos(turn)),
            np.append(-self.radius_mm * np.cos(angle), y + self.corner_mm * np.sin(turn)),
        )

    @property
    @override
    def y_range_mm(self) -> tuple[float, float]:
        return -self.radius_mm, 0.0

    @property
    @override
    def y_breaks_mm(self) -> tuple[float, ...]:
        sharp = -self.radius_mm, -self.radius_mm * math.cos(self.half_angle), 0.0
        return (*sharp, self.corner.on_rim[1], self.corner.on_flank[1]) if self.corner_mm else sharp

    @property
    @override
    def x_range_mm(self) -> tuple[float, float]:
        corner = self.corner.centre[0] + self.corner_mm
        half = corner if self.corner_mm else self.radius_mm * math.sin(self.half_angle)
        return -half, half

    @override
    def solids(self) -> tuple[Solid, ...]:
        (low, high), corner = self.z_mm, self.corner
        apex, bottom = (0.0, 0.0, low), (0.0, -self.radius_mm, low)

        def at(place: tuple[float, float], side: float) -> Point:
            return side * place[0], place[1], low

        (left, right), (out, back) = (
            (at(place, -1.0), at(place, 1.0)) for place in (corner.on_rim, corner.on_flank)
        )
        rim: tuple[Curve, ...] = (Arc(left, apex, bottom), Arc(bottom, apex, right))
        if self.corner_mm:
            middles = at(corner.centre, -1.0), at(corner.centre, 1.0)
            rim = (Arc(out, middles[0], left), *rim, Arc(right, middles[1], back))
        contour = (LineSegment(apex, out), *rim, LineSegment(back, apex))
        return (Extrusion(contour, (0.0, 0.0, high - low)),)
