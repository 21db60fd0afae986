"""Mass that drillings take out of a half throw, without a CAD kernel: the oracle of its exact solid.

In a plane that holds the drilling's direction and the crank axis' direction, a drilling is a strip and each
journal a rectangle: their common polygons are integrated exactly, and Gauss quadrature across the drilling
does the rest. The rounding of an outlet is the ring that a ball leaves which rolls around the edge inside
the material.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import lru_cache
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
_AROUND, _GAUSS = 360, 8
"""Points around an outlet, and along and across the section of its ring."""
_STEP = 1e-5
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
            total = total + sum((Moments(*ring) for ring in rings), none)
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
            total = total + Moments(*_ring(bore.radius_mm, outlet, (-math.inf, 0.0), before))
    return total


@lru_cache(maxsize=64)
def _bored(
    throw: JournalsView, z_mm: tuple[float, float, float], bore: DrillBore, part: Part, before: float | None
) -> Moments:
    """Return what a bore takes out of a part; both faces of the web and the end of the bore are at heights.

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
        z_mm: tuple[float, float, float],
        bore: DrillBore,
        part: Part,
        before: float | None,
    ) -> None:
        self._before = before
        self._start = np.array(bore.outlets[0].point_mm)
        direction = bore.direction
        level = float(np.hypot(*direction[:2]))
        self._way = np.array([level, direction[2]])
        self._along = direction[:2] / level
        self._aside = np.array([-self._along[1], self._along[0]])
        self._ends = bore.extent_mm
        low, high, end = z_mm
        (main, _), (pin, radius) = throw.journals
        self._z = {
            "beyond": (-main.length_mm / 2, 0.0),
            "main_journal": (0.0, low),
            "web": (low, high),
            "crankpin": (high, end),
        }[part]
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
        centre = np.array([0.0, y]) - self._start[:2]
        return float(centre @ self._along), float(centre @ self._aside), radius

    def __call__(self, place: float, width: float) -> Array:
        """Integrals of 1, x, y and x2 + y2 over the section at a place across the drilling."""
        total = np.zeros(4)
        for left, right in self._material(place):
            polygon = self._common(width, left, right)
            if len(polygon) > 2:
                total += self._integrals(np.array(polygon), place)
        return total

    def _material(self, place: float) -> Iterator[tuple[float, float]]:
        solid = (-self._far, self._far) if self._solid is None else _chord(self._solid, place)
        at = solid[0]
        for left, right in sorted(_chord(bore, place) for bore in self._bores):
            if left < right:
                yield at, left
                at = right
        yield at, solid[1]

    def _common(self, width: float, left: float, right: float) -> list[Array]:
        """Corners of the drilling's strip between two places and within the heights of the part."""
        across = np.array([-self._way[1], self._way[0]])
        origin = np.array([0.0, self._start[2]])
        first, last = self._ends
        turns = ((first, -width), (last, -width), (last, width), (first, width))
        corners = [origin + along * self._way + aside * across for along, aside in turns]
        low, high = self._z
        for axis, sign, limit in ((0, 1, left), (0, -1, -right), (1, 1, low), (1, -1, -high)):
            corners = _clipped(corners, axis, sign, limit)
        return corners

    def _integrals(self, corners: Array, place: float) -> Array:
        """By the midpoints of the edges of triangles, which is exact for squares."""
        first, second = corners[1:-1] - corners[0], corners[2:] - corners[0]
        area = (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]) / 2
        ends = np.stack([np.broadcast_to(corners[0], first.shape), corners[1:-1], corners[2:]])
        middle = (ends + np.roll(ends, 1, axis=0)) / 2
        flat = self._start[:2] + middle[..., :1] * self._along + place * self._aside
        weight = area / 3
        if self._before is not None:
            weight = weight * (self._before - middle[..., 1])
        values = [np.ones(flat.shape[:-1]), flat[..., 0], flat[..., 1], (flat**2).sum(axis=-1)]
        return np.array([float((weight * value).sum()) for value in values])


def _chord(circle: tuple[float, float, float], place: float) -> tuple[float, float]:
    along, across, radius = circle
    half = float(np.sqrt(max(radius**2 - (place - across) ** 2, 0.0)))
    return along - half, along + half


def _clipped(corners: list[Array], axis: int, sign: int, limit: float) -> list[Array]:
    """Return the part of a convex polygon on one side of a line: sign times a coordinate >= limit."""
    kept: list[Array] = []
    for here, after in zip(corners, [*corners[1:], *corners[:1]], strict=True):
        one, other = sign * here[axis] - limit, sign * after[axis] - limit
        if one >= 0:
            kept.append(here)
        if (one > 0 > other) or (one < 0 < other):
            kept.append(here + (after - here) * one / (one - other))
    return kept


def _end(scene: ThrowView, bore: DrillBore) -> float:
    """Height at which what a drilling takes out of its half throw ends, mm."""
    return math.inf if bore.alone else scene.pitch_mm / 2


@lru_cache(maxsize=64)
def _ring(
    radius_mm: float, outlet: DrillOutlet, z_mm: tuple[float, float], before_z_mm: float | None
) -> tuple[float, ...]:
    share, weight = gauss_legendre(_GAUSS)
    share, weight = (share + 1) / 2, weight / 2
    turn, arc = (v.ravel() for v in np.meshgrid(2 * np.pi * np.arange(_AROUND) / _AROUND, share))
    low, high = _inside(radius_mm, outlet, turn, arc, z_mm)
    out = low[:, None] + (high - low)[:, None] * share
    at = [np.broadcast_to(v[:, None], out.shape).ravel() for v in (turn, arc)] + [out.ravel()]
    points = ring_points(radius_mm, outlet, *at)
    edges = []
    for axis in range(3):
        step = [_STEP * (axis == other) for other in range(3)]
        above, below = (
            ring_points(radius_mm, outlet, *(a + sign * s for a, s in zip(at, step, strict=True)))
            for sign in (1, -1)
        )
        edges.append((above - below) / (2 * _STEP))
    size = np.abs(np.einsum("ni,ni->n", edges[0], np.cross(edges[1], edges[2]))).reshape(out.shape)
    section = np.repeat(weight, _AROUND)[:, None] * weight * (high - low)[:, None]
    volume = (size * section).ravel() * 2 * np.pi / _AROUND
    x, y, z = points.T
    if before_z_mm is not None:
        volume = volume * (before_z_mm - z)
    return tuple(float((volume * value).sum()) for value in (np.ones(len(x)), x, y, x**2 + y**2))


def _inside(
    radius_mm: float, outlet: DrillOutlet, turn: Array, arc: Array, z_mm: tuple[float, float]
) -> tuple[Array, Array]:
    """From where to where lines from the edge to the rounding lie between two heights, in shares of them."""
    z0, z1 = (ring_points(radius_mm, outlet, turn, arc, np.full(turn.shape, end))[:, 2] for end in (0.0, 1.0))
    rise = np.where(np.abs(z1 - z0) < 1e-12, 1e-12, z1 - z0)
    one, other = (z_mm[0] - z0) / rise, (z_mm[1] - z0) / rise
    low, high = (np.clip(v, 0.0, 1.0) for v in (np.minimum(one, other), np.maximum(one, other)))
    return cast(Array, low), cast(Array, high)
