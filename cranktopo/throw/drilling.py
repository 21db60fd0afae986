"""Oil drillings of a throw: straight holes between the surfaces of its journals, their outlets rounded.

A drilling is described in the half throw of its web and is in both halves, the far one the mirror image, or
in one of them alone: then its outlet may reach across the middle of the crankpin.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Literal, Self, cast, get_args

import numpy as np
from pydantic import Field

from cranktopo.base.arrays import Array
from cranktopo.base.spans import Section, Span
from cranktopo.base.table import Length, LengthOrZero, SceneTable

if TYPE_CHECKING:
    from cranktopo.throw.geometry import Journal, ThrowTable
    from cranktopo.throw.throw_view import ThrowView

Surface = Literal["main_journal", "crankpin", "main_journal_bore", "crankpin_bore"]
SURFACES: tuple[Surface, ...] = get_args(Surface)
_BORE = "_bore"
_DIGITS = 6
_PARALLEL = 1e-9
"""Sine of an angle that counts as none."""
_CIRCLE = 180
_ALL = -math.inf, math.inf
_BEYOND = 0.25
"""What the tool reaches beyond the surface over the drilling's radius."""


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
        """Whether it lies on the wall of an axial bore."""
        return self.on.endswith(_BORE)

    @property
    def journal_key(self) -> str:
        """Key of its journal in the throw."""
        return self.on.removesuffix(_BORE)


class DrillingFarEnd(DrillingEnd):
    """The other end of a drilling, given in the same way."""

    on: Surface = Field(examples=["crankpin"])
    """The surface, as of the first end."""
    angle_deg: float = Field(ge=-360, le=360, examples=[0.0])
    """Angle about that journal's axis, as of the first end."""


class Drilling(SceneTable):
    """A straight oil drilling through one web and its journals, or through either web alike.

    It joins two surfaces of the journals. No optimiser fills it, and a wall as thick as half its diameter
    stays around it.
    """

    start: DrillingEnd = Field(
        default=DrillingEnd(on="main_journal", angle_deg=180.0, place_mm=0.0), alias="from"
    )
    """Where it begins; by default in the middle of the main journal, away from the crankpin."""
    end: DrillingFarEnd = Field(
        default=DrillingFarEnd(on="crankpin", angle_deg=0.0, place_mm=0.0), alias="to"
    )
    """Where it ends; by default in the middle of the crankpin, away from the crank axis."""
    diameter_mm: Length = Field(examples=[5.0])
    """Its diameter."""
    outlet_radius_mm: LengthOrZero = 0.0
    """Radius of the rounding of its outlets on the journals; 0 = sharp. Ends in a bore stay sharp."""
    web: Literal["both", "first", "second"] = "both"
    """The web that it runs through; `both`: the half throw beyond the crankpin has its mirror image."""

    def mirrored(self) -> Self:
        """Its mirror image in x = 0."""
        ends = {
            name: end.model_copy(update={"angle_deg": -end.angle_deg})
            for name, end in (("start", self.start), ("end", self.end))
        }
        return self.model_copy(update=ends)


