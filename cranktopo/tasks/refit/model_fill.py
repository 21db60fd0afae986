"""A web of the family on cells: fill, signed distance and derivatives; the counterweight's fillet."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.design.schema import Scene
from cranktopo.numerics.optimisers.gradient_search import central_difference
from cranktopo.tasks.refit.family import Layout, flank_of, own_values, scene_at
from cranktopo.throw.counterweight.sector import Sector
from cranktopo.throw.counterweight.tangent_circle import (
    OutlineSection,
    TangentCircle,
    flank_directions,
    tangent_circle,
)
from cranktopo.throw.feature import Body
from cranktopo.throw.fitted import CLEAR_MM, Axes, FittedFeature, Rule
from cranktopo.throw.profile import flank_half_width_mm
from cranktopo.throw.web import kept_bodies

_TINY = 1e-12
ADDED, FILLET = -1, -2
"""Numbers of the fields of a counterweight and of its fillets."""
CHORDS = 48
"""Chords of the outline's right half in the distance field."""


class Fill:
    """The fill of a grid, cell centres `axes`, by an outline and features."""

    def __init__(self, parts: tuple[FittedFeature, ...], axes: Axes, web_z_mm: tuple[float, float]) -> None:
        self.parts, self.axes, self.web_z_mm = parts, axes, web_z_mm
        self._last: tuple[bytes, _Nearest] | None = None

    def inside_mm(
        self, points: Array, values: Array, added: Mapping[int, Array]
    ) -> tuple[Array, NDArray[np.int8]]:
        """Return signed distance of every cell, (nx, ny, nz), mm, and which field it is of: 0 the outline.

        Args:
            points: (n, 2) points of the outline's right half, from end to end, mm.
            added: signed distances from what is added to the outline, (nx, ny, nz), by number of the field.
        """
        inside = np.empty(tuple(axis.size for axis in self.axes))
        inside[:] = self._nearest(points).distance_mm[:, :, None]
        which = np.zeros(inside.shape, dtype=np.int8)
        for number, field in added.items():
            which[field > inside] = number
            np.maximum(inside, field, out=inside)
        for k, (part, own) in enumerate(own_values(self.parts, values)):
            field = part.field_mm(own, _ends(points), self.axes, self.web_z_mm)
            lower = field < inside
            np.copyto(inside, field, where=lower)
            which[lower] = k + 1
        return inside, which

    def vjp(
        self, points: Array, values: Array, which: NDArray[np.int8], weight: Array
    ) -> tuple[Array, Array]:
        """Return derivative of sum(weight * inside_mm) by the points, (n, 2), and the values of the parts."""
        chosen = np.where(which == 0, weight, 0.0).sum(axis=2)
        by_points = _outline_vjp(self._nearest(points), len(points), chosen)
        by_values = []
        for k, (part, own) in enumerate(own_values(self.parts, values)):
            chosen = np.where(which == k + 1, weight, 0.0)
            by_own, by_ends = part.vjp(own, _ends(points), self.axes, self.web_z_mm, chosen)
            by_values.append(by_own)
            by_points[[0, -1], 1] += by_ends
        return by_points, np.concatenate([np.zeros(0), *by_values])

    def _nearest(self, points: Array) -> _Nearest:
        """Return the nearest chords of the last outline, which the gradient asks for again."""
        if self._last is None or self._last[0] != points.tobytes():
            self._last = points.tobytes(), _nearest(points, *self.axes[:2])
        return self._last[1]


def added_mm(scene: Scene, axes: Axes) -> Array | None:
    """Return the signed distance of cells from what no fit takes away, (nx, ny, nz), mm."""
    x, y, z = axes
    found = [
        np.minimum(body.inside_mm(x[:, None], y[None, :])[:, :, None], _between_mm(scene, body, z))
        for body in kept_bodies(scene)
    ]
    return functools.reduce(np.maximum, found) if found else None


