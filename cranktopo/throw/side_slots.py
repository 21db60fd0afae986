"""Both slots of a side pocket as one body: floor, walls that open outward, and the rounding between them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.spans import Span
from cranktopo.throw.element_size import tube_term
from cranktopo.throw.feature import Body
from cranktopo.throw.floor_rounding import FloorRounding
from cranktopo.throw.primitives import Box, Frustum, Solid
from cranktopo.throw.tapered_hole import rounded_gap_mm

BEYOND_MM = 1.0
"""Reach of the tool of a sloped slot beyond the outline, and of a groove beyond both of its ends."""
_CORNERS = ((-1, -1), (1, -1), (1, 1), (-1, 1))


@dataclass(frozen=True)
class SideSlots(Body):
    """Both slots of a side pocket: the floor at |x| = `floor_mm`, where y, z, half sizes and corners count.

    The tool ends at |x| = `outer_mm`, beyond the outline; each wall opens by `slope` mm per mm of |x|. The
    edge of the floor is round along all walls where the corners are round, else along the walls of a groove
    alone: its end walls lie beyond the web.
    """

    floor_mm: float
    outer_mm: float
    y_mm: float
    half_length_mm: float
    z_centre_mm: float
    half_height_mm: float
    slope: float
    corner_mm: float = 0.0
    floor_radius_mm: float = 0.0

    @property
    def _rounding(self) -> FloorRounding:
        return FloorRounding(self.floor_radius_mm, self.slope)

    @override
    def spans(self, y_mm: Array, z_mm: Array) -> Sequence[Span]:
        inner = np.minimum(self.open_from_mm(y_mm, z_mm), self.outer_mm)
        return [(inner, np.full_like(inner, self.outer_mm)), (np.full_like(inner, -self.outer_mm), -inner)]

    def open_from_mm(self, y_mm: Array, z_mm: Array | float) -> Array:
        """|x| from which the slots are open; infinite where they are not."""
        along = np.abs(y_mm - self.y_mm) - self.half_length_mm
        height = np.abs(z_mm - self.z_centre_mm) - self.half_height_mm
        if self.floor_radius_mm:
            return np.asarray(self.floor_mm + self._over_floor_mm(along, np.asarray(height)))
        rounded = self.corner_mm > 0
        beyond = rounded_gap_mm(along, height, self.corner_mm) if rounded else np.maximum(along, height)
        if self.slope == 0:
            return np.where(beyond <= 0, self.floor_mm, np.inf)
        return np.asarray(self.floor_mm + np.maximum(beyond, 0.0) / self.slope)

    def _over_floor_mm(self, along: Array, height: Array) -> Array:
        """Height of the slots over their floor, whose edge is round, at distances beyond its sides."""
        if self.corner_mm:
            return self._rounding.height_mm(rounded_gap_mm(along, height, self.corner_mm))
        at_end = np.where(along > 0, FloorRounding(0.0, self.slope).height_mm(along), 0.0)
        return np.maximum(self._rounding.height_mm(height), at_end)

    @property
    @override
    def y_range_mm(self) -> tuple[float, float]:
        half = self.half_length_mm + self.slope * (self.outer_mm - self.floor_mm)
        return self.y_mm - half, self.y_mm + half

    @property
    @override
    def y_breaks_mm(self) -> tuple[float, ...]:
        kinks = self._rounding.kinks_mm if self.corner_mm else (0.0,)
        halves = {self.half_length_mm - self.corner_mm, *(self.half_length_mm + growth for growth in kinks)}
        return (*self.y_range_mm, *(self.y_mm + side * half for half in sorted(halves) for side in (-1, 1)))

    def z_breaks_mm(self, y_mm: Array, half_width_mm: Array) -> list[Array]:
        """Edges of the floor, or of the end wall beyond it, and of the opening in the outline."""
        away, kinks = np.abs(y_mm - self.y_mm), self._rounding.kinks_mm
        opening = self._rounding.growth_mm(half_width_mm - self.floor_mm)
        if self.corner_mm:
            straight = self.half_height_mm - self.corner_mm
            bend = np.maximum(away - self.half_length_mm + self.corner_mm, 0.0)
            growths = *map(np.asarray, kinks), np.maximum(opening, kinks[0])
            radii = (self.corner_mm + growth for growth in growths)
            arcs = (straight + np.sqrt(np.maximum(radius**2 - bend**2, 0.0)) for radius in radii)
            halves = [np.full(y_mm.shape, straight), *arcs]
        else:
            halves = [np.maximum(self.half_height_mm, self.half_height_mm + away - self.half_length_mm)]
            rounded = kinks if self.floor_radius_mm else ()
            halves += [np.full(y_mm.shape, self.half_height_mm + kink) for kink in rounded]
            halves.append(self.half_height_mm + opening)
        return [self.z_centre_mm + side * half for half in halves for side in (-1, 1)]

    @property
    @override
    def changing_z_mm(self) -> tuple[tuple[float, float], ...]:
        floor, opening = self.half_height_mm, self.slope * (self.outer_mm - self.floor_mm - BEYOND_MM)
        kinks = (floor + kink for kink in self._rounding.kinks_mm)
        heights = [floor - self.corner_mm, *kinks, floor + opening]
        z, parts = self.z_centre_mm, [(low, high) for low, high in pairwise(heights) if high > low]
        return (*((z - high, z - low) for low, high in parts), *((z + low, z + high) for low, high in parts))

    def size_term(self, finest_mm: float, height: str) -> str:
        """Return a formula of the largest element size at the round edge of its floor in x, y and z, mm.

        Args:
            height: formula of the height in the half throw.
        """
        over = f"(Fabs({height}-({self.z_centre_mm!r}))-{self.half_height_mm!r})"
        if self.corner_mm:
            along = f"(Fabs(y-({self.y_mm!r}))-{self.half_length_mm!r})"
            one, other = (f"({side}+{self.corner_mm!r})" for side in (over, along))
            outside = f"Sqrt(Max({one},0)^2+Max({other},0)^2)"
            over = f"({outside}+Min(Max({one},{other}),0)-{self.corner_mm!r})"
        out = f"({over}+{self._rounding.foot_mm!r})"
        up = f"(Fabs(x)-{self.floor_mm + self.floor_radius_mm!r})"
        return tube_term(finest_mm, out, up, self.floor_radius_mm)

    @override
    def solids(self) -> tuple[Solid, ...]:
        return self._side(1.0), self._side(-1.0)

    def _side(self, side: float) -> Solid:
        if self.slope == 0 and not self.corner_mm and not self.floor_radius_mm:
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
        radius = self.corner_mm
        radii = (radius, radius + more) if radius else (0.0, 0.0)
        return Frustum(floor, mouth, radii, self.floor_radius_mm)
