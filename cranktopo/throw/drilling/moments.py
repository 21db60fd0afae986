"""Mass that drillings take out of a half throw, without a CAD kernel: the oracle of its exact solid.

In a plane that holds the drilling's direction and the crank axis' direction, a drilling is a strip and each
journal a rectangle: their common polygons are integrated exactly, and Gauss quadrature across the drilling
does the rest. The rounding of an outlet is the ring that a ball leaves which rolls around the edge inside
the material.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import pairwise
from typing import Literal, cast

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.quadrature import gauss_legendre
from cranktopo.throw.drilling.bore import DrillBore
from cranktopo.throw.drilling.outlet import DrillOutlet, ring_points
from cranktopo.throw.drilling.table import drill_bores
from cranktopo.throw.feature import JournalsView, ThrowView
from cranktopo.throw.moments import Moments, integrate

Part = Literal["beyond", "main_journal", "web", "crankpin"]
PARTS: tuple[Part, ...] = "main_journal", "web", "crankpin"
_ENDLESS = 1e3
"""Half-width of the web over the throw's radius: a drilling never reaches its edge."""
_AROUND, _AROUND_WHOLE, _GAUSS = 360, 72, 8
"""Points around an outlet, around one whose ring is whole, and along and across the section of a ring."""
_ALL = -math.inf, math.inf
_STEP = 1e-5
_Corner = tuple[float, float]
"""Of a section: place along the drilling across the crank, and height."""
_TOLERANCE = 1e-8
"""Of a drilling's integrals; it is less than a hundredth of the throw."""


def drilled(scene: ThrowView, part: Part | None = None, before_z_mm: float | None = None) -> Moments:
    """Return the moments of what the drillings take out of the half throw, or of one part of it.

    One that only this half has counts as a whole where it reaches across the middle of the crankpin. With
    `before_z_mm`, volume and first moments are weighted by the distance before that height, mm.
    """
    total = none = Moments(0.0, 0.0, 0.0, 0.0)
    for bore in drill_bores(scene):
        for name in PARTS if part is None else (part,):
            ends = (0.0, _end(scene, bore))
            total = total + _bored(scene.throw, (*scene.web_z_mm, ends[1]), bore, name, before_z_mm)
            rounded = (outlet for outlet in bore.outlets if outlet.rounding_mm and outlet.journal == name)
            rings = (_ring(bore.radius_mm, outlet, ends, before_z_mm) for outlet in rounded)
            total = total + sum(rings, none)
    return total


def beyond_middle(scene: ThrowView, bore: DrillBore, *, weighted: bool = False) -> Moments:
    """Return the moments of what a drilling of the half throw takes out of its neighbour.

    That has the same main journal, from its middle on. Where they are `weighted`, volume and first moments
    are by the distance beyond the middle.
    """
    before = 0.0 if weighted else None
    total = _bored(scene.throw, (*scene.web_z_mm, math.inf), bore, "beyond", before)
    for outlet in bore.outlets:
        if outlet.rounding_mm and outlet.journal == "main_journal":
            total = total + _ring(bore.radius_mm, outlet, (-math.inf, 0.0), before)
    return total


def _bored(
    throw: JournalsView, z_mm: tuple[float, float, float], bore: DrillBore, part: Part, before: float | None
) -> Moments:
    """Return what a bore takes out of a part; both faces of the web and the end of the bore are at heights.

    Heights count from its first end: what lies in one part is the same wherever that is along the crank.
    """
    at, (lowest, highest) = bore.outlets[0].point_mm[2], _reach_mm(bore)
    ends = {
        "beyond": (-throw.main_journal.length_mm / 2, 0.0),
        "main_journal": (0.0, z_mm[0]),
        "web": z_mm[:2],
        "crankpin": z_mm[1:],
    }[part]
    low, high = ends[0] - at, ends[1] - at
    if highest <= low or lowest >= high:
        return Moments(0.0, 0.0, 0.0, 0.0)
    between = _ALL if low <= lowest and highest <= high else (low, high)
    return _bored_between(throw, between, bore.moved(-at), part, before if before is None else before - at)


def _reach_mm(bore: DrillBore) -> tuple[float, float]:
    """Least and largest height of a bore over its first end."""
    rise = float(bore.direction[2])
    aside = bore.radius_mm * math.sqrt(max(1 - rise**2, 0.0))
    first, last = sorted(place * rise for place in bore.extent_mm)
    return first - aside, last + aside


