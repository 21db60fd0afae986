"""A hole along the crank axis with walls that open by a draft, and rectangular or round corners."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.spans import Span
from cranktopo.throw.feature import Body
from cranktopo.throw.floor_rounding import FloorRounding
from cranktopo.throw.primitives import Extrusion, Frustum, Point, Rectangle, Solid

_ARC = 9
"""Points of a corner in the drawing."""


def rounded_gap_mm(over_x: Any, over_y: Any, radius_mm: Any) -> Any:
    """Return the distance of points from a rectangle with round corners, negative inside.

    Args:
        over_x: distance across beyond its side, negative inside; `over_y` the same along.
    """
    x, y = over_x + radius_mm, over_y + radius_mm
    outside = np.sqrt(np.maximum(x, 0.0) ** 2 + np.maximum(y, 0.0) ** 2 + _TINY)
    return outside + np.minimum(np.maximum(x, y), 0.0) - radius_mm


_TINY = 1e-12


@dataclass(frozen=True)
class TaperedHole(Body):
    """A hole from a web face to its floor: a rectangle, its corners round, that grows by `slope` per mm.

    Half sizes and the corners' radius are those of the floor, where its walls would meet it without the
    rounding of its edge; where the corners' radius is 0 all corners stay sharp.
    """

    floor_z_mm: float
    x_mm: float
    y_mm: float
    half_x_mm: float
    half_y_mm: float
    corner_mm: float
    slope: float
    floor_radius_mm: float = 0.0

    @property
    def _face_z_mm(self) -> float:
        return sum(self.z_mm) - self.floor_z_mm

    @property
    def _mouth_mm(self) -> float:
        """Growth from the floor to the face."""
        return self.slope * (self.z_mm[1] - self.z_mm[0])

    @property
    def _rounding(self) -> FloorRounding:
        return FloorRounding(self.floor_radius_mm, self.slope)

    @override
    def spans(self, y_mm: Array, z_mm: Array) -> Sequence[Span]:
        growth = self._rounding.growth_mm(np.abs(z_mm - self.floor_z_mm))
        corner = self.corner_mm + growth if self.corner_mm else 0.0
        along = np.abs(y_mm - self.y_mm) - self.half_y_mm - growth
        bend = np.sqrt(np.maximum(corner**2 - np.maximum(along + corner, 0.0) ** 2, 0.0))
        half = self.half_x_mm + growth - corner + bend
        inside = (along < 0) & (z_mm >= self.z_mm[0]) & (z_mm <= self.z_mm[1])
        half = np.where(inside, half, 0.0)
        return [(self.x_mm - half, self.x_mm + half)]

    @property
    @override
    def y_range_mm(self) -> tuple[float, float]:
        half = self.half_y_mm + self._mouth_mm
        return self.y_mm - half, self.y_mm + half

    @property
    @override
    def y_breaks_mm(self) -> tuple[float, ...]:
        halves = [self.half_y_mm - self.corner_mm, self.half_y_mm, self.half_y_mm + self._mouth_mm]
        if self.floor_radius_mm:
            halves += [self.half_y_mm + growth for growth in self._rounding.kinks_mm]
        return tuple(self.y_mm + side * half for half in halves for side in (-1, 1))

    def z_breaks_mm(self, y_mm: Array, half_width_mm: Array) -> list[Array]:
        """Both ends, the wall's foot beyond the floor, its rounding, and where the walls meet the outline."""
        ends = [np.full(y_mm.shape, z) for z in self.z_mm]
        if self.slope == 0 and not self.floor_radius_mm:
            return ends
        beyond = np.abs(y_mm - self.y_mm) - self.half_y_mm
        round_end = np.maximum(beyond + self.corner_mm, 0.0) if self.corner_mm else 0.0
        growths = [beyond]
        for side in (-1, 1):
            across = half_width_mm + side * self.x_mm - self.half_x_mm + self.corner_mm
            growths.append(np.hypot(np.maximum(across, 0.0), round_end) - self.corner_mm)
        way = 1.0 if self._face_z_mm > self.floor_z_mm else -1.0
        heights = [self._rounding.height_mm(growth) for growth in growths]
        if self.floor_radius_mm:
            heights.append(np.full(y_mm.shape, self._rounding.top_mm))
        return [*ends, *(self.floor_z_mm + way * height for height in heights)]

    @property
    @override
    def changing_z_mm(self) -> tuple[tuple[float, float], ...]:
        return (self.z_mm,) if self.slope or self.floor_radius_mm else ()

    def distance_mm(self, y_mm: float, z_mm: float) -> float:
        """Distance of its edge at the face from the axis (0, y), mm; negative if it covers the axis."""
        growth, corner = self._mouth_mm, self.corner_mm + self._mouth_mm if self.corner_mm else 0.0
        over = abs(self.x_mm) - self.half_x_mm - growth, abs(self.y_mm - y_mm) - self.half_y_mm - growth
        return float(rounded_gap_mm(*over, corner))

    @override
    def solids(self) -> tuple[Solid, ...]:
        floor, mouth = (self._corners(z) for z in (self.floor_z_mm, self._face_z_mm))
        radius = self.corner_mm
        radii = (radius, radius + self._mouth_mm) if radius else (0.0, 0.0)
        return (Frustum(floor, mouth, radii, self.floor_radius_mm),)

    def _corners(self, z_mm: float) -> tuple[Point, ...]:
        half_x, half_y = self._half_sizes(z_mm)
        signs = ((-1, -1), (1, -1), (1, 1), (-1, 1))
        return tuple((self.x_mm + i * half_x, self.y_mm + j * half_y, z_mm) for i, j in signs)

    def _half_sizes(self, z_mm: float) -> tuple[float, float]:
        growth = self.slope * abs(z_mm - self.floor_z_mm)
        return self.half_x_mm + growth, self.half_y_mm + growth

    @override
    def continued(self, z_mm: tuple[float, float]) -> tuple[Solid, ...]:
        (x, y, _), *_ = self._corners(self._face_z_mm)
        half_x, half_y = self._half_sizes(self._face_z_mm)
        radius, (low, high) = self.corner_mm + self._mouth_mm if self.corner_mm else 0.0, z_mm
        section = Rectangle((x, y, low), 2 * half_x, 2 * half_y, radius)
        return (Extrusion((section,), (0.0, 0.0, high - low)),)

    def edges_mm(self) -> tuple[tuple[tuple[float, float], ...], ...]:
        """Return the closed edge at the face, and with a draft that of the floor, as points (x, y)."""
        heights = (self._face_z_mm, self.floor_z_mm) if self.slope else (self._face_z_mm,)
        return tuple(self._edge_mm(z) for z in heights)

    def _edge_mm(self, z_mm: float) -> tuple[tuple[float, float], ...]:
        corner = self.corner_mm + self.slope * abs(z_mm - self.floor_z_mm) if self.corner_mm else 0.0
        angles = np.linspace(0.0, math.pi / 2, _ARC) if corner else np.zeros(1)
        points = []
        for quarter, (x, y, _) in enumerate(self._corners(z_mm)):
            turn = angles + math.pi + quarter * math.pi / 2
            inward = np.sign([self.x_mm - x, self.y_mm - y])
            centre = np.array([x, y]) + corner * inward
            arc = centre + corner * np.stack([np.cos(turn), np.sin(turn)], axis=1)
            points += [(float(a), float(b)) for a, b in arc]
        return (*points, points[0])
