"""Ends of an oil drilling: tables, outlets, and the ring that the rounding of an outlet takes out.

The ring is what a ball leaves that rolls around the edge inside. Its section at every angle about the
drilling has three corners: the edge of the sharp outlet, and where the ball touches drilling and journal.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal, cast

import numpy as np
from pydantic import Field

from cranktopo.base.arrays import Array
from cranktopo.base.table import LengthOrZero, SceneTable

Surface = Literal["main_journal", "crankpin", "main_journal_bore", "crankpin_bore"]
_BORE = "_bore"


class DrillingEnd(SceneTable):
    """One end of a drilling: a point on a journal, or on the wall of its axial bore."""

    on: Surface = Field(examples=["main_journal"])
    """The surface: of a journal, or of its axial bore, where the drilling ends in that."""
    angle_deg: float = Field(ge=-360, le=360, examples=[180.0])
    """Angle about that journal's axis: 0 points from the crank axis to the crankpin, 90 to +x, 180 back."""
    place_mm: LengthOrZero = Field(examples=[5.0])
    """Distance from the middle of that journal toward the web."""

    @property
    def in_bore(self) -> bool:
        """True if it lies on the wall of an axial bore."""
        return self.on.endswith(_BORE)

    @property
    def journal_key(self) -> str:
        """Key of its journal in the throw."""
        return self.on.removesuffix(_BORE)


class DrillingSecondEnd(DrillingEnd):
    """The other end of a drilling, given in the same way."""

    on: Surface = Field(examples=["crankpin"])
    """The surface, as of the first end."""
    angle_deg: float = Field(ge=-360, le=360, examples=[0.0])
    """Angle about that journal's axis, as of the first end."""


@dataclass(frozen=True)
class DrillOutlet:
    """Meeting of a drilling with the surface of a journal or the wall of a bore.

    Attributes:
        point_mm: (x, y, z) where the axis meets the surface.
        outward: unit vector of the axis, away from the rest of the drilling.
        y_mm: place of the journal's axis along the throw.
        surface_mm: radius of the surface; 0 where the axial bore is left out.
        journal: key of the journal in the throw.
    """

    point_mm: tuple[float, float, float]
    outward: tuple[float, float, float]
    y_mm: float
    surface_mm: float
    in_bore: bool
    rounding_mm: float
    journal: str

    @property
    def normal(self) -> Array:
        """Unit vector (x, y, z) out of the material."""
        radial = np.array([self.point_mm[0], self.point_mm[1] - self.y_mm, 0.0])
        length = float(np.hypot(*radial[:2]))
        if not length:  # a bore that is left out: the drilling ends at its axis
            return np.array(self.outward)
        return radial / (-length if self.in_bore else length)

    @property
    def obliquity_deg(self) -> float:
        """Angle between the drilling and the normal of the surface; above 90 it lies outside the material."""
        return math.degrees(math.acos(float(np.clip(self.normal @ np.array(self.outward), -1, 1))))

    def mirrored(self) -> DrillOutlet:
        """Return its mirror image in x = 0."""
        (x, y, z), (dx, dy, dz) = self.point_mm, self.outward
        return replace(self, point_mm=(-x, y, z), outward=(-dx, dy, dz))

    def in_second_half(self, pitch_mm: float) -> DrillOutlet:
        """Return it as one of the half throw beyond the crankpin, in the frame of the throw of that pitch."""
        (x, y, z), (dx, dy, dz) = self.point_mm, self.outward
        return replace(self, point_mm=(x, y, pitch_mm - z), outward=(dx, dy, -dz))

    def moved(self, by_mm: float) -> DrillOutlet:
        """Return it farther along the crank."""
        x, y, z = self.point_mm
        return replace(self, point_mm=(x, y, z + by_mm))

    def height_mm(self, offsets_mm: Array, radius_mm: float) -> Array:
        """Return how far beyond `point_mm` lines (n, 3) beside the axis pass a cylinder about the journal."""
        foot = np.array(self.point_mm) + offsets_mm - np.array([0.0, self.y_mm, 0.0])
        across = np.array(self.outward)[:2]
        a, b = float(across @ across), foot[:, :2] @ across
        c = (foot[:, :2] ** 2).sum(axis=1) - radius_mm**2
        root = np.sqrt(np.maximum(b**2 - a * c, 0.0))
        return cast(Array, (-b + (-root if self.in_bore else root)) / a)


def across(direction: Array) -> tuple[Array, Array]:
    """Two unit vectors at right angles to a direction and to each other."""
    one = np.cross(direction, np.eye(3)[int(np.abs(direction).argmin())])
    one /= np.linalg.norm(one)
    return one, np.cross(direction, one)


def ring_points(radius_mm: float, outlet: DrillOutlet, turn: Array, arc: Array, out: Array) -> Array:
    """Return points (n, 3) of the ring around a drilling of a radius, mm.

    Args:
        turn: angle about the drilling, rad.
        arc: 0 where the ball touches the drilling, 1 where it touches the journal.
        out: 0 on the edge of the sharp outlet, 1 on the rounding.
    """
    spoke = _spokes(outlet, turn)
    edge = _at(outlet, radius_mm * spoke, outlet.surface_mm)
    ball = ball_way_mm(radius_mm, outlet, turn)
    normal = ball - np.array([0.0, outlet.y_mm, 0.0])
    normal[:, 2] = 0.0
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    rounding = ball + outlet.rounding_mm * _between(-spoke, normal, arc)
    straight = edge + out[:, None] * (rounding - edge)
    return (1 - arc)[:, None] * straight + arc[:, None] * _around(outlet.y_mm, edge, rounding, out)


def ball_way_mm(radius_mm: float, outlet: DrillOutlet, turn: Array) -> Array:
    """Return the centres (n, 3) of the ball that rolls around a drilling of a radius, by its angles."""
    wide, deep = radius_mm + outlet.rounding_mm, outlet.surface_mm - outlet.rounding_mm
    return _at(outlet, wide * _spokes(outlet, turn), deep)


def _spokes(outlet: DrillOutlet, turn: Array) -> Array:
    one, other = across(np.array(outlet.outward))
    return np.cos(turn)[:, None] * one + np.sin(turn)[:, None] * other


def _at(outlet: DrillOutlet, offsets_mm: Array, radius_mm: float) -> Array:
    heights = outlet.height_mm(offsets_mm, radius_mm)
    return cast(Array, np.array(outlet.point_mm) + offsets_mm + heights[:, None] * np.array(outlet.outward))


def _between(first: Array, second: Array, share: Array) -> Array:
    angle = np.arccos(np.clip((first * second).sum(axis=1), -1, 1))
    one, other = (np.sin(part * angle) / np.sin(angle) for part in (1 - share, share))
    return cast(Array, one[:, None] * first + other[:, None] * second)


def _around(y_mm: float, first: Array, second: Array, share: Array) -> Array:
    """Points between two others, on the helix about the journal's axis that joins them."""
    ends = [_cylindrical(y_mm, points) for points in (first, second)]
    turn = (ends[1][1] - ends[0][1] + np.pi) % (2 * np.pi) - np.pi
    radius = ends[0][0] + share * (ends[1][0] - ends[0][0])
    angle = ends[0][1] + share * turn
    z = first[:, 2] + share * (second[:, 2] - first[:, 2])
    return np.stack([radius * np.sin(angle), y_mm + radius * np.cos(angle), z], axis=1)


def _cylindrical(y_mm: float, points: Array) -> tuple[Array, Array]:
    x, y = points[:, 0], points[:, 1] - y_mm
    return np.hypot(x, y), np.arctan2(x, y)
