"""Fill of cells by a web of the family, with its gradient: signed distances through a smooth step.

The step's width shrinks during the fit. It is odd about the surface, so that a flat surface is fitted
without bias at any width.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.family import own_values
from cranktopo.throw.feature import Body
from cranktopo.throw.fitted import Axes, FittedFeature
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

    def inside_mm(
        self, points: Array, values: Array, added: Mapping[int, Array]
    ) -> tuple[Array, NDArray[np.int8]]:
        """Return signed distance of every cell, (nx, ny, nz), mm, and which field it is of: 0 the outline.

        Args:
            points: (n, 2) points of the outline's right half, from end to end, mm.
            added: signed distances from what is added to the outline, (nx, ny, nz), by number of the field.
        """
        inside = np.empty(tuple(axis.size for axis in self.axes))
        inside[:] = _outline_distance(points, *self.axes[:2])[:, :, None]
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
        """Return derivative of sum(weight * inside_mm) by the points, (n, 2), and by the values of the parts.

        Args:
            points: (n, 2) points of the outline's right half, from end to end, mm.
            which: (nx, ny, nz) which field counts in each cell, from `inside_mm`.
            weight: (nx, ny, nz) weight of each cell's distance.
        """
        chosen = np.where(which == 0, weight, 0.0).sum(axis=2)
        by_points = _outline_vjp(points, *self.axes[:2], chosen)
        by_values = []
        for k, (part, own) in enumerate(own_values(self.parts, values)):
            chosen = np.where(which == k + 1, weight, 0.0)
            by_own, by_ends = part.vjp(own, _ends(points), self.axes, self.web_z_mm, chosen)
            by_values.append(by_own)
            by_points[[0, -1], 1] += by_ends
        return by_points, np.concatenate([np.zeros(0), *by_values])


def added_mm(scene: Scene, axes: Axes) -> Array | None:
    """Signed distance of cells from what no fit takes away, (nx, ny, nz), mm."""
    x, y, z = axes
    found = [
        np.minimum(body.inside_mm(x[:, None], y[None, :])[:, :, None], between_mm(scene, body, z))
        for body in kept_bodies(scene)
    ]
    return functools.reduce(np.maximum, found) if found else None


def between_mm(scene: Scene, body: Body, z_mm: Array) -> Array:
    """Distance of heights from the nearer face of a body, positive between both."""
    (start, end), (low, high) = scene.web_z_mm, body.z_mm
    # The web's own faces bound the cells already.
    below, above = z_mm - low if low > start else np.inf, high - z_mm if high < end else np.inf
    return np.broadcast_to(np.minimum(below, above), z_mm.shape)


def smooth_step(inside_mm: Array, width_mm: float) -> tuple[Array, Array]:
    """Return the fill from signed distance, and its derivative by the distance, 1/mm.

    Args:
        inside_mm: signed distance, positive inside.
        width_mm: half-width of the step.
    """
    u = np.clip(inside_mm / width_mm, -1.0, 1.0)
    return 0.5 + 0.75 * u - 0.25 * u**3, 0.75 * (1 - u**2) / width_mm


def _ends(points: Array) -> Array:
    return points[[0, -1], 1]


def _outline_distance(points: Array, x_mm: Array, y_mm: Array) -> Array:
    """Return the signed distance from the outline, (nx, ny), mm; positive inside.

    Args:
        points: (n, 2) points of the outline's right half, from end to end, mm.
        x_mm, y_mm: (nx,) and (ny,) coordinates of the cells.
    """
    return _nearest(points, x_mm, y_mm)[0]


def _outline_vjp(points: Array, x_mm: Array, y_mm: Array, weight: Array) -> Array:
    """Return derivative of sum(weight * distance) by the points: a chord's ends move with the foot on it."""
    _, chord, along, normal = _nearest(points, x_mm, y_mm)
    result = np.zeros(points.shape)
    for end, share in ((chord, 1 - along), (chord + 1, along)):
        for axis in range(2):
            pull = (-weight * share * normal[..., axis]).ravel()
            result[:, axis] += np.bincount(end.ravel(), pull, len(points))
    return result


def _nearest(points: Array, x_mm: Array, y_mm: Array) -> tuple[Array, NDArray[np.intp], Array, Array]:
    """Return the signed distance, nearest chord, place on it (0 to 1) and unit vector of growing distance."""
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
    return sign * distance, chord, share, sign[..., None] * away / np.maximum(distance, _TINY)[..., None]
