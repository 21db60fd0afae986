"""Bodies of a raw part between two halves of a die: each is as wide to both sides of the parting plane x = 0.

All are as wide at a place along the throw and a height as their half-width says, and none grows steeper
toward the parting plane than the draft lets it.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import combinations
from typing import ClassVar

import numpy as np
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.spans import Span
from cranktopo.throw.crossings import roots
from cranktopo.throw.feature import Body, MirroredPrism
from cranktopo.throw.primitives import Arc, Curve, Cylinder, LineSegment, Loft, Point, Solid
from cranktopo.throw.raw_part.drafted_outline import DraftedOutline

_Width = Callable[[Array, Array], Array]
_BEYOND_MM = 1.0
"""Reach of tools beyond the widest place."""
_PLACES, _HEIGHTS = 401, 101
"""Place at which the reach of a cut is compared with the width of what it cuts."""


@dataclass(frozen=True)
class Disc(MirroredPrism):
    """A journal's cylinder as a prism of the raw part."""

    y_mm: float
    radius_mm: float

    @override
    def half_width_mm(self, y_mm: Array) -> Array:
        return np.asarray(np.sqrt(np.maximum(self.radius_mm**2 - (y_mm - self.y_mm) ** 2, 0.0)))

    @property
    @override
    def y_range_mm(self) -> tuple[float, float]:
        return self.y_mm - self.radius_mm, self.y_mm + self.radius_mm

    @override
    def solids(self) -> tuple[Solid, ...]:
        low, high = self.z_mm
        return (Cylinder((0.0, self.y_mm, low), (0.0, 0.0, high - low), self.radius_mm),)


class RawBody(Body):
    """A body of the raw part, by its half-width."""

    adds: ClassVar[bool] = True

    @abstractmethod
    def half_mm(self, y_mm: Array, z_mm: Array) -> Array:
        """Half of its width at places along the throw and heights; 0 where it is not."""

    @override
    def spans(self, y_mm: Array, z_mm: Array) -> Sequence[Span]:
        half = self.half_mm(y_mm, z_mm)
        return [(-half, half)]

    @property
    @override
    def changing_z_mm(self) -> tuple[tuple[float, float], ...]:
        return (self.z_mm,)


@dataclass(frozen=True)
class DraftedPrism(RawBody):
    """A prism with draft on its outline and on its faces, which rise toward the parting plane.

    Attributes:
        own: the prism without draft, as long as this one is in the parting plane.
        outline: its outline with draft.
        faces_mm: heights of its faces where it is widest.
        tilted: whether the lower and the upper face have draft.
        widest_mm: its largest half-width.
        draft_slope: tangent of the draft.
        land_mm: half-width at which the faces end in the flash.
    """

    own: Body
    outline: DraftedOutline
    faces_mm: tuple[float, float]
    tilted: tuple[bool, bool]
    widest_mm: float
    draft_slope: float
    land_mm: float

    @override
    def half_mm(self, y_mm: Array, z_mm: Array) -> Array:
        (low, high), (bottom, top) = self.z_mm, self.faces_mm
        beyond = np.maximum(np.maximum(bottom - z_mm, z_mm - top), 0.0)
        half = np.minimum(self.outline.half_width_mm(y_mm), self.widest_mm - beyond / self.draft_slope)
        return np.where((z_mm >= low) & (z_mm <= high), np.maximum(half, 0.0), 0.0)

    @property
    @override
    def y_range_mm(self) -> tuple[float, float]:
        return self.outline.y_range_mm

    @property
    @override
    def y_breaks_mm(self) -> tuple[float, ...]:
        return (*self.own.y_breaks_mm, *self.outline.corners_mm)

    @override
    def z_breaks_mm(self, y_mm: Array, half_width_mm: Array) -> list[Array]:
        rise = self.draft_slope * (self.widest_mm - self.outline.half_width_mm(y_mm))
        ends = [np.full(y_mm.shape, z) for z in (*self.z_mm, *self.faces_mm)]
        return [*ends, self.faces_mm[0] - rise, self.faces_mm[1] + rise]

    def profile_mm(self) -> tuple[tuple[float, float], ...]:
        """Corners (x, z) of what its faces leave, a little wider than it is."""
        wide, (low, high) = self.widest_mm + _BEYOND_MM, self.z_mm
        below, above = (_BEYOND_MM * (self.draft_slope if tilted else -1.0) for tilted in self.tilted)
        right = [(wide, self.faces_mm[0] + below), (wide, self.faces_mm[1] - above)]
        right = [
            *([(self.land_mm, low)] * self.tilted[0]),
            *right,
            *([(self.land_mm, high)] * self.tilted[1]),
        ]
        left = [(-x, z) for x, z in right[::-1] if x > 0]
        return (*right, *left)


