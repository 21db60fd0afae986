"""The bevelled edge of a counterweight: plane cuts along its flanks, so that it parts oil and air.

A flank is a plane through the crank axis. Places along it count outward from that axis, places across it into
the counterweight. A cut is bounded by the bevel's plane and by a wall at right angles to the flank.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, ClassVar, Literal, Self

import numpy as np
from pydantic import Field
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.quadrature import gauss_legendre
from cranktopo.base.spans import Span
from cranktopo.base.table import Length, SceneTable
from cranktopo.throw.counterweight.sector import Sector
from cranktopo.throw.counterweight.tangent_circle import flank_directions
from cranktopo.throw.feature import DrilledBody, ExactMoments, ThrowView, least_shoulder_mm
from cranktopo.throw.primitives import (
    DimensionLine,
    Extrusion,
    LineSegment,
    Point,
    Polyline,
    Solid,
    number_lines,
)

_TOOL = 2.0
"""Reach of a cut over the radius of the rim: no optimiser closes its mouth there."""
_AXIAL = 1e-12
"""Cosine of a half-angle below which both flanks lie in the plane y = 0."""
_SLICES, _SAMPLES = 40, 2001
"""Gauss points across a piece of a cut; points of an outline or circle that it keeps clear of."""
_CROSSED_DEG, _BESIDE_MM = 75.0, 3.5
"""Largest half-angle at which a section across the throw shows a bevel; its dimension lines beside it."""
_GRID = (13, 25, 7)
"""Points across, along and below the face at which a cut is compared with others."""
_SIDES: dict[str, tuple[float, ...]] = {"leading": (-1.0,), "trailing": (1.0,), "both": (-1.0, 1.0)}
"""Sides of x = 0 that flanks lie on: the crank turns from +y toward +x, so the far side leads toward -x."""
_MIRRORED = {"leading": "trailing", "trailing": "leading", "both": "both"}


@dataclass(frozen=True)
class EdgeCut(DrilledBody):
    """Cut along one flank of a counterweight, from one of its faces.

    In front of the flank it goes on as far as it is wide, and beyond the rim, so that nothing covers it.

    Attributes:
        sector: the counterweight.
        side: of x = 0 that the flank lies on, -1 or 1.
        face_mm: height of the face; `into` is 1 if the counterweight lies toward +z.
        width_mm: its width on the face, at right angles to the flank.
        depth_mm: its depth below the face at the flank.
        start_mm: distance of its wall from the crank axis, along the flank.
    """

    kept: ClassVar[bool] = True
    sector: Sector
    side: float
    face_mm: float
    into: float
    width_mm: float
    depth_mm: float
    start_mm: float

    @property
    def _end_mm(self) -> float:
        return _TOOL * self.sector.radius_mm

    def below_mm(self, z_mm: Any) -> Any:
        """Depth of heights below the face."""
        return self.into * (z_mm - self.face_mm)

    def flank_mm(self, x_mm: Any, y_mm: Any) -> tuple[Any, Any]:
        """Return places along the flank, and across it into the counterweight."""
        along, out = flank_directions(self.sector.half_angle)
        x = self.side * x_mm
        return x * along[0] + y_mm * along[1], -(x * out[0] + y_mm * out[1])

    def outermost_mm(self, y_mm: Array, half_width_mm: Array) -> Array:
        """Return the points of an outline that lie farthest along the flank within the width of the cut."""
        _, (across, up) = flank_directions(self.sector.half_angle)
        if across < _AXIAL:
            return self.side * half_width_mm
        front = (self.width_mm - y_mm * up) / across
        return self.side * np.clip(front, -half_width_mm, half_width_mm)

    def place_mm(self, along_mm: Any, across_mm: Any) -> tuple[Any, Any]:
        """Return (x, y) of places along the flank and across it."""
        along, out = flank_directions(self.sector.half_angle)
        x, y = (
            along_mm * one - across_mm * other
            for one, other in zip(along.tolist(), out.tolist(), strict=True)
        )
        return self.side * x, y

    @override
    def spans(self, y_mm: Array, z_mm: Array) -> Sequence[Span]:
        (sine, down), (across, up) = flank_directions(self.sector.half_angle)
        below = self.below_mm(z_mm)
        cut = (below >= 0) & (below <= self.depth_mm)
        wide = np.where(cut, self.width_mm * (1 - below / self.depth_mm), -self.width_mm)
        start, stop = ((end - y_mm * down) / sine for end in (self.start_mm, self._end_mm))
        if across < _AXIAL:
            open_ = (y_mm * up >= -wide) & (y_mm * up <= self.width_mm)
            stop = np.where(open_, stop, start)
        else:
            start = np.maximum(start, (-wide - y_mm * up) / across)
            stop = np.minimum(stop, (self.width_mm - y_mm * up) / across)
        start, stop = np.broadcast_arrays(start, np.where(cut, np.maximum(stop, start), start))
        return [(start, stop) if self.side > 0 else (-stop, -start)]

    @property
    def _corners_mm(self) -> Array:
        """Corners (x, y) of its section at the face, (4, 2)."""
        ends = [(s, u) for s in (self.start_mm, self._end_mm) for u in (-self.width_mm, self.width_mm)]
        return np.array([self.place_mm(*end) for end in ends])

    @property
    @override
    def y_range_mm(self) -> tuple[float, float]:
        y = self._corners_mm[:, 1]
        return float(y.min()), float(y.max())

    @override
    def bounds_mm(self, z_mm: tuple[float, float]) -> tuple[Array, Array]:
        corners, (low, high) = self._corners_mm, np.clip(z_mm, *self.z_mm)
        return np.append(corners.min(axis=0), low), np.append(corners.max(axis=0), high)

    @property
    @override
    def changing_z_mm(self) -> tuple[tuple[float, float], ...]:
        return (self.z_mm,)

    def rim_mm(self, across_mm: Array) -> Array:
        """Places along the flank at which rim or round corner end it, by the place across."""
        radius, r = self.sector.radius_mm, self.sector.corner_mm
        chord = np.sqrt(np.maximum(radius**2 - across_mm**2, 0.0))
        if not r:
            return np.asarray(chord)
        middle, _ = self._right_mm(self.sector.corner.centre)
        arc = middle + np.sqrt(np.maximum(r**2 - (across_mm - r) ** 2, 0.0))
        return np.where(across_mm < self._round_mm, arc, chord)

    @property
    def _round_mm(self) -> float:
        """Place across the flank at which its round corner meets the rim."""
        return self._right_mm(self.sector.corner.on_rim)[1]

    def _right_mm(self, place: tuple[float, float]) -> tuple[float, float]:
        """Return the place along and across the flank of a point of the right half."""
        along, across = self.flank_mm(self.side * place[0], place[1])
        return float(along), float(across)

    @override
    def exact_moments(self, before_z_mm: float | None = None) -> ExactMoments:
        """Slices along the flank, each a rectangle between wall and rim."""
        nodes, weights = gauss_legendre(_SLICES)
        sine, cosine = np.sin(np.pi / 2 * nodes), np.pi / 2 * np.cos(np.pi / 2 * nodes)
        ends = sorted(
            {0.0, self.width_mm, *([min(self._round_mm, self.width_mm)] * bool(self.sector.corner_mm))}
        )
        pieces = [((low + high) / 2, (high - low) / 2) for low, high in pairwise(ends)]
        across = np.concatenate([middle + half * sine for middle, half in pieces])
        weight = np.concatenate([half * cosine * weights for _, half in pieces])
        tall, rim = self.depth_mm * (1 - across / self.width_mm), self.rim_mm(across)
        if before_z_mm is not None:
            weight = weight * (before_z_mm - self.face_mm - self.into * tall / 2)
        area, first, second = ((rim**power - self.start_mm**power) / power for power in (1, 2, 3))
        along, over = float(weight * tall @ first), float(weight * tall @ (across * area))
        x, y = self.place_mm(along, over)
        return (
            float(weight * tall @ area),
            float(x),
            float(y),
            float(weight * tall @ (second + across**2 * area)),
        )

    @override
    def solids(self) -> tuple[Solid, ...]:
        section = [
            (self.width_mm, -self.depth_mm),
            (self.width_mm, 0.0),
            (0.0, self.depth_mm),
            (-self.width_mm, self.depth_mm),
            (-self.width_mm, -self.depth_mm),
        ]
        x, y = self.place_mm(self._end_mm - self.start_mm, 0.0)
        corners = [self._point(across, below) for across, below in section]
        edges = tuple(LineSegment(*ends) for ends in pairwise([*corners, corners[0]]))
        return (Extrusion(edges, (float(x), float(y), 0.0)),)

    def _point(self, across_mm: float, below_mm: float) -> Point:
        x, y = self.place_mm(self.start_mm, across_mm)
        return float(x), float(y), self.face_mm + self.into * below_mm

    def off_wall_mm(self, at: Array) -> Array:
        """Return distances of points (3, n) from the bevel's plane, positive in the counterweight."""
        _, across = self.flank_mm(at[0], at[1])
        slope = np.array([1 / self.width_mm, 1 / self.depth_mm])
        beyond = across * slope[0] + self.below_mm(at[2]) * slope[1] - 1
        return np.asarray(beyond / np.hypot(*slope))

    def off_floor_mm(self, at: Array) -> Array:
        """Return distances of points (3, n) outward from its wall."""
        return np.asarray(self.flank_mm(at[0], at[1])[0] - self.start_mm)

    def outside_mm(self, at: Array) -> Array:
        """Return how far points (3, n) lie outside it."""
        _, across = self.flank_mm(at[0], at[1])
        sides = [self.off_wall_mm(at), -self.off_floor_mm(at), -across - self.width_mm]
        return np.asarray(np.max(sides, axis=0))

    def inside_section_mm(self, x_mm: Array, y_mm: Array) -> Array:
        """Return how far points of the section at the face lie inside it, the rim aside; negative outside."""
        along, across = self.flank_mm(x_mm, y_mm)
        return np.asarray(np.min([along - self.start_mm, self.width_mm - np.abs(across)], axis=0))

    def points_mm(self, wider_mm: float) -> Array:
        """Return points (3, n) of the material that it takes, and of as much more around it."""
        u, s, d = (grid.ravel() for grid in np.meshgrid(*(np.linspace(0, 1, n) for n in _GRID)))
        across, first = u * (self.width_mm + wider_mm), self.start_mm - wider_mm
        along = first + s * (self.rim_mm(across) - first)
        x, y = self.place_mm(along, across)
        return np.stack([x, y, self.face_mm + self.into * (1 - u) * d * (self.depth_mm + wider_mm)])

    def edge_mm(self) -> tuple[tuple[float, float], ...]:
        """Corners (x, y) of its edges on the face: from the flank along its wall, then along the plane."""
        rim = float(self.rim_mm(np.array([self.width_mm]))[0])
        ends = ((self.start_mm, 0.0), (self.start_mm, self.width_mm), (rim, self.width_mm))
        return tuple((float(x), float(y)) for x, y in (self.place_mm(*end) for end in ends))


