"""Holes along the crank axis, slots from both sides, and their rules."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from typing_extensions import override

from cranktopo.base.arrays import Array, Mask
from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.base.spans import Span
from cranktopo.throw.feature import Body, ThrowView, least_shoulder_mm
from cranktopo.throw.primitives import Box, Cylinder, Frustum, Solid
from cranktopo.throw.tapered_hole import rounded_gap_mm

BEYOND_MM = 1.0
"""Reach of the tool of a sloped slot beyond the outline, and of a groove beyond both of its ends."""
_CORNERS = ((-1, -1), (1, -1), (1, 1), (-1, 1))


@dataclass(frozen=True)
class SideSlots(Body):
    """Both slots of a side pocket: the floor at |x| = `floor_mm`, where y, z, half sizes and corners count.

    The tool ends at |x| = `outer_mm`, beyond the outline; each wall opens by `slope` mm per mm of |x|.
    """

    floor_mm: float
    outer_mm: float
    y_mm: float
    half_length_mm: float
    z_centre_mm: float
    half_height_mm: float
    slope: float
    corner_mm: float = 0.0

    @override
    def spans(self, y_mm: Array, z_mm: Array) -> Sequence[Span]:
        inner = np.minimum(self.open_from_mm(y_mm, z_mm), self.outer_mm)
        return [(inner, np.full_like(inner, self.outer_mm)), (np.full_like(inner, -self.outer_mm), -inner)]

    def open_from_mm(self, y_mm: Array, z_mm: Array | float) -> Array:
        """|x| from which the slots are open; infinite where they are not."""
        along = np.abs(y_mm - self.y_mm) - self.half_length_mm
        height = np.abs(z_mm - self.z_centre_mm) - self.half_height_mm
        rounded = self.corner_mm > 0
        beyond = rounded_gap_mm(along, height, self.corner_mm) if rounded else np.maximum(along, height)
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
        halves = {self.half_length_mm, self.half_length_mm - self.corner_mm}
        return (*self.y_range_mm, *(self.y_mm + side * half for half in sorted(halves) for side in (-1, 1)))

    def z_breaks_mm(self, y_mm: Array, half_width_mm: Array) -> list[Array]:
        """Edges of the floor, or of the end wall beyond it, and of the opening in the outline."""
        away, opening = np.abs(y_mm - self.y_mm), self.slope * (half_width_mm - self.floor_mm)
        if self.corner_mm:
            straight = self.half_height_mm - self.corner_mm
            bend = np.maximum(away - self.half_length_mm + self.corner_mm, 0.0)
            radii = (self.corner_mm, self.corner_mm + np.maximum(opening, 0.0))
            arcs = (straight + np.sqrt(np.maximum(radius**2 - bend**2, 0.0)) for radius in radii)
            halves = [np.full(y_mm.shape, straight), *arcs]
        else:
            halves = [np.maximum(self.half_height_mm, self.half_height_mm + away - self.half_length_mm)]
            halves.append(self.half_height_mm + opening)
        return [self.z_centre_mm + side * half for half in halves for side in (-1, 1)]

    @property
    @override
    def changing_z_mm(self) -> tuple[tuple[float, float], ...]:
        floor, opening = self.half_height_mm, self.slope * (self.outer_mm - self.floor_mm - BEYOND_MM)
        heights = [floor - self.corner_mm, floor, floor + opening]
        z, parts = self.z_centre_mm, [(low, high) for low, high in pairwise(heights) if high > low]
        return (*((z - high, z - low) for low, high in parts), *((z + low, z + high) for low, high in parts))

    @override
    def solids(self) -> tuple[Solid, ...]:
        return self._side(1.0), self._side(-1.0)

    def _side(self, side: float) -> Solid:
        if self.slope == 0 and not self.corner_mm:
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
        return Frustum(floor, mouth, (radius, radius + more) if radius else (0.0, 0.0))


@dataclass(frozen=True)
class RoundHole(Body):
    """A round hole parallel to the crank axis: its centre and radius."""

    x_mm: float
    y_mm: float
    radius_mm: float

    @override
    def spans(self, y_mm: Array, z_mm: Array) -> Sequence[Span]:
        half = np.sqrt(np.maximum(self.radius_mm**2 - (y_mm - self.y_mm) ** 2, 0.0))
        half = np.where(_within(z_mm, self.z_mm), half, 0.0)
        return [(self.x_mm - half, self.x_mm + half)]

    @property
    @override
    def y_range_mm(self) -> tuple[float, float]:
        return self.y_mm - self.radius_mm, self.y_mm + self.radius_mm

    def distance_mm(self, y_mm: float, z_mm: float) -> float:
        """Distance of the hole's edge from the axis (0, y), mm; negative if it covers the axis."""
        return float(np.hypot(self.x_mm, self.y_mm - y_mm)) - self.radius_mm

    @override
    def continued(self, z_mm: tuple[float, float]) -> tuple[Solid, ...]:
        low, high = z_mm
        return (Cylinder((self.x_mm, self.y_mm, low), (0.0, 0.0, high - low), self.radius_mm),)


