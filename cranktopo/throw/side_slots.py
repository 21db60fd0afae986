"""Both slots of a side pocket as a body: sections, distances and exact solids."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.spans import Span
from cranktopo.throw.feature import Body
from cranktopo.throw.primitives import Box, Frustum, Solid

BEYOND_MM = 1.0
"""How far the tool of a sloped slot reaches beyond the outline, and a groove beyond both of its ends."""
_CORNERS = ((-1, -1), (1, -1), (1, 1), (-1, 1))


@dataclass(frozen=True)
class SideSlots(Body):
    """Both slots of a side pocket: the floor at |x| = `floor_mm`, where y, z and half sizes count.

    The tool ends at |x| = `outer_mm`, beyond the outline; each wall opens by `slope` mm per mm of |x|.
    """

    floor_mm: float
    outer_mm: float
    y_mm: float
    half_length_mm: float
    z_centre_mm: float
    half_height_mm: float
    slope: float

    @override
    def spans(self, y_mm: Array, z_mm: Array) -> Sequence[Span]:
        inner = np.minimum(self.open_from_mm(y_mm, z_mm), self.outer_mm)
        return [(inner, np.full_like(inner, self.outer_mm)), (np.full_like(inner, -self.outer_mm), -inner)]

    def open_from_mm(self, y_mm: Array, z_mm: Array | float) -> Array:
        """|x| from which the slots are open; infinite where they are not."""
        along, height = np.abs(y_mm - self.y_mm), np.abs(z_mm - self.z_centre_mm)
        beyond = np.maximum(along - self.half_length_mm, height - self.half_height_mm)
        if self.slope == 0:
            return np.where(beyond <= 0, self.floor_mm, np.inf)
        return np.asarray(self.floor_mm + np.maximum(beyond, 0.0) / self.slope)

    @property
    @override
    def y_range_mm(self) -> tuple[float, float]:
        half = self.half_length_mm + self.slope * (self.outer_mm - self.floor_mm)
        return self.y_mm - half, self.y_mm + half

    @property
    @override
    def y_breaks_mm(self) -> tuple[float, ...]:
        return (*self.y_range_mm, self.y_mm - self.half_length_mm, self.y_mm + self.half_length_mm)

    def z_breaks_mm(self, y_mm: Array, half_width_mm: Array) -> list[Array]:
        """Edges of the floor, or of the end wall beyond it, and of the opening in the outline."""
        floor = np.maximum(
            self.half_height_mm, self.half_height_mm + np.abs(y_mm - self.y_mm) - self.half_length_mm
        )
        mouth = self.half_height_mm + self.slope * (half_width_mm - self.floor_mm)
        return [self.z_centre_mm + side * half for half in (floor, mouth) for side in (-1, 1)]

    @property
    @override
    def changing_z_mm(self) -> tuple[tuple[float, float], ...]:
        if self.slope == 0:
            return ()
        floor, mouth = self.half_height_mm, self.slope * (self.outer_mm - self.floor_mm - BEYOND_MM)
        z = self.z_centre_mm
        return (z - floor - mouth, z - floor), (z + floor, z + floor + mouth)

    @override
    def solids(self) -> tuple[Solid, ...]:
        return self._side(1.0), self._side(-1.0)

    def _side(self, side: float) -> Solid:
        if self.slope == 0:
            (y0, y1), (z0, z1) = self.y_range_mm, self.z_mm
            low = self.floor_mm if side > 0 else -self.outer_mm
            return Box((low, y0, z0), (self.outer_mm - self.floor_mm, y1 - y0, z1 - z0))
        more = self.slope * (self.outer_mm - self.floor_mm)
        floor, mouth = (
            tuple(
                (
                    side * x,
                    self.y_mm + j * (self.half_length_mm + out),
                    self.z_centre_mm + k * (self.half_height_mm + out),
                )
                for j, k in _CORNERS
            )
            for x, out in ((self.floor_mm, 0.0), (self.outer_mm, more))
        )
        return Frustum(floor, mouth)
