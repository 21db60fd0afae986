"""Holes of a counterweight: plugs of heavy metal in it, and what balancing drills out of it.

Both are drilled into the finished body and stay as they are: no optimiser fills them. A plug is held by its
fit or a bolt; it counts with its mass, the hole around it is empty for every stiffness.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal, Self

import numpy as np
from pydantic import Field
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.quadrature import gauss_legendre
from cranktopo.base.spans import Span
from cranktopo.base.table import Length, Place, SceneTable
from cranktopo.throw.counterweight.sector import Sector
from cranktopo.throw.feature import DrilledBody, ExactMoments, Face
from cranktopo.throw.hole import RoundHole
from cranktopo.throw.primitives import Circle, Cylinder, Point, Polyline, Solid, number_lines

_TOOL = 2.0
"""Reach of the tool of a radial hole over the radius of the rim: no optimiser closes its mouth."""
_AXIAL = 1e-12
"""Sine of an angle below which a radial hole lies in the plane x = 0."""
_AROUND, _ALONG = 64, 12
_SLICES = 40
"""Gauss points across a radial hole."""


@dataclass(frozen=True)
class AxialHole(RoundHole):
    """A hole along the crank axis from a face; `floor_mm` is the height of its floor, None if it has none."""

    kept: ClassVar[bool] = True
    floor_mm: float | None = None

    def wall_mm(self, wider_mm: float) -> Array:
        """Return points (3, n) of its wall and floor, moved outward and on by a distance."""
        turn, (low, high) = np.linspace(0, 2 * np.pi, _AROUND, endpoint=False), self.z_mm
        out = self.radius_mm + wider_mm
        z = low + (high - low) * np.linspace(0.01, 0.99, _ALONG)
        if self.floor_mm is not None:
            z = np.append(z, self.floor_mm + math.copysign(wider_mm, self.floor_mm - sum(self.z_mm) / 2))
        angle, height = (grid.ravel() for grid in np.meshgrid(turn, z))
        return np.stack([self.x_mm + out * np.cos(angle), self.y_mm + out * np.sin(angle), height])

    def off_wall_mm(self, at: Array) -> Array:
        """Return distances of points (3, n) from its cylinder, positive outside."""
        return np.asarray(np.hypot(at[0] - self.x_mm, at[1] - self.y_mm) - self.radius_mm)

    def off_floor_mm(self, at: Array) -> Array:
        """Return heights of points (3, n) over its floor; it must have one."""
        assert self.floor_mm is not None
        return np.asarray(at[2] - self.floor_mm)


@dataclass(frozen=True)
class RadialHole(DrilledBody):
    """A hole from the rim toward the crank axis, its axis at an angle to the line away from the crankpin.

    Attributes:
        angle: of its axis, rad, toward +x.
        inner_mm: distance of its flat floor from the crank axis.
        rim_mm: outer radius of the counterweight.
    """

    kept: ClassVar[bool] = True
    angle: float
    radius_mm: float
    inner_mm: float
    rim_mm: float

    @property
    def _middle_mm(self) -> float:
        return sum(self.z_mm) / 2

    @property
    def _outer_mm(self) -> float:
        return _TOOL * self.rim_mm

    @override
    def spans(self, y_mm: Array, z_mm: Array) -> Sequence[Span]:
        sine, cosine, outer = math.sin(self.angle), math.cos(self.angle), self._outer_mm
        square = self.radius_mm**2 - (z_mm - self._middle_mm) ** 2
        half = np.sqrt(np.maximum(square, 0.0))
        left, right = ((side * half - y_mm * sine) / cosine for side in (-1, 1))
        if abs(sine) < _AXIAL:
            inside = (-y_mm >= self.inner_mm) & (-y_mm <= outer)
            return [(left, np.where(inside, right, left))]
        ends = sorted((self.inner_mm, outer), reverse=sine < 0)
        low, high = ((end + y_mm * cosine) / sine for end in ends)
        start, stop = np.maximum(left, low), np.minimum(right, high)
        return [(start, np.where(square > 0, np.maximum(stop, start), start))]

    @property
    @override
    def y_range_mm(self) -> tuple[float, float]:
        out = self.radius_mm * abs(math.sin(self.angle))
        cosine = math.cos(self.angle)
        return -self._outer_mm * cosine - out, out - self.inner_mm * cosine

    @override
    def exact_moments(self, before_z_mm: float | None = None) -> ExactMoments:
        """Slices along its axis, each a rectangle between the floor and the rim."""
        nodes, weights = gauss_legendre(_SLICES)
        turn = np.pi / 2 * nodes
        across = self.radius_mm * np.sin(turn)
        arm = 1.0 if before_z_mm is None else before_z_mm - self._middle_mm
        area = arm * weights * np.pi * (self.radius_mm * np.cos(turn)) ** 2
        rim = np.sqrt(self.rim_mm**2 - across**2)
        volume, first, second = ((rim**power - self.inner_mm**power) / power for power in (1, 2, 3))
        along = float(area @ first)
        polar = float(area @ (second + across**2 * volume))
        sine, cosine = math.sin(self.angle), math.cos(self.angle)
        return float(area @ volume), along * sine, -along * cosine, polar

    @override
    def bounds_mm(self, z_mm: tuple[float, float]) -> tuple[Array, Array]:
        way = np.array([math.sin(self.angle), -math.cos(self.angle)])
        ends = np.outer([self.inner_mm, self._outer_mm], way)
        out = self.radius_mm * np.abs(way[::-1])
        low, high = np.clip(z_mm, *self.z_mm)
        return np.append(ends.min(axis=0) - out, low), np.append(ends.max(axis=0) + out, high)

    @property
    @override
    def changing_z_mm(self) -> tuple[tuple[float, float], ...]:
        return (self.z_mm,)

    @override
    def solids(self) -> tuple[Solid, ...]:
        sine, cosine = math.sin(self.angle), math.cos(self.angle)
        start: Point = (self.inner_mm * sine, -self.inner_mm * cosine, self._middle_mm)
        length = self._outer_mm - self.inner_mm
        return (Cylinder(start, (length * sine, -length * cosine, 0.0), self.radius_mm),)

    def wall_mm(self, wider_mm: float) -> Array:
        """Return points (3, n) of its wall below the rim and of its floor, moved outward and inward."""
        out = self.radius_mm + wider_mm
        last = math.sqrt(max(self.rim_mm**2 - out**2, 0.0)) - wider_mm
        return self._around_mm(out, self.inner_mm - wider_mm, last)

    def beyond_rim_mm(self) -> Array:
        """Return points (3, n) that the tool passes beyond the rim."""
        return self._around_mm(self.radius_mm, self.rim_mm, self._outer_mm)

    def _around_mm(self, radius_mm: float, start_mm: float, end_mm: float) -> Array:
        """Return points of a cylinder about its axis between two distances from the crank axis."""
        turn = np.linspace(0, 2 * np.pi, _AROUND, endpoint=False)
        turn, along = (grid.ravel() for grid in np.meshgrid(turn, np.linspace(start_mm, end_mm, _ALONG)))
        across, sine, cosine = radius_mm * np.cos(turn), math.sin(self.angle), math.cos(self.angle)
        x, y = across * cosine + along * sine, across * sine - along * cosine
        return np.stack([x, y, self._middle_mm + radius_mm * np.sin(turn)])

    def off_wall_mm(self, at: Array) -> Array:
        """Return distances of points (3, n) from its cylinder, positive outside."""
        across = at[0] * math.cos(self.angle) + at[1] * math.sin(self.angle)
        return np.asarray(np.hypot(across, at[2] - self._middle_mm) - self.radius_mm)

    def off_floor_mm(self, at: Array) -> Array:
        """Return distances of points (3, n) outward from its floor."""
        return np.asarray(at[0] * math.sin(self.angle) - at[1] * math.cos(self.angle) - self.inner_mm)

    def outside_mm(self, at: Array) -> Array:
        """Return how far points (3, n) lie outside it."""
        return np.asarray(np.maximum(self.off_wall_mm(at), -self.off_floor_mm(at)))

    def edge_mm(self) -> tuple[tuple[float, float], ...]:
        """Corners (x, y) of its outline in the view along the crank axis, from rim to rim."""
        r, sine, cosine = self.radius_mm, math.sin(self.angle), math.cos(self.angle)
        rim = math.sqrt(self.rim_mm**2 - r**2)
        corners = ((rim, -r), (self.inner_mm, -r), (self.inner_mm, r), (rim, r))
        return tuple((t * cosine + s * sine, t * sine - s * cosine) for s, t in corners)


class DrilledHole(SceneTable):
    """A hole that is drilled into a counterweight; a kind says where, and what is in it."""

    diameter_mm: Length = Field(examples=[12.0])
    """Diameter of the hole."""

    @property
    @abstractmethod
    def radial(self) -> bool:
        """True if it is drilled from the rim toward the crank axis."""

    @abstractmethod
    def body(self, sector: Sector, face: Face, key: str) -> AxialHole | RadialHole:
        """Return the hole in a counterweight that is flush with a face of the web."""

    @abstractmethod
    def mirrored(self) -> Self:
        """Its mirror image in x = 0."""

    def check(self, sector: Sector) -> tuple[str, str] | None:
        """Return the key that does not fit its counterweight and what is allowed; None where all do."""
        thick = sector.z_mm[1] - sector.z_mm[0]
        if self.radial and self.diameter_mm >= thick:
            return "diameter_mm", f"must be smaller than the counterweight's thickness, {thick:g} mm"
        return None

    def stroke(self, sector: Sector) -> Circle | Polyline:
        """Return how it appears in the view along the crank axis."""
        body = self.body(sector, "journal", "")
        if isinstance(body, AxialHole):
            return Circle((body.x_mm, body.y_mm), body.radius_mm, label=f"⌀{self.diameter_mm:g}")
        return Polyline(body.edge_mm(), hidden=True)

    @property
    @abstractmethod
    def title(self) -> str:
        """Name in the drawing's table."""

    @property
    def places(self) -> tuple[tuple[float, float], ...]:
        """Points of the drawing that are dimensioned from both axes."""
        return ()

    def lines(self) -> tuple[str, ...]:
        """Return its numbers for the table of the drawing."""
        return number_lines(self.title, self.model_dump(exclude={"axis", "density_kg_m3"}))


