"""Holes along the crank axis, and the rules of all pockets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from typing_extensions import override

from cranktopo.base.arrays import Array, Mask
from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.base.spans import Span
from cranktopo.throw.feature import Body, ThrowView, least_shoulder_mm
from cranktopo.throw.primitives import Box, Cylinder, Solid


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


class JournalBore(RoundHole):
    """The bore of a journal where it runs through the web."""

    bore: ClassVar[bool] = True


def bore_holes(scene: ThrowView) -> list[JournalBore]:
    """Return the bores of main journal and crankpin where they run through the web, in that order."""
    names = ("main_journal", "crankpin")
    return [
        JournalBore(f"throw.{name}.bore_diameter_mm", scene.web_z_mm, 0.0, y, journal.bore_radius_mm)
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


def uncut_half_width_mm(scene: ThrowView, y_mm: Array) -> Array:
    """Return the half-width of the outline with its counterweight, nothing cut, at places along the throw."""
    half = scene.web.half_width_mm(scene.throw.radius_mm, y_mm)
    for part in scene.web.counterweight.parts(scene) if scene.web.counterweight is not None else ():
        half = np.maximum(half, part.half_width_mm(y_mm))
    return np.asarray(half)


def check_cut(scene: ThrowView, body: Body) -> None:
    """Refuse a body that takes nothing from the web, or that cuts a bore."""
    y = np.linspace(*body.y_range_mm, 401)
    half = uncut_half_width_mm(scene, y)
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