@dataclass(frozen=True)
class Collar(RawBody):
    """A cone of 45 deg at the foot of a journal, with draft, in place of its fillet.

    Attributes:
        y_mm: place of the journal's axis along the throw.
        wide: height and radius of its wide end.
        narrow: those of its narrow end.
        draft: angle of its lines across the throw, rad, which in a section across the cone is more than its
            draft.
        land_mm: half-width at which they end in the flash.
    """

    y_mm: float
    wide: tuple[float, float]
    narrow: tuple[float, float]
    draft: float
    land_mm: float

    @override
    def half_mm(self, y_mm: Array, z_mm: Array) -> Array:
        (z0, wide), (z1, narrow) = self.wide, self.narrow
        away, inside = np.abs(y_mm - self.y_mm), (z_mm - z0) * (z_mm - z1) <= 0
        radius = wide + (narrow - wide) * (z_mm - z0) / (z1 - z0)
        line = (radius / math.cos(self.draft) - away) / math.tan(self.draft)
        arc = np.sqrt(np.maximum(radius**2 - away**2, 0.0))
        half = np.where(away <= radius * math.cos(self.draft), arc, line)
        return np.where(inside & (half >= self.land_mm), half, 0.0)

    @property
    @override
    def y_range_mm(self) -> tuple[float, float]:
        reach = self._reach_mm(self.wide[1])
        return self.y_mm - reach, self.y_mm + reach

    def _reach_mm(self, radius_mm: float) -> float:
        return radius_mm / math.cos(self.draft) - self.land_mm * math.tan(self.draft)

    @property
    @override
    def y_breaks_mm(self) -> tuple[float, ...]:
        radii = self.wide[1], self.narrow[1]
        reach = [length for r in radii for length in (self._reach_mm(r), r * math.cos(self.draft))]
        return tuple(self.y_mm + side * length for length in reach for side in (-1, 1))

    @override
    def z_breaks_mm(self, y_mm: Array, half_width_mm: Array) -> list[Array]:
        """Its ends, and heights at which its arcs and its lines end at a place along the throw."""
        (z0, wide), (z1, narrow) = self.wide, self.narrow
        away, cosine = np.abs(y_mm - self.y_mm), math.cos(self.draft)
        radii = away / cosine, (away + self.land_mm * math.tan(self.draft)) * cosine
        ends = [z0 + (radius - wide) / (narrow - wide) * (z1 - z0) for radius in radii]
        return [np.full(y_mm.shape, z0), np.full(y_mm.shape, z1), *ends]

    @override
    def solids(self) -> tuple[Solid, ...]:
        return (Loft(self._contour(*self.wide), self._contour(*self.narrow)),)

    def _contour(self, z: float, radius: float) -> tuple[Curve, ...]:
        """Arcs from line to line on both sides, the lines, and the land if it has one."""
        sine, cosine, reach = math.sin(self.draft), math.cos(self.draft), self._reach_mm(radius)

        def at(x: float, y: float) -> Point:
            return x, self.y_mm + y, z

        right = [at(self.land_mm, -reach), at(radius * sine, -radius * cosine), at(radius, 0.0)]
        right += [at(radius * sine, radius * cosine), at(self.land_mm, reach)]
        left = [(-x, y, height) for x, y, height in right[::-1]]
        centre, curves = at(0.0, 0.0), list[Curve]()
        for side in (right, left):
            curves += [LineSegment(side[0], side[1]), Arc(side[1], centre, side[2])]
            curves += [Arc(side[2], centre, side[3]), LineSegment(side[3], side[4])]
            if self.land_mm:
                curves.append(LineSegment(side[4], (-side[4][0], *side[4][1:])))
        return tuple(curves)


