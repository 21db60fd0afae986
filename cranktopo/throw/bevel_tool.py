"""Bodies that bevels take from a web: an arc swept across it, with a draft obliquely to either side."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import ClassVar, Self, cast

import numpy as np
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.spans import Span
from cranktopo.throw.bevel_arc import BevelArc
from cranktopo.throw.feature import Body
from cranktopo.throw.primitives import Arc, Curve, Extrusion, LineSegment, Point, Solid

_FLATTEST = 1e-4
_SAME_ARC = 1e-9
"""Distance of an arc of an ellipse from one of a circle, over its radius, up to which CAD has a cylinder."""


@dataclass(frozen=True)
class BevelTool(Body):
    """Cut of a bevel at its face, over the whole width; `into` is +1 if the web lies toward +z."""

    arc: BevelArc
    face_mm: float
    into: float
    wide_mm: float

    @override
    def spans(self, y_mm: Array, z_mm: Array) -> Sequence[Span]:
        cut = self.into * (z_mm - self.face_mm) < self.arc.depth_at_mm(self.arc.outward * y_mm)
        half = np.where(cut, self.wide_mm, 0.0)
        return [(-half, half)]

    @property
    @override
    def y_range_mm(self) -> tuple[float, float]:
        low, high = sorted(self.arc.outward * reach for reach in (self.arc.start_mm, self.arc.end_mm))
        return low, high

    @override
    def z_breaks_mm(self, y_mm: Array, half_width_mm: Array) -> list[Array]:
        return [self.face_mm + self.into * self.arc.depth_at_mm(self.arc.outward * y_mm)]

    @property
    @override
    def changing_z_mm(self) -> tuple[tuple[float, float], ...]:
        return (self.z_mm,)

    def solids(self) -> tuple[Solid, ...]:
        """Return the arc, continued along its tangent beyond the web, swept across."""
        arc, far = self.arc, self.arc.chord_mm
        slope = math.atan2(arc.end_mm - arc.start_mm, arc.depth_mm)
        slope -= 2 * math.atan(2 * arc.crown_mm / arc.chord_mm)
        deepest, top = arc.depth_mm + far * math.cos(slope), arc.end_mm + 2 * far
        corners = [(deepest, arc.end_mm + far * math.sin(slope)), (deepest, top)]
        corners += [(-far, top), (-far, arc.start_mm)]
        return (Extrusion(self._contour(corners, -self.wide_mm), (2 * self.wide_mm, 0.0, 0.0)),)

    def _contour(
        self, corners: Sequence[tuple[float, float]], x_mm: float, pieces: int = 1
    ) -> tuple[Curve, ...]:
        """Return the arc at a lateral place, closed by corners of so much depth and reach from its end on."""

        def point(depth_mm: float, reach_mm: float) -> Point:
            return x_mm, self.arc.outward * reach_mm, self.face_mm + self.into * depth_mm

        arc = self.arc
        start, end = point(0.0, arc.start_mm), point(arc.depth_mm, arc.end_mm)
        points = [end, *(point(*corner) for corner in corners), start]
        straight = [LineSegment(a, b) for a, b in pairwise(points)]
        if math.isinf(arc.radius_mm):
            return (LineSegment(start, end), *straight)
        centre, between = point(*arc.centre_mm), [point(*place) for place in arc.between_mm(pieces)]
        return (*(Arc(a, centre, b) for a, b in pairwise([start, *between, end])), *straight)


@dataclass(frozen=True)
class DraftedBevelTool(BevelTool):
    """The same of a bevel with a draft.

    Attributes:
        inner_mm: reach of its innermost point in the web.
        thickness_mm: that of the web.
        pieces: number of arcs that its own is given as.
    """

    inner_mm: float
    thickness_mm: float
    pieces: int = 1
    oblique: ClassVar[bool] = True

    @override
    def spans(self, y_mm: Array, z_mm: Array) -> Sequence[Span]:
        depth = self.into * (z_mm - self.face_mm)
        free = np.minimum(self.arc.from_mm(depth, self.arc.outward * y_mm), self.wide_mm)
        wide = np.full_like(free, self.wide_mm)
        return [(-wide, -free), (free, wide)]

    @property
    @override
    def y_range_mm(self) -> tuple[float, float]:
        low, high = sorted(self.arc.outward * reach for reach in (self.inner_mm, self.arc.end_mm))
        return low, high

    @property
    @override
    def y_breaks_mm(self) -> tuple[float, ...]:
        return (*self.y_range_mm, self.arc.outward * self.arc.start_mm)

    @override
    def z_breaks_mm(self, y_mm: Array, half_width_mm: Array) -> list[Array]:
        """Heights at which its surface meets x = 0 and the outline, and its arc ends in the tangents."""
        arc, reach = self.arc, self.arc.outward * y_mm
        depths = [arc.depth_at_mm(reach), arc.depth_at_mm(reach, half_width_mm)]
        if not math.isinf(arc.radius_mm):
            steep = (arc.end_mm - arc.start_mm) / arc.depth_mm
            ends = (arc.start_mm, 0.0), (arc.end_mm, arc.depth_mm)
            depths += [depth + steep * np.maximum(end - reach, 0.0) for end, depth in ends]
        return [self.face_mm + self.into * depth for depth in depths]

    @override
    def solids(self) -> tuple[Solid, ...]:
        """Return the arc, continued along its tangents beyond the web, swept obliquely to either side."""
        arc, far = self.arc, self.arc.drop * self.wide_mm
        long = 2 * (far + self.thickness_mm)
        above = far + arc.chord_mm
        (first, last), top = arc.end_angles, arc.end_mm + 2 * long
        deepest = arc.depth_mm + long * math.sin(last)
        corners = [(deepest, arc.end_mm + long * math.cos(last)), (deepest, top)]
        corners += [(-above, top), (-above, arc.start_mm - above / max(math.tan(first), _FLATTEST))]
        contour = self._contour(corners, 0.0, self.pieces)
        rise, run = arc.end_mm - arc.start_mm, arc.depth_mm
        path = -arc.outward * far * run / arc.chord_mm, self.into * far * rise / arc.chord_mm
        sides = (Extrusion(contour, (side * self.wide_mm, *path)) for side in (1, -1))
        return tuple(map(_upright, sides)) if self.pieces == 1 and self._is_round else tuple(sides)

    @override
    def in_pieces(self, count: int) -> Self:
        return replace(self, pieces=count)

    @property
    def _is_round(self) -> bool:
        """Tell whether its arc, which across the sweep is one of an ellipse, is as good as one of a circle.

        Both through the same ends with the same crown are sin2(draft) angle4 / 32 apart, over the radius.
        """
        slope, angle = self.arc.drop, self.arc.chord_mm / (2 * self.arc.radius_mm)
        return bool(0 < slope**2 / (1 + slope**2) * angle**4 / 32 < _SAME_ARC)


def _upright(swept: Extrusion) -> Extrusion:
    """Return a bevel's tool of one side, swept at right angles to its contour: a cylinder where it is curved.

    It begins beyond x = 0, where it takes less than the tool of the other side.
    """
    (bend,) = (curve for curve in swept.contour if isinstance(curve, Arc))
    lines = [curve for curve in swept.contour if isinstance(curve, LineSegment)]
    path, middle = np.array(swept.path), (np.array(bend.start) + bend.end) / 2
    along = path / np.linalg.norm(path)
    back = max(abs((np.array(line.start) - middle) @ along) for line in lines)

    def flat(point: Point) -> Point:
        place = np.array(point)
        return _point(place - ((place - middle) @ along + back) * along)

    straight = (LineSegment(flat(line.start), flat(line.end)) for line in lines)
    arc = _round(Arc(flat(bend.start), flat(bend.centre), flat(bend.end)), math.dist(bend.start, bend.centre))
    return Extrusion((arc, *straight), _point(path + 2 * back * along))


def _round(flat: Arc, radius_mm: float) -> Arc:
    """Return the circle through both ends and the crown of an arc that was one before it was made flat.

    Args:
        flat: its ends lie as they did; its centre has come nearer to them, as its crown has.
        radius_mm: that it had.
    """
    start, centre, end = map(np.array, (flat.start, flat.centre, flat.end))
    middle, half = (start + end) / 2, math.dist(flat.start, flat.end) / 2
    aside, deep = centre - middle, math.sqrt(radius_mm**2 - half**2)
    near = float(np.linalg.norm(aside))
    crown = (radius_mm - deep) * near / deep
    return Arc(flat.start, _point(middle + aside * (half**2 - crown**2) / (2 * crown * near)), flat.end)


def _point(place: Array) -> Point:
    return cast(Point, tuple(place.tolist()))