def _between_mm(scene: Scene, body: Body, z_mm: Array) -> Array:
    """Distance of heights from the nearer face of a body, positive between both."""
    (start, end), (low, high) = scene.web_z_mm, body.z_mm
    # The web's own faces bound the cells already.
    below, above = z_mm - low if low > start else np.inf, high - z_mm if high < end else np.inf
    return np.broadcast_to(np.minimum(below, above), z_mm.shape)


def smooth_step(inside_mm: Array, width_mm: float) -> tuple[Array, Array]:
    """Return the fill from signed distance, positive inside, and its derivative, 1/mm.

    Args:
        width_mm: half-width of the step.
    """
    u = np.clip(inside_mm / width_mm, -1.0, 1.0)
    return 0.5 + 0.75 * u - 0.25 * u**3, 0.75 * (1 - u**2) / width_mm


def _ends(points: Array) -> Array:
    return points[[0, -1], 1]


def _outline_vjp(nearest: _Nearest, points: int, weight: Array) -> Array:
    """Return derivative of sum(weight * distance) by the points: a chord's ends move with the foot on it."""
    chord, along = nearest.chord, nearest.along
    result = np.zeros((points, 2))
    for end, share in ((chord, 1 - along), (chord + 1, along)):
        for axis in range(2):
            pull = (-weight * share * nearest.normal[..., axis]).ravel()
            result[:, axis] += np.bincount(end.ravel(), pull, points)
    return result


class _Nearest(NamedTuple):
    """Chords that are nearest to cells (nx, ny).

    Attributes:
        distance_mm: signed, positive inside.
        along: place on the chord, 0 to 1.
        normal: unit vector of growing distance, (nx, ny, 2).
    """

    distance_mm: Array
    chord: NDArray[np.intp]
    along: Array
    normal: Array


def _nearest(points: Array, x_mm: Array, y_mm: Array) -> _Nearest:
    """Return the nearest chord of an outline's right half from end to end, (n, 2), for each cell."""
    start, step = points[:-1], np.diff(points, axis=0)
    px, py = x_mm[:, None, None] - start[:, 0], y_mm[None, :, None] - start[:, 1]
    along = np.clip((px * step[:, 0] + py * step[:, 1]) / (step**2).sum(axis=1), 0.0, 1.0)
    square = (px - along * step[:, 0]) ** 2 + (py - along * step[:, 1]) ** 2
    chord = square.argmin(axis=-1)
    edge = np.interp(y_mm, points[:, 1], points[:, 0])
    across = (y_mm > points[0, 1]) & (y_mm < points[-1, 1])
    sign = np.where((x_mm[:, None] < edge) & across, 1.0, -1.0)

    def at(field: Array) -> Array:
        return np.take_along_axis(np.broadcast_to(field, square.shape), chord[..., None], -1)[..., 0]

    distance, share = np.sqrt(at(square)), at(along)
    away = np.stack([at(px) - share * step[chord, 0], at(py) - share * step[chord, 1]], axis=-1)
    normal = sign[..., None] * away / np.maximum(distance, _TINY)[..., None]
    return _Nearest(sign * distance, chord, share, normal)


_STEP = 1e-6
"""Step of central differences of the half-width by its stations, mm."""
_DEPTH = 4.0
"""Depth behind its arc to which the fillet's distance counts, over the radius; web and sector go on."""
FITS = "the flank of the counterweight holds its fillet"