@dataclass(frozen=True)
class RectangularHole(Body):
    """A rectangular hole parallel to the crank axis: its corners."""

    low_mm: tuple[float, float]
    high_mm: tuple[float, float]

    @override
    def spans(self, y_mm: Array, z_mm: Array) -> Sequence[Span]:
        inside = (y_mm > self.low_mm[1]) & (y_mm < self.high_mm[1]) & _within(z_mm, self.z_mm)
        start = np.full(inside.shape, self.low_mm[0])
        return [(start, np.where(inside, self.high_mm[0], start))]

    @property
    @override
    def y_range_mm(self) -> tuple[float, float]:
        return self.low_mm[1], self.high_mm[1]

    def distance_mm(self, y_mm: float, z_mm: float) -> float:
        """Distance of the hole's edge from the axis (0, y), mm; 0 if it covers the axis."""
        (x0, y0), (x1, y1) = self.low_mm, self.high_mm
        return float(np.hypot(max(x0, -x1, 0.0), max(y0 - y_mm, y_mm - y1, 0.0)))

    @override
    def continued(self, z_mm: tuple[float, float]) -> tuple[Solid, ...]:
        (x0, y0), (x1, y1), (low, high) = self.low_mm, self.high_mm, z_mm
        return (Box((x0, y0, low), (x1 - x0, y1 - y0, high - low)),)


def bore_holes(scene: ThrowView) -> list[RoundHole]:
    """Return the bores of main journal and crankpin where they run through the web, in that order."""
    names = ("main_journal", "crankpin")
    return [
        RoundHole(f"throw.{name}.bore_diameter_mm", scene.web_z_mm, 0.0, y, journal.bore_radius_mm)
        for name, (journal, y) in zip(names, scene.throw.journals, strict=True)
        if journal.bore_diameter_mm
    ]


def depth_range_mm(scene: ThrowView, face: str, depth_mm: float | None) -> tuple[float, float]:
    """Axial range of a pocket from a web face; through the web without a depth."""
    start, end = scene.web_z_mm
    if depth_mm is None:
        return start, end
    return (start, start + depth_mm) if face == "journal" else (end - depth_mm, end)


def check_depth(scene: ThrowView, key: str, depth_mm: float) -> None:
    """Refuse a depth or height, named by its key, that goes through the whole web."""
    thickness = scene.web.thickness_mm
    if depth_mm >= thickness:
        allowed = f"must be smaller than web.thickness_mm = {thickness:g} mm"
        raise invalid(key, depth_mm, allowed, "Reduce the pocket or thicken the web.")


def check_cut(scene: ThrowView, body: Body) -> None:
    """Refuse a body that takes nothing from the web, or that cuts a bore."""
    y = np.linspace(*body.y_range_mm, 401)
    half = scene.web.half_width_mm(scene.throw.radius_mm, y)
    for part in scene.web.counterweight.parts(scene) if scene.web.counterweight is not None else ():
        half = np.maximum(half, part.half_width_mm(y))
    middle = sum(body.z_mm) / 2
    spans = body.spans(y, np.asarray(middle))
    if not any((np.minimum(end, half) - np.maximum(start, -half) > 0).any() for start, end in spans):
        raise CranktopoError(
            f"{body.key}: lies outside the web's outline and removes nothing.", hint="Move or remove it."
        )
    least = least_shoulder_mm(scene.throw)
    for bore in bore_holes(scene):
        if body.distance_mm(bore.y_mm, middle) - bore.radius_mm < least:
            raise CranktopoError(
                f"{body.key}: cuts the bore {bore.key} = {2 * bore.radius_mm:g} mm.",
                hint=f"Keep at least {least:.3g} mm of web between the pocket and the bore.",
            )


def check_corners(scene: ThrowView, key: str, radius_mm: float, *sizes_mm: float) -> None:
    """Refuse a radius, named by its key, that a pocket of these sizes does not hold."""
    most = min(sizes_mm) / 2
    if radius_mm > most:
        raise scene.invalid(key, f"must be at most half of the pocket's smaller size ({most:g} mm)")


FACES: tuple[Literal["journal"], Literal["pin"]] = ("journal", "pin")
"""Faces that the journals stand on, in the order of the throw."""


def check_open(scene: ThrowView, body: Body, faces: Sequence[Literal["journal", "pin"]]) -> None:
    """Refuse a body from web faces at which the journals, their fillets included, cover all of it."""
    y = np.linspace(*body.y_range_mm, 401)
    covering = {"journal": "throw.main_journal", "pin": "throw.crankpin"}
    for face, (journal, axis) in zip(FACES, scene.throw.journals, strict=True):
        if face not in faces:
            continue
        reach = max(
            float(np.hypot(np.maximum(np.abs(start), np.abs(end)), y - axis).max())
            for start, end in body.spans(y, np.asarray(sum(body.z_mm) / 2))
        )
        if reach >= journal.radius_mm + journal.fillet_mm:
            return
    under = " and ".join(covering[face] for face in faces)
    raise CranktopoError(
        f"{body.key}: lies under {under}: no tool reaches it, and it would be a closed hollow.",
        hint="Move it until its mouth is open, or make it a bore of the journal.",
    )


def _within(z_mm: Array, z_range_mm: tuple[float, float]) -> Mask:
    return np.asarray((z_mm >= z_range_mm[0]) & (z_mm <= z_range_mm[1]))