class BevelledEdge(SceneTable):
    """Plane bevels along the flanks of a counterweight, machined: a knife edge that parts oil and air.

    Each begins at the rim and ends in a wall at right angles to the flank. The crank turns from +y toward +x,
    so that the leading flank of a counterweight is that at x < 0. One flank alone makes the web asymmetric.
    """

    flanks: Literal["leading", "trailing", "both"] = "leading"
    """Flanks that are bevelled: that which leads in the sense of rotation, that which trails, or both."""
    face: Literal["journal", "pin", "both"] = "both"
    """Faces that are cut; with both the edge lies in the middle of the counterweight's thickness."""
    width_mm: Length = Field(examples=[6.0])
    """Width of a bevel on its face, at right angles to the flank."""
    depth_mm: Length = Field(examples=[5.0])
    """Depth of a bevel below its face, at the flank."""
    length_mm: Length = Field(examples=[20.0])
    """Length of a bevel along the flank, inward from the outer radius."""

    def cuts(self, sector: Sector, key: str) -> tuple[EdgeCut, ...]:
        """Return its cuts in a counterweight."""
        start = sector.radius_mm - self.length_mm
        sizes = self.width_mm, self.depth_mm, start
        low, high = sector.z_mm
        faces = {
            "journal": ((low, low + self.depth_mm), low, 1.0),
            "pin": ((high - self.depth_mm, high), high, -1.0),
        }
        return tuple(
            EdgeCut(key, z_mm, sector, side, height, into, *sizes)
            for side in _SIDES[self.flanks]
            for face, (z_mm, height, into) in faces.items()
            if self.face in (face, "both")
        )

    def refusal(self, scene: ThrowView, sector: Sector, fillet_mm: float) -> tuple[str, str] | None:
        """Return the key that does not fit its counterweight and what is allowed; None where all do.

        Args:
            fillet_mm: distance from the crank axis up to which a fillet holds the flank.
        """
        least, thick = least_shoulder_mm(scene.throw), sector.z_mm[1] - sector.z_mm[0]
        flank = math.hypot(*sector.corner.on_flank)
        start, outer = sector.radius_mm - self.length_mm, sector.radius_mm
        deepest = (thick - least) / (2 if self.face == "both" else 1)
        if self.depth_mm > deepest:
            why = f"the counterweight is {thick:g} mm thick" + ", cut from both faces" * (self.face == "both")
            return "depth_mm", f"must be at most {_down(deepest):g} mm: {why}"
        if start >= flank - least:
            return "length_mm", f"must be larger than {outer - flank + least:.4g} mm: the flank ends there"
        around = (("its fillet", fillet_mm), *self._in_the_way(scene, sector))
        what, reach = max(around, key=lambda one: one[1])
        if start < reach + least:
            longest = _down(outer - reach - least)
            room = f"must be at most {longest:g} mm" if longest > 0 else "finds no place"
            return "length_mm", f"{room}: {what} reaches {reach:.4g} mm along the flank"
        widest = min(start * math.tan(sector.half_angle), math.sqrt(outer**2 - start**2)) - least
        if self.width_mm > widest:
            return "width_mm", f"must be at most {_down(widest):g} mm at this length"
        return None

    def _in_the_way(self, scene: ThrowView, sector: Sector) -> Iterator[tuple[str, float]]:
        """Yield what stands within the width of a cut, and how far along the flank from the crank axis."""
        cut, turn = self.cuts(sector, "")[-1], np.linspace(0, 2 * np.pi, _SAMPLES)
        for name, (journal, y) in zip(("main_journal", "crankpin"), scene.throw.journals, strict=True):
            x_mm, y_mm = (journal.clear_radius_mm * wave(turn) for wave in (np.sin, np.cos))
            yield f"throw.{name} with its fillet", _reach_mm(cut, x_mm, y + y_mm)
        low, high = scene.web.y_range_mm(scene.throw.radius_mm)
        y_mm = (low + high) / 2 - (high - low) / 2 * np.cos(turn / 2)
        half = scene.web.half_width_mm(scene.throw.radius_mm, y_mm)
        yield "the web's outline", _reach_mm(cut, cut.outermost_mm(y_mm, half), y_mm)

    def mirrored(self) -> Self:
        """Its mirror image in x = 0."""
        return self.model_copy(update={"flanks": _MIRRORED[self.flanks]})

    @property
    def sizes_mm(self) -> dict[str, float]:
        """Its dimensions by their keys."""
        return self.model_dump(exclude={"flanks", "face"})

    def strokes(self, sector: Sector) -> tuple[Polyline, ...]:
        """Return how its bevels appear in the view along the crank axis, from the pin."""
        hidden = self.face == "journal"
        return tuple(
            Polyline(edge, hidden) for edge in dict.fromkeys(cut.edge_mm() for cut in self.cuts(sector, ""))
        )

    def named(self, sector: Sector) -> tuple[tuple[float, float], str]:
        """Return the point of the rim at which a bevel ends, and its width and depth."""
        return self.cuts(sector, "")[0].edge_mm()[-1], f"{self.width_mm:g} × {self.depth_mm:g}"

    def across(self, sector: Sector) -> tuple[float, tuple[DimensionLine, ...]] | None:
        """Return the place of a section across the throw in the middle of its length, and its depths there.

        None where the section would not cross the flank.
        """
        if math.degrees(sector.half_angle) > _CROSSED_DEG:
            return None
        cuts, found = self.cuts(sector, ""), []
        x, y = cuts[0].place_mm(sector.radius_mm - self.length_mm / 2, 0.0)
        for cut in (cut for cut in cuts if cut.side == cuts[0].side):
            low, high = cut.z_mm
            shift = (cut.side * _BESIDE_MM, 0.0)
            found.append(DimensionLine((x, low), (x, high), shift, f"{self.depth_mm:g}"))
        return y, tuple(found)

    def lines(self) -> tuple[str, ...]:
        """Return its numbers for the table of the drawing."""
        flanks = "both flanks" if self.flanks == "both" else f"{self.flanks} flank"
        faces = "both faces" if self.face == "both" else f"{self.face} face"
        return number_lines(f"BEVELLED EDGE, {flanks}, {faces}", self.sizes_mm)


def _reach_mm(cut: EdgeCut, x_mm: Array, y_mm: Array) -> float:
    """Return how far along a flank points reach that lie within the width of its cut, from the crank axis."""
    along, across = cut.flank_mm(x_mm, y_mm)
    return float(along[np.abs(across) <= cut.width_mm].max(initial=-np.inf))


def _down(value: float) -> float:
    return math.floor(value * 1e3) / 1e3