@lru_cache(maxsize=64)
def _bored_between(
    throw: JournalsView, z_mm: tuple[float, float], bore: DrillBore, part: Part, before: float | None
) -> Moments:
    """Return what a bore takes out of a part between two heights.

    Of the web nothing else counts: another one, as a search tries them, loses as much.
    """
    slice_at = _Slices(throw, z_mm, bore, part, before)
    kinks = np.clip(np.array(slice_at.kinks_mm) / bore.radius_mm, -1, 1)
    turns = np.arcsin(np.unique(np.concatenate([[-1.0, 0.0, 1.0], kinks])))

    def across(turn: Array) -> Array:
        places = bore.radius_mm * np.sin(turn)
        widths = bore.radius_mm * np.cos(turn)
        values = [slice_at(v, w) for v, w in zip(places.tolist(), widths.tolist(), strict=True)]
        return np.array(values) * widths[:, None]

    return Moments(*integrate(across, turns, _TOLERANCE).tolist())


class _Slices:
    """Sections of a part of the half throw and a drilling, in planes beside each other along the crank."""

    def __init__(
        self,
        throw: JournalsView,
        z_mm: tuple[float, float],
        bore: DrillBore,
        part: Part,
        before: float | None,
    ) -> None:
        self._before = before
        self._start = bore.outlets[0].point_mm
        across_x, across_y, rise = bore.direction.tolist()
        level = math.hypot(across_x, across_y)
        self._way = level, rise
        self._along = across_x / level, across_y / level
        self._aside = -self._along[1], self._along[0]
        self._ends = bore.extent_mm
        self._z = z_mm
        (main, _), (pin, radius) = throw.journals
        bores = {"beyond": (main, 0.0), "main_journal": (main, 0.0), "crankpin": (pin, radius)}
        own = [bores[part]] if part in bores else list(bores.values())
        self._solid = None if part == "web" else self._circle(own[0][1], own[0][0].radius_mm)
        self._far = _ENDLESS * radius
        self._bores = [self._circle(y, j.bore_radius_mm) for j, y in own if j.bore_radius_mm]

    @property
    def kinks_mm(self) -> list[float]:
        """Places across the drilling where a plane begins to cut a bore."""
        return [place + side * radius for _, place, radius in self._bores for side in (-1, 1)]

    def _circle(self, y: float, radius: float) -> tuple[float, float, float]:
        to_x, to_y = -self._start[0], y - self._start[1]
        along, aside = (to_x * way[0] + to_y * way[1] for way in (self._along, self._aside))
        return along, aside, radius

    def __call__(self, place: float, width: float) -> tuple[float, float, float, float]:
        """Integrals of 1, x, y and x2 + y2 over the section at a place across the drilling."""
        total = none = (0.0, 0.0, 0.0, 0.0)
        for left, right in self._material(place):
            polygon = self._common(width, left, right)
            found = self._integrals(polygon, place) if len(polygon) > 2 else none
            total = total[0] + found[0], total[1] + found[1], total[2] + found[2], total[3] + found[3]
        return total

    def _material(self, place: float) -> Iterator[tuple[float, float]]:
        solid = (-self._far, self._far) if self._solid is None else _chord(self._solid, place)
        at = solid[0]
        for left, right in sorted(_chord(bore, place) for bore in self._bores):
            if left < right:
                yield at, left
                at = right
        yield at, solid[1]

    def _common(self, width: float, left: float, right: float) -> list[_Corner]:
        """Corners of the drilling's strip between two places and within the heights of the part."""
        (level, rise), (first, last), up = self._way, self._ends, self._start[2]
        turns = ((first, -width), (last, -width), (last, width), (first, width))
        corners = [
            (along * level - aside * rise, up + along * rise + aside * level) for along, aside in turns
        ]
        low, high = self._z
        for axis, sign, limit in ((0, 1, left), (0, -1, -right), (1, 1, low), (1, -1, -high)):
            corners = _clipped(corners, axis, sign, limit)
        return corners

    def _integrals(self, corners: list[_Corner], place: float) -> tuple[float, float, float, float]:
        """By the midpoints of the edges of triangles, which is exact for squares."""
        (along_x, along_y), (aside_x, aside_y) = self._along, self._aside
        x0, y0 = self._start[0] + place * aside_x, self._start[1] + place * aside_y
        volume = first_x = first_y = polar = 0.0
        one = corners[0]
        for two, three in pairwise(corners[1:]):
            area = (two[0] - one[0]) * (three[1] - one[1]) - (two[1] - one[1]) * (three[0] - one[0])
            for (u, z), (v, w) in ((one, two), (two, three), (three, one)):
                out, weight = (u + v) / 2, area / 6
                if self._before is not None:
                    weight *= self._before - (z + w) / 2
                x, y = x0 + out * along_x, y0 + out * along_y
                volume, first_x, first_y = volume + weight, first_x + weight * x, first_y + weight * y
                polar += weight * (x * x + y * y)
        return volume, first_x, first_y, polar


def _chord(circle: tuple[float, float, float], place: float) -> tuple[float, float]:
    along, across, radius = circle
    half = math.sqrt(max(radius**2 - (place - across) ** 2, 0.0))
    return along - half, along + half