@dataclass(frozen=True)
class MovedFillet:
    """The fillet at some values of the parameters, in the scene with their dimensions."""

    scene: Scene
    layout: Layout
    values: Array

    @cached_property
    def circle(self) -> TangentCircle:
        """Its circle, on a flank without end."""
        ends = float(self.values[0]), float(self.values[1])
        outline = OutlineSection(lambda y: self._half_width_mm(self.values, y), ends)
        return tangent_circle(outline, self.sector.half_angle, self._radius_mm)

    @cached_property
    def sector(self) -> Sector:
        """The counterweight without it."""
        assert self.scene.web.counterweight is not None
        return self.scene.web.counterweight.sector(self.scene)

    @cached_property
    def gradients(self) -> Array:
        """Derivatives of its centre by the parameters, (2, parameters), mm per mm or degree.

        It stays its radius away from the flank, which turns, and from the outline, which moves at the place
        that it touches by its half-width there.
        """
        circle = self.circle
        _, across = flank_directions(self.sector.half_angle)
        normal = (np.array(circle.centre) - circle.on_outline) / circle.radius_mm
        moved = np.zeros((2, len(self.values)))
        if "counterweight_angle" in self.layout.dimensions:
            turned = self.layout.names.index("counterweight_angle")
            moved[0, turned] = circle.reach_mm * math.radians(1.0)
        at = np.array([circle.on_outline[1]])
        stations = range(self.layout.stations)
        by_values = central_difference(lambda v: self._half_width_mm(v, at)[0], self.values, _STEP, stations)
        moved[1] += normal[0] * by_values
        return np.asarray(np.linalg.solve(np.stack([across, normal]), moved))

    @property
    def rule(self) -> Rule:
        """It ends before the flank does."""
        return FITS, np.asarray(self.circle.reach_mm + CLEAR_MM - self.sector.radius_mm)

    @property
    def rule_gradients(self) -> Array:
        """Derivatives of the rule's value by the parameters, (parameters,)."""
        # The centre's place along the flank; as the flank turns about the crank axis, that across it counts.
        along, _ = flank_directions(self.sector.half_angle)
        result = along @ self.gradients
        for name, change in (
            ("counterweight_angle", self._radius_mm * math.radians(1.0)),
            ("counterweight_radius", -1.0),
        ):
            if name in self.layout.dimensions:
                result[self.layout.names.index(name)] += change
        return result

    def inside_mm(self, axes: Axes) -> Array:
        """Return signed distance of cells where the arc bounds the web, (nx, ny, nz), mm; -inf elsewhere."""
        return self.at_mm(axes[0][:, None, None], axes[1][None, :, None], axes[2])

    def at_mm(self, x_mm: Array, y_mm: Array, z_mm: Array) -> Array:
        """Return the same of points, broadcastable."""
        off = self.circle.off_mm(x_mm, y_mm)
        below_rim = self.sector.below_rim_mm(x_mm, y_mm)
        flat = np.minimum(np.minimum(off, _DEPTH * self._radius_mm - off), below_rim)
        flat = np.where(self.circle.behind(x_mm, y_mm), flat, -np.inf)
        return np.minimum(flat, _between_mm(self.scene, self.sector, z_mm))

    def vjp(self, axes: Axes, weight: Array) -> Array:
        """Return derivative of sum(weight * inside_mm) by the parameters, where the arc is the nearest."""
        x, y = axes[0][:, None], axes[1][None, :]
        off = self.circle.off_mm(x, y)[:, :, None]
        chosen = np.where(self.inside_mm(axes) == off, weight, 0.0).sum(axis=2)
        out = self.circle.outward(x, y)
        return np.asarray(-np.array([(chosen * part).sum() for part in out]) @ self.gradients)

    @property
    def _radius_mm(self) -> float:
        weight = self.scene.web.counterweight
        assert weight is not None
        assert weight.fillet_mm is not None
        return weight.fillet_mm

    def _half_width_mm(self, values: Array, y_mm: Array) -> Array:
        return flank_half_width_mm(flank_of(self.layout, values), y_mm)


def moved_fillet(scene: Scene, layout: Layout, values: Array) -> MovedFillet | None:
    """Return the fillet of a scene's counterweight at some values; None without one."""
    weight = scene.web.counterweight
    if weight is None or weight.fillet_mm is None:
        return None
    return MovedFillet(scene_at(scene, layout, values), layout, values)