@dataclass(frozen=True)
class DrillOutlet:
    """Where a drilling meets the surface of a journal or the wall of a bore.

    Attributes:
        point_mm: (x, y, z) where the axis meets the surface.
        outward: unit vector of the axis, away from the rest of the drilling.
        y_mm: place of the journal's axis along the throw.
        surface_mm: radius of the surface; 0 where the axial bore is left out.
        in_bore: whether it is the wall of an axial bore.
        rounding_mm: radius of its rounding.
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

    def in_far_half(self, pitch_mm: float) -> DrillOutlet:
        """A mouth of the half throw beyond the crankpin, in the frame of the throw of that pitch."""
        (x, y, z), (dx, dy, dz) = self.point_mm, self.outward
        return replace(self, point_mm=(x, y, pitch_mm - z), outward=(dx, dy, -dz))

    def height_mm(self, offsets_mm: Array, radius_mm: float) -> Array:
        """How far along the axis beyond `point_mm` lines parallel to it pass a cylinder about the journal.

        Args:
            offsets_mm: (n, 3) of the lines from the axis.
            radius_mm: of that cylinder.
        """
        foot = np.array(self.point_mm) + offsets_mm - np.array([0.0, self.y_mm, 0.0])
        across = np.array(self.outward)[:2]
        a, b = float(across @ across), foot[:, :2] @ across
        c = (foot[:, :2] ** 2).sum(axis=1) - radius_mm**2
        root = np.sqrt(np.maximum(b**2 - a * c, 0.0))
        return cast(Array, (-b + (-root if self.in_bore else root)) / a)


@dataclass(frozen=True)
class DrillBore:
    """A drilling as a body: a cylinder that reaches just beyond the surfaces at both its ends.

    Attributes:
        key: key path in the scene, for messages.
        alone: the other half has no mirror image of it, so that it does not end at the mid-pin plane.
    """

    key: str
    radius_mm: float
    mouths: tuple[DrillOutlet, DrillOutlet]
    alone: bool = False

    @property
    def direction(self) -> Array:
        """Unit vector (x, y, z) from its first end to its second."""
        return np.array(self.mouths[1].outward)

    @property
    def length_mm(self) -> float:
        """Length of its axis between the two surfaces."""
        return math.dist(self.mouths[0].point_mm, self.mouths[1].point_mm)

    @property
    def reach_mm(self) -> float:
        """Radius with the larger rounding: what it needs of a surface."""
        return self.radius_mm + max(mouth.rounding_mm for mouth in self.mouths)

    @property
    def around(self) -> Array:
        """Unit vectors (n, 3) all around its axis."""
        angle = np.linspace(0, 2 * np.pi, _CIRCLE, endpoint=False)[:, None]
        one, other = across(self.direction)
        return np.asarray(np.cos(angle) * one + np.sin(angle) * other)

    @property
    def extent_mm(self) -> tuple[float, float]:
        """Where the tool begins and ends along the axis, from the first end on."""
        before, after = (self._beyond_mm(mouth) for mouth in self.mouths)
        return -before, self.length_mm + after

    def _beyond_mm(self, mouth: DrillOutlet) -> float:
        if not mouth.surface_mm:
            return 0.0
        heights = mouth.height_mm(self.radius_mm * self.around, mouth.surface_mm)
        return float(heights.max()) + _BEYOND * self.radius_mm

    def in_far_half(self, pitch_mm: float) -> DrillBore:
        """A channel of the half throw beyond the crankpin, in the frame of the throw of that pitch."""
        one, other = (mouth.in_far_half(pitch_mm) for mouth in self.mouths)
        return replace(self, mouths=(one, other))

    def surface_mm(self, radius_mm: float, steps: int = 200) -> Array:
        """Points (n, 3) on a cylinder about its axis, over the whole tool."""
        places = np.linspace(*self.extent_mm, steps)[:, None, None]
        start = np.array(self.mouths[0].point_mm)
        points = start + places * self.direction + radius_mm * self.around[None]
        return points.reshape(-1, 3)

    def section(self, radius_mm: float) -> Section:
        """Section of a cylinder of a radius about its axis, as long as the tool."""
        (x0, y0, z0), (dx, dy, dz) = self.mouths[0].point_mm, self.direction.tolist()
        across, (first, last) = max(1 - dx**2, _PARALLEL), self.extent_mm

        def spans(y_mm: Array, z_mm: Array) -> list[Span]:
            along = (y_mm - y0) * dy + (z_mm - z0) * dz
            middle = dx * along / across
            free = radius_mm**2 - (y_mm - y0) ** 2 - (z_mm - z0) ** 2 + along**2
            half = np.sqrt(np.maximum(free / across + middle**2, 0.0))
            low, high = _between(dx, first - along, last - along)
            return [(x0 + np.maximum(middle - half, low), x0 + np.minimum(middle + half, high))]

        return spans

    def box_mm(self, radius_mm: float, z_mm: tuple[float, float] = _ALL) -> tuple[Array, Array]:
        """Least and largest x, y and z of such a cylinder between two heights, in which it must be."""
        start, along = np.array(self.mouths[0].point_mm), self.direction
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

    def distance_mm(self, x_mm: Array, y_mm: Array, z_mm: Array) -> Array:
        """Distance of points from the axis of the tool, broadcastable."""
        start, along = np.array(self.mouths[0].point_mm), self.direction
        offset = [np.asarray(p) - s for p, s in zip((x_mm, y_mm, z_mm), start, strict=True)]
        place = np.clip(sum(o * d for o, d in zip(offset, along, strict=True)), *self.extent_mm)
        square = sum((o - place * d) ** 2 for o, d in zip(offset, along, strict=True))
        return cast(Array, np.sqrt(square))


def _between(slope: float, low: Array, high: Array) -> tuple[Array, Array]:
    """Interval in which slope times a value lies between two ends."""
    if abs(slope) < _PARALLEL:
        inside = (low <= 0) & (high >= 0)
        return np.where(inside, -np.inf, np.inf), np.where(inside, np.inf, -np.inf)
    ends = low / slope, high / slope
    return np.minimum(*ends), np.maximum(*ends)


def across(direction: Array) -> tuple[Array, Array]:
    """Two unit vectors at right angles to a direction and to each other."""
    one = np.cross(direction, np.eye(3)[int(np.abs(direction).argmin())])
    one /= np.linalg.norm(one)
    return one, np.cross(direction, one)


def drill_bores(scene: ThrowView) -> tuple[DrillBore, ...]:
    """The drillings of the half throw as bodies; none for most throws."""
    return _channels(scene.throw, scene.web_z_mm, scene.pitch_mm) if scene.throw.drilling else ()


@lru_cache(maxsize=16)
def _channels(throw: ThrowTable, web_z_mm: tuple[float, float], pitch_mm: float) -> tuple[DrillBore, ...]:
    return tuple(
        _channel(throw, pitch_mm, drilling, f"throw.drilling[{index}]")
        for index, drilling in enumerate(throw.drilling)
    )


def _channel(throw: ThrowTable, pitch_mm: float, drilling: Drilling, key: str) -> DrillBore:
    ends = drilling.start, drilling.end
    first, second = (np.array(_point(throw, pitch_mm, end)) for end in ends)
    length = float(np.linalg.norm(second - first))
    along = (second - first) / length if length else np.zeros(3)
    mouths = tuple(
        _mouth(throw, end, point, sign * along, drilling.outlet_radius_mm)
        for end, point, sign in zip(ends, (first, second), (-1, 1), strict=True)
    )
    return DrillBore(key, drilling.diameter_mm / 2, (mouths[0], mouths[1]), drilling.web != "both")


def _point(throw: ThrowTable, pitch_mm: float, end: DrillingEnd) -> tuple[float, float, float]:
    journal, y = _journal(throw, end)
    radius = journal.bore_radius_mm if end.in_bore else journal.radius_mm
    angle = math.radians(end.angle_deg)
    z = end.place_mm if end.journal_key == "main_journal" else pitch_mm / 2 - end.place_mm
    x, along = (round(value, 12) + 0.0 for value in (radius * math.sin(angle), y + radius * math.cos(angle)))
    return x, along, z


def _mouth(throw: ThrowTable, end: DrillingEnd, point: Array, outward: Array, rounding: float) -> DrillOutlet:
    journal, y = _journal(throw, end)
    radius = journal.bore_radius_mm if end.in_bore else journal.radius_mm
    place, way = (cast(tuple[float, float, float], tuple(v.tolist())) for v in (point, outward))
    return DrillOutlet(place, way, y, radius, end.in_bore, 0.0 if end.in_bore else rounding, end.journal_key)


def _journal(throw: ThrowTable, end: DrillingEnd) -> tuple[Journal, float]:
    (main, _), (pin, radius) = throw.journals
    return (main, 0.0) if end.journal_key == "main_journal" else (pin, radius)


def drilling_asymmetry(scene: ThrowView) -> str:
    """Key of the first drilling that has no mirror image in x = 0; empty when there is none."""
    found = drill_bores(scene)
    places = {_signature(channel, 1) for channel in found}
    lonely = (channel.key for channel in found if _signature(channel, -1) not in places)
    return next(lonely, "")


def _signature(channel: DrillBore, side: int) -> tuple[object, ...]:
    """What tells a drilling from another; `side` -1: of its mirror image."""
    ends = []
    for mouth in channel.mouths:
        x, y, z = mouth.point_mm
        place = tuple(round(value, _DIGITS) + 0.0 for value in (side * x, y, z))
        ends.append((mouth.in_bore, mouth.rounding_mm, place))
    return round(channel.radius_mm, _DIGITS), frozenset(ends)