class Plug(DrilledHole):
    """Plug of heavy metal in a hole of a counterweight: a full cylinder, held by its fit or a bolt.

    An axial one begins at the face that the counterweight is flush with; a radial one sits in a hole from the
    rim. Mass, unbalance, inertia and pull count; the hole is empty for stiffness, stress, solids and meshes.
    The pull acts on meshes, not on cells.
    """

    axis: Literal["axial", "radial"] = Field(examples=["axial"])
    """Direction of the hole: along the crank axis, or toward it."""
    x_mm: Place = 0.0
    """Middle of the plug across the throw, from the crank axis."""
    y_mm: Place = Field(examples=[-45.0])
    """Middle of the plug along the throw, from the crank axis; negative away from the crankpin."""
    length_mm: Length = Field(examples=[12.0])
    """Length of the plug; of an axial one the depth of its hole, too."""
    density_kg_m3: float = Field(ge=10, le=30000, examples=[17500.0])
    """Density of the plug."""

    @property
    def _reach_mm(self) -> float:
        return math.hypot(self.x_mm, self.y_mm)

    @property
    @override
    def radial(self) -> bool:
        return self.axis == "radial"

    @override
    def body(self, sector: Sector, face: Face, key: str) -> AxialHole | RadialHole:
        radius = self.diameter_mm / 2
        if self.radial:
            angle, inner = math.atan2(self.x_mm, -self.y_mm), self._reach_mm - self.length_mm / 2
            return RadialHole(key, _around(sector, radius), angle, radius, inner, sector.radius_mm)
        (low, high), upward = sector.z_mm, face == "journal"
        z = (low, min(high, low + self.length_mm)) if upward else (max(low, high - self.length_mm), high)
        floor = None if self.length_mm >= high - low else z[upward]
        return AxialHole(key, z, self.x_mm, self.y_mm, radius, floor)

    def cylinder(self, sector: Sector, face: Face) -> Cylinder:
        """Return the plug itself, in the counterweight that is flush with a face of the web."""
        hole, radius = self.body(sector, face, ""), self.diameter_mm / 2
        if isinstance(hole, AxialHole):
            return Cylinder((self.x_mm, self.y_mm, hole.z_mm[0]), (0.0, 0.0, self.length_mm), radius)
        way = self.x_mm / self._reach_mm, self.y_mm / self._reach_mm
        start: Point = (hole.inner_mm * way[0], hole.inner_mm * way[1], sum(hole.z_mm) / 2)
        return Cylinder(start, (self.length_mm * way[0], self.length_mm * way[1], 0.0), radius)

    @override
    def check(self, sector: Sector) -> tuple[str, str] | None:
        thick, radius = sector.z_mm[1] - sector.z_mm[0], self.diameter_mm / 2
        if not self.radial and self.length_mm > thick:
            return "length_mm", f"must be at most the counterweight's thickness, {thick:g} mm"
        if self.radial and self.y_mm >= 0:
            return "y_mm", "must be negative: a radial plug lies away from the crankpin"
        outer = math.hypot(self._reach_mm + self.length_mm / 2, radius)
        if self.radial and outer > sector.radius_mm:
            return (
                "length_mm",
                f"sticks out: it reaches {outer:.4g} mm, the rim is at {sector.radius_mm:g} mm",
            )
        return super().check(sector)

    @override
    def mirrored(self) -> Self:
        return self.model_copy(update={"x_mm": 0.0 - self.x_mm})

    @property
    @override
    def title(self) -> str:
        return f"PLUG, {self.axis}, {self.density_kg_m3:g} kg/m³"

    @property
    @override
    def places(self) -> tuple[tuple[float, float], ...]:
        return ((self.x_mm, self.y_mm),)

    def moments(self) -> ExactMoments:
        """Return those of the plug's cylinder."""
        radius = self.diameter_mm / 2
        volume = math.pi * radius**2 * self.length_mm
        own = radius**2 / 4 + self.length_mm**2 / 12 if self.radial else radius**2 / 2
        return volume, volume * self.x_mm, volume * self.y_mm, volume * (self._reach_mm**2 + own)