def _clipped(corners: list[_Corner], axis: int, sign: int, limit: float) -> list[_Corner]:
    """Return the part of a convex polygon on one side of a line: sign times a coordinate >= limit."""
    kept: list[_Corner] = []
    for here, after in zip(corners, [*corners[1:], *corners[:1]], strict=True):
        one, other = sign * here[axis] - limit, sign * after[axis] - limit
        if one >= 0:
            kept.append(here)
        if (one > 0 > other) or (one < 0 < other):
            share = one / (one - other)
            kept.append((here[0] + (after[0] - here[0]) * share, here[1] + (after[1] - here[1]) * share))
    return kept


def _end(scene: ThrowView, bore: DrillBore) -> float:
    """Height at which what a drilling takes out of its half throw ends, mm."""
    return math.inf if bore.alone else scene.pitch_mm / 2


def _ring(radius_mm: float, outlet: DrillOutlet, z_mm: tuple[float, float], before: float | None) -> Moments:
    """Return the moments of the ring of an outlet between two heights.

    Heights count from the outlet: a ring that lies between both is the same wherever it is along the crank.
    """
    at = outlet.point_mm[2]
    own, (low, high) = outlet.moved(-at), _ring_heights_mm(radius_mm, outlet.moved(-at))
    ends = z_mm[0] - at, z_mm[1] - at
    plain, by_height = _ring_between(radius_mm, own, _ALL if ends[0] <= low and high <= ends[1] else ends)
    return plain if before is None else plain.times(before - at) - by_height


@lru_cache(maxsize=64)
def _ring_heights_mm(radius_mm: float, outlet: DrillOutlet) -> tuple[float, float]:
    """Least and largest height of a ring, those of its edges."""
    turn, arc = (v.ravel() for v in np.meshgrid(2 * np.pi * np.arange(_AROUND) / _AROUND, (0.0, 1.0)))
    ends = [ring_points(radius_mm, outlet, turn, arc, np.full(turn.shape, end))[:, 2] for end in (0.0, 1.0)]
    return float(np.min(ends)), float(np.max(ends))


@lru_cache(maxsize=64)
def _ring_between(
    radius_mm: float, outlet: DrillOutlet, z_mm: tuple[float, float]
) -> tuple[Moments, Moments]:
    """Return the moments of a ring between two heights, and those times the height.

    A ring that is cut by neither is smooth all around, so that a few points tell it.
    """
    around = _AROUND_WHOLE if z_mm == _ALL else _AROUND
    share, weight = gauss_legendre(_GAUSS)
    share, weight = (share + 1) / 2, weight / 2
    turn, arc = (v.ravel() for v in np.meshgrid(2 * np.pi * np.arange(around) / around, share))
    low, high = _inside(radius_mm, outlet, turn, arc, z_mm)
    out = low[:, None] + (high - low)[:, None] * share
    at = [np.broadcast_to(v[:, None], out.shape).ravel() for v in (turn, arc)] + [out.ravel()]
    x, y, z = ring_points(radius_mm, outlet, *at).T
    section = np.repeat(weight, around)[:, None] * weight * (high - low)[:, None]
    volume = (_stretch(radius_mm, outlet, at).reshape(out.shape) * section).ravel() * 2 * np.pi / around
    values = (np.ones(len(x)), x, y, x**2 + y**2)
    plain, by_height = ([float((by * value).sum()) for value in values] for by in (volume, volume * z))
    return Moments(*plain), Moments(*by_height)


def _stretch(radius_mm: float, outlet: DrillOutlet, at: Sequence[Array]) -> Array:
    """Volume at points of a ring over that of their coordinates."""
    edges = []
    for axis in range(3):
        step = [_STEP * (axis == other) for other in range(3)]
        above, below = (
            ring_points(radius_mm, outlet, *(a + sign * s for a, s in zip(at, step, strict=True)))
            for sign in (1, -1)
        )
        edges.append((above - below) / (2 * _STEP))
    return np.asarray(np.abs(np.einsum("ni,ni->n", edges[0], np.cross(edges[1], edges[2]))))


def _inside(
    radius_mm: float, outlet: DrillOutlet, turn: Array, arc: Array, z_mm: tuple[float, float]
) -> tuple[Array, Array]:
    """From where to where lines from the edge to the rounding lie between two heights, in shares of them."""
    z0, z1 = (ring_points(radius_mm, outlet, turn, arc, np.full(turn.shape, end))[:, 2] for end in (0.0, 1.0))
    rise = np.where(np.abs(z1 - z0) < 1e-12, 1e-12, z1 - z0)
    one, other = (z_mm[0] - z0) / rise, (z_mm[1] - z0) / rise
    low, high = (np.clip(v, 0.0, 1.0) for v in (np.minimum(one, other), np.maximum(one, other)))
    return cast(Array, low), cast(Array, high)