@dataclass(frozen=True)
class RawHalf(RawBody):
    """The raw half throw: webs less what the die leaves out of them, and what stands on them."""

    web: tuple[DraftedPrism, ...]
    cuts: tuple[Body, ...]
    journals: tuple[RawBody, ...]

    @override
    def half_mm(self, y_mm: Array, z_mm: Array) -> Array:
        web = [_cut_mm(part, cuts, y_mm, z_mm) for part, cuts in zip(self.web, self.cuts_of, strict=True)]
        return np.max([*web, *(one.half_mm(y_mm, z_mm) for one in self.journals)], axis=0)

    @cached_property
    def cuts_of(self) -> tuple[tuple[Body, ...], ...]:
        """Cuts of each part of the web: behind what is wider than the tool reaches the die leaves none."""
        return tuple(tuple(cut for cut in self.cuts if not _hides(part, cut)) for part in self.web)

    @property
    @override
    def y_range_mm(self) -> tuple[float, float]:
        lows, highs = zip(*(body.y_range_mm for body in (*self.web, *self.journals)), strict=True)
        return min(lows), max(highs)

    @property
    @override
    def y_breaks_mm(self) -> tuple[float, ...]:
        return tuple(y for body in (*self.web, *self.cuts, *self.journals) for y in body.y_breaks_mm)

    @override
    def z_breaks_mm(self, y_mm: Array, half_width_mm: Array) -> list[Array]:
        """Heights of its bodies' kinks, and those at which another body becomes the wider one."""
        bodies = (*self.web, *self.cuts, *self.journals)
        own = np.stack([z for body in bodies for z in body.z_breaks_mm(y_mm, half_width_mm)], axis=1)
        breaks = np.sort(np.clip(own, *self.z_mm), axis=1)
        found = np.array(breaks)
        for gap in self._gaps():
            row, height = roots(gap, y_mm, breaks)
            while len(row):  # some places have several
                first = np.unique(row, return_index=True)[1]
                column = np.array(breaks[:, 0])
                column[row[first]] = height[first]
                found = np.column_stack([found, column])
                row, height = np.delete(row, first), np.delete(height, first)
        return list(found.T)

    def _gaps(self) -> Iterator[_Width]:
        widths = [partial(_width_mm, body) for body in (*self.web, *self.cuts, *self.journals)]
        for one, other in combinations(widths, 2):
            yield partial(_apart_mm, one, other)


def _apart_mm(one: _Width, other: _Width, y_mm: Array, z_mm: Array) -> Array:
    return one(y_mm, z_mm) - other(y_mm, z_mm)


def _width_mm(body: Body, y_mm: Array, z_mm: Array) -> Array:
    return body.half_mm(y_mm, z_mm) if isinstance(body, RawBody) else _left_mm(body, y_mm, z_mm)


def _cut_mm(part: RawBody, cuts: Sequence[Body], y_mm: Array, z_mm: Array) -> Array:
    """Half-width that cuts leave of a part of the web, which elsewhere may be wider than they reach."""
    half = part.half_mm(y_mm, z_mm)
    for cut in cuts:
        for inner, outer in cut.spans(y_mm, z_mm):
            half = np.where((inner >= 0) & (inner < outer), np.minimum(half, inner), half)
    return half


def _hides(part: RawBody, cut: Body) -> bool:
    """Tell whether a part is somewhere wider than a cut reaches there."""
    y, z = np.linspace(*cut.y_range_mm, _PLACES)[:, None], np.linspace(*cut.z_mm, _HEIGHTS)
    half = part.half_mm(y, z)
    return any(
        bool(((inner < outer) & (half > outer) & (outer > 0)).any()) for inner, outer in cut.spans(y, z)
    )


def _left_mm(cut: Body, y_mm: Array, z_mm: Array) -> Array:
    """Half-width that a cut from both sides leaves; that of its own reach where it is not."""
    return np.asarray(np.max([np.where(a < b, a, b) for a, b in cut.spans(y_mm, z_mm)], axis=0))
