"""The fillet in the corners between a counterweight's flanks and the sides of the web."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.throw.counterweight.tangent_circle import TangentCircle
from cranktopo.throw.feature import MirroredPrism
from cranktopo.throw.primitives import Arc, Extrusion, LineSegment, Point, Solid


@dataclass(frozen=True)
class CornerFillet(MirroredPrism):
    """What lies between two arcs, from where they leave the flanks to where they reach the outline.

    Its inside lies in counterweight and web, with which it is one body.

    Attributes:
        circle: of the right arc.
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