class BalancingHole(DrilledHole):
    """Hole that balancing drills from the rim of a counterweight toward the crank axis, its floor flat."""

    angle_deg: float = Field(default=0.0, gt=-90, lt=90)
    """Angle of its axis to the line away from the crankpin, toward +x."""
    depth_mm: Length = Field(examples=[15.0])
    """Depth below the rim, along its axis."""

    @property
    @override
    def radial(self) -> bool:
        return True

    @override
    def body(self, sector: Sector, face: Face, key: str) -> RadialHole:
        radius, rim = self.diameter_mm / 2, sector.radius_mm
        angle = math.radians(self.angle_deg)
        return RadialHole(key, _around(sector, radius), angle, radius, rim - self.depth_mm, rim)

    @override
    def check(self, sector: Sector) -> tuple[str, str] | None:
        if self.depth_mm >= sector.radius_mm:
            return "depth_mm", f"must be smaller than the outer radius, {sector.radius_mm:g} mm"
        return super().check(sector)

    @override
    def mirrored(self) -> Self:
        return self.model_copy(update={"angle_deg": 0.0 - self.angle_deg})

    @property
    @override
    def title(self) -> str:
        return "BALANCING HOLE, radial"


def _around(sector: Sector, radius_mm: float) -> tuple[float, float]:
    """Heights of a radial hole in the middle of a counterweight's thickness."""
    middle = sum(sector.z_mm) / 2
    return middle - radius_mm, middle + radius_mm
