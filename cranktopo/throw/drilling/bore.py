"""The body of an oil drilling, a straight hole between surfaces of journals, and element sizes around it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import cast

import numpy as np
from typing_extensions import override

from cranktopo.base.arrays import Array, shared
from cranktopo.base.spans import Section, Span
from cranktopo.throw.drilling.outlet import DrillOutlet, across
from cranktopo.throw.element_size import GROWTH
from cranktopo.throw.feature import Body
from cranktopo.throw.primitives import Cylinder, Point, RoundedOutlet, Solid

_WALL = 1.0
"""Thickness of the wall that stays around a drilling over its radius."""
_PARALLEL = 1e-9
"""Sine of an angle that counts as none."""
_CIRCLE, _STEPS = 180, 200
_ALL = -math.inf, math.inf
_BEYOND = 0.25
"""Reach of the tool beyond the surface over the drilling's radius."""


@dataclass(frozen=True)
class DrillBore(Body):
    """A drilling as a body: a cylinder that reaches just beyond the surfaces at both its ends.

    Where it is `alone`, the other half has no mirror image of it, and it does not end at the mid-pin plane.
    """

    radius_mm: float
    outlets: tuple[DrillOutlet, DrillOutlet]
    alone: bool = False

    @classmethod
    def between(
        cls, key: str, radius_mm: float, outlets: tuple[DrillOutlet, DrillOutlet], alone: bool
    ) -> DrillBore:
        """Return the bore of a radius between two outlets."""
        bore = cls(key, (0.0, 0.0), radius_mm, outlets, alone)
        if not bore.length_mm:  # the checks refuse it
            return bore
        low, high = (float(end[2]) for end in bore.box_mm(radius_mm))
        return replace(bore, z_mm=(low, high))

    @property
    def wall_mm(self) -> float:
        """Radius of the wall around it that no optimiser takes away."""
        return (1 + _WALL) * self.radius_mm

    @cached_property
    def direction(self) -> Array:
        """Unit vector (x, y, z) from its first end to its second."""
        return shared(np.array(self.outlets[1].outward))

    @property
    def length_mm(self) -> float:
        """Length of its axis between the two surfaces."""
        return math.dist(self.outlets[0].point_mm, self.outlets[1].point_mm)

    @property
    def reach_mm(self) -> float:
        """Radius with the larger rounding: what it needs of a surface."""
        return self.radius_mm + max(outlet.rounding_mm for outlet in self.outlets)

    @property
    def heights_mm(self) -> tuple[float, float]:
        """Least and largest z of what it needs, the roundings of its outlets with it."""
        low, high = self.box_mm(self.reach_mm)
        return float(low[2]), float(high[2])

    @cached_property
    def around(self) -> Array:
        """Unit vectors (n, 3) all around its axis."""
        angle = np.linspace(0, 2 * np.pi, _CIRCLE, endpoint=False)[:, None]
        one, other = across(self.direction)
        return shared(np.cos(angle) * one + np.sin(angle) * other)

    @cached_property
    def extent_mm(self) -> tuple[float, float]:
        """Places along the axis where the tool begins and ends, from the first end on."""
        before, after = (self._beyond_mm(outlet) for outlet in self.outlets)
        return -before, self.length_mm + after

    def _beyond_mm(self, outlet: DrillOutlet) -> float:
        if not outlet.surface_mm:
            return 0.0
        heights = outlet.height_mm(self.radius_mm * self.around, outlet.surface_mm)
        return float(heights.max()) + _BEYOND * self.radius_mm

    @cached_property
    def crosses_middle(self) -> bool:
        """Tell whether it reaches beyond the middle of the main journal, where its half throw ends."""
        (_, _, low), _ = self.box_mm(self.radius_mm)
        rims = (o.point_mm[2] - self.radius_mm - o.rounding_mm for o in self.outlets if o.surface_mm)
        return min(float(low), *rims) < 0

    def in_second_half(self, pitch_mm: float) -> DrillBore:
        """Return it as one of the half throw beyond the crankpin, in the frame of the throw of that pitch."""
        one, other = (outlet.in_second_half(pitch_mm) for outlet in self.outlets)
        return DrillBore.between(self.key, self.radius_mm, (one, other), self.alone)

    def moved(self, by_mm: float) -> DrillBore:
        """Return it farther along the crank."""
        one, other = (outlet.moved(by_mm) for outlet in self.outlets)
        return DrillBore.between(self.key, self.radius_mm, (one, other), self.alone)

    @cached_property
    def places_mm(self) -> Array:
        """Places (n,) along its axis from its first end on, over the whole tool."""
        return shared(np.linspace(*self.extent_mm, _STEPS))

    def surface_mm(self, radius_mm: float) -> Array:
        """Points (n, 3) on a cylinder about its axis, all around it at each of `places_mm` in turn."""
        start = np.array(self.outlets[0].point_mm)
        points = start + self.places_mm[:, None, None] * self.direction + radius_mm * self.around[None]
        return points.reshape(-1, 3)

    def section(self, radius_mm: float) -> Section:
        """Section of a cylinder of a radius about its axis, as long as the tool."""
        (x0, y0, z0), (dx, dy, dz) = self.outlets[0].point_mm, self.direction.tolist()
        across, (first, last) = max(1 - dx**2, _PARALLEL), self.extent_mm

        def spans(y_mm: Array, z_mm: Array) -> list[Span]:
            along = (y_mm - y0) * dy + (z_mm - z0) * dz
            middle = dx * along / across
            free = radius_mm**2 - (y_mm - y0) ** 2 - (z_mm - z0) ** 2 + along**2
            half = np.sqrt(np.maximum(free / across + middle**2, 0.0))
            low, high = _between(dx, first - along, last - along)
            return [(x0 + np.maximum(middle - half, low), x0 + np.minimum(middle + half, high))]

        return spans

    @override
    def spans(self, y_mm: Array, z_mm: Array) -> Sequence[Span]:
        return self.section(self.radius_mm)(y_mm, z_mm)

    @property
    @override
    def y_range_mm(self) -> tuple[float, float]:
        low, high = self.box_mm(self.radius_mm)
        return float(low[1]), float(high[1])

    @property
    @override
    def changing_z_mm(self) -> tuple[tuple[float, float], ...]:
        return (self.z_mm,)

    @override
    def solids(self) -> tuple[Solid, ...]:
        low, high = self.extent_mm
        start = np.array(self.outlets[0].point_mm) + low * self.direction
        hole = Cylinder(_point(start), _point((high - low) * self.direction), self.radius_mm)
        return hole, *(
            RoundedOutlet(
                self.key, o.journal, hole, o.point_mm, o.outward, o.y_mm, o.surface_mm, o.rounding_mm
            )
            for o in self.outlets
            if o.rounding_mm
        )

    def box_mm(self, radius_mm: float, z_mm: tuple[float, float] = _ALL) -> tuple[Array, Array]:
        """Least and largest x, y and z of such a cylinder between two heights, in which it must be."""
        start, along = np.array(self.outlets[0].point_mm), self.direction
        reach = radius_mm * np.sqrt(np.maximum(1 - along**2, 0.0))
        ends = start + np.outer(self.extent_mm, along)
        low, high = ends.min(axis=0) - reach, ends.max(axis=0) + reach
        heights = np.clip(z_mm, low[2], high[2])
        if abs(along[2]) > _PARALLEL:
            middles = start + np.outer((heights - start[2]) / along[2], along)
            wide = radius_mm * np.hypot(1.0, along / along[2])
            low = np.maximum(low, middles.min(axis=0) - wide)
            high = np.minimum(high, middles.max(axis=0) + wide)
        return low, high

    def off_axis_mm(self, x_mm: Array, y_mm: Array, z_mm: Array) -> Array:
        """Distance of points from the axis of the tool, broadcastable."""
        start, along = np.array(self.outlets[0].point_mm), self.direction
        offset = [np.asarray(p) - s for p, s in zip((x_mm, y_mm, z_mm), start, strict=True)]
        place = np.clip(sum(o * d for o, d in zip(offset, along, strict=True)), *self.extent_mm)
        square = sum((o - place * d) ** 2 for o, d in zip(offset, along, strict=True))
        return cast(Array, np.sqrt(square))


