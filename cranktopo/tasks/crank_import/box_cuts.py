"""Box-shaped cuts of a half throw: a floor, the walls around it, and the radii of its corners and edges."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.tasks.importing.faces import FLAT, Faces, PlaneFace
from cranktopo.throw.floor_rounding import FloorRounding

_STEEPEST = 0.5
"""Least part across its floor of the normal of a wall: a draft of 60 deg."""
_WIDER = 1.05
"""Way of a wall's middle beside the floor's, over the half length that the floor's area leaves for it."""
_Range = tuple[float, float]


@dataclass(frozen=True)
class BoxCut:
    """A cut that opens along `out`; all places are those of its floor, where the walls meet it.

    Attributes:
        floor_mm: place of the floor along `out`.
        first_mm, second_mm: places of the walls along `across`; infinite where there is none.
        slope: by which the walls open per mm of depth.
    """

    out: Array
    across: tuple[Array, Array]
    floor_mm: float
    first_mm: _Range
    second_mm: _Range
    slope: float
    corner_mm: float = 0.0
    floor_radius_mm: float = 0.0

    @property
    def draft_deg(self) -> float:
        """Angle by which the walls open."""
        return math.degrees(math.atan(self.slope))


def box_cuts(faces: Faces, out: Array, across: tuple[Array, Array], near_mm: float) -> Iterator[BoxCut]:
    """Yield the cuts that open along a direction between two walls of the second axis at least.

    Args:
        across: the axes along which the walls stand.
        near_mm: distance of faces that touch.
    """
    first, second = across
    for floor in faces.planes:
        if float(floor.normal @ out) < 1 - FLAT:
            continue
        walls = [
            _wall(faces.planes, floor, sign * way, beside)
            for way, beside in ((first, second), (second, first))
            for sign in (-1.0, 1.0)
        ]
        slopes = [wall[1] for wall in walls if wall is not None]
        if (
            walls[2] is None
            or walls[3] is None
            or np.ptp(slopes) > FLAT + near_mm / math.sqrt(floor.area_mm2)
        ):
            continue
        away = [math.inf if wall is None else wall[0] for wall in walls]
        u, v = (float(floor.point_mm @ way) for way in across)
        plain = BoxCut(
            out,
            across,
            float(floor.point_mm @ out),
            (u - away[0], u + away[1]),
            (v - away[2], v + away[3]),
            float(np.mean(slopes)),
        )
        yield _rounded(faces, plain, near_mm)


def _wall(
    planes: Sequence[PlaneFace], floor: PlaneFace, way: Array, beside: Array
) -> tuple[float, float] | None:
    """Return distance and slope of the wall nearest to a floor's middle on one side; None without one."""
    found = []
    for plane in planes:
        facing, up = -float(plane.normal @ way), float(plane.normal @ floor.normal)
        if facing < _STEEPEST or up < -FLAT or abs(plane.normal @ beside) > FLAT:
            continue
        apart = plane.point_mm - floor.point_mm
        half = -float(plane.normal @ apart) / facing
        if half <= 0 or apart @ floor.normal <= 0:
            continue
        if abs(apart @ beside) < _WIDER * floor.area_mm2 / (4 * half):
            found.append((half, max(up, 0.0) / facing))
    return min(found, default=None)


def _rounded(faces: Faces, cut: BoxCut, near_mm: float) -> BoxCut:
    """Return a cut with the radius of its floor's edge, and that of its corners."""
    edged = replace(cut, floor_radius_mm=next(_floor_radii_mm(faces, cut, near_mm), 0.0))
    corners = (
        radius
        for place, radius in _corners(faces, cut)
        if all(
            min(abs(place @ way - radius - low), abs(place @ way + radius - high)) < near_mm
            for way, (low, high) in zip(cut.across, (cut.first_mm, cut.second_mm), strict=True)
        )
    )
    return replace(edged, corner_mm=next(corners, 0.0))


def _floor_radii_mm(faces: Faces, cut: BoxCut, near_mm: float) -> Iterator[float]:
    """Yield radii of cylinders that touch the floor and a wall inside."""
    low, high = cut.second_mm
    for face in faces.cylinders:
        if face.outward or abs(face.axis @ cut.across[0]) < 1 - FLAT:
            continue
        foot = FloorRounding(face.radius_mm, cut.slope).foot_mm
        above, place = face.point_mm @ cut.out - cut.floor_mm, float(face.point_mm @ cut.across[1])
        beside = min(abs(place - foot - low), abs(place + foot - high))
        if abs(above - face.radius_mm) < near_mm and beside < near_mm:
            yield face.radius_mm


def _corners(faces: Faces, cut: BoxCut) -> Iterator[tuple[Array, float]]:
    """Yield a point on the axis of each concave corner along a cut, and its radius at the floor."""
    for face in faces.cylinders:
        if not face.outward and not face.full and abs(face.axis @ cut.out) > 1 - FLAT:
            yield face.point_mm, face.radius_mm
    for cone in faces.cones:
        if cone.outward or cone.full or abs(cone.axis @ cut.out) < 1 - FLAT:
            continue
        (low, high), radii = (float(end @ cut.out) for end in cone.ends_mm), cone.radii_mm
        if low != high:
            slope = (radii[1] - radii[0]) / (high - low)
            yield cone.ends_mm[0], radii[0] + slope * (cut.floor_mm - low)