def _between(slope: float, low: Array, high: Array) -> tuple[Array, Array]:
    if abs(slope) < _PARALLEL:
        inside = (low <= 0) & (high >= 0)
        return np.where(inside, -np.inf, np.inf), np.where(inside, np.inf, -np.inf)
    ends = low / slope, high / slope
    return np.minimum(*ends), np.maximum(*ends)


def _point(place: Array) -> Point:
    return cast(Point, tuple(place.tolist()))


_ALONG, _OUTLET = 1.0, 0.5
"""Element size along a drilling and at its outlets over its radius."""


def size_terms(bore: DrillBore, size: float, fraction: float | None, height: str) -> list[str]:
    """Return formulae of the largest element size at a drilling in x, y and z, mm.

    Args:
        fraction: element size on a rounded outlet over its radius; None for what stiffness needs.
        height: formula of the height in the half throw.
    """
    at = [_at(outlet, bore, size, fraction, height) for outlet in bore.outlets]
    return [_along(bore, size, height), *at]


def size_mm(bore: DrillBore, size: float, points_mm: Array) -> Array:
    """Return the largest element size at points (n, 3) of the half throw, mm, for stiffness."""
    start, direction = np.array(bore.outlets[0].point_mm), bore.direction
    away = np.linalg.norm(np.cross(points_mm - start, direction), axis=1)
    result = min(size, _ALONG * bore.radius_mm) + GROWTH * away
    for outlet in bore.outlets:
        away = np.linalg.norm(points_mm - np.array(outlet.point_mm), axis=1) - (
            bore.radius_mm + outlet.rounding_mm
        )
        beside = min(size, _OUTLET * bore.radius_mm) + GROWTH * np.maximum(away, 0.0)
        result = np.minimum(result, beside)
    return np.asarray(result)


def _along(bore: DrillBore, size: float, height: str) -> str:
    (px, py, pz), (dx, dy, dz) = bore.outlets[0].point_mm, bore.direction.tolist()
    x, y, z = f"(x-({px!r}))", f"(y-({py!r}))", f"({height}-({pz!r}))"
    cross = f"({y}*({dz!r})-{z}*({dy!r}))^2+({z}*({dx!r})-{x}*({dz!r}))^2+({x}*({dy!r})-{y}*({dx!r}))^2"
    return f"{min(size, _ALONG * bore.radius_mm)!r}+{GROWTH!r}*Sqrt({cross})"


def _at(outlet: DrillOutlet, bore: DrillBore, size: float, fraction: float | None, z: str) -> str:
    px, py, pz = outlet.point_mm
    notch = outlet.rounding_mm or bore.radius_mm
    finest = min(size, _OUTLET * bore.radius_mm if fraction is None else fraction * notch)
    distance = f"Sqrt((x-({px!r}))^2+(y-({py!r}))^2+({z}-({pz!r}))^2)"
    return f"{finest!r}+{GROWTH!r}*Max(0,{distance}-{bore.radius_mm + outlet.rounding_mm!r})"
