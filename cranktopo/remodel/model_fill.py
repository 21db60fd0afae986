"""Fill of cells by a web of the family, with its gradient: signed distances through a smooth step.

The step's width shrinks during the fit. It is odd about the surface, so that a flat surface is fitted
without bias at any width. Nothing is compiled: the compiler may take minutes over one combination of parts.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.remodel.family import Bevel, FittedFeature, Pocket
from cranktopo.scene.bevel import BevelArc

_TINY = 1e-12
_STEP = 1e-6
"""Step of the derivatives by the parameters of a part, mm or degrees."""
CHORDS = 48
"""Chords of the outline's right half in the distance field."""
Array = NDArray[np.float64]
Axes = tuple[Array, Array, Array]


class Fill:
    """The fill of a grid by an outline and its parts.

    Args:
        parts: bevels and pockets.
        axes: x, y and z of the cell centres, mm.
        web_z_mm: web faces.
    """

    def __init__(self, parts: tuple[FittedFeature, ...], axes: Axes, web_z_mm: tuple[float, float]) -> None:
        self.parts, self.axes, self.web_z_mm = parts, axes, web_z_mm

    def inside_mm(self, points: Array, values: Array) -> tuple[Array, NDArray[np.int8]]:
        """Signed distance of every cell, (nx, ny, nz), mm, and which field is the least there: 0 the outline.

        Args:
            points: (n, 2) points of the outline's right half, from end to end, mm.
            values: parameters of the parts.
        """
        inside = np.empty(tuple(axis.size for axis in self.axes))
        inside[:] = outline_distance(points, *self.axes[:2])[:, :, None]
        which = np.zeros(inside.shape, dtype=np.int8)
        for k, (part, own) in enumerate(self._own(values)):
            field = _part_field(part, own, _ends(points), self.axes, self.web_z_mm)
            lower = field < inside
            np.copyto(inside, field, where=lower)
            which[lower] = k + 1
        return inside, which

    def pulled_back(
        self, points: Array, values: Array, which: NDArray[np.int8], weight: Array
    ) -> tuple[Array, Array]:
        """Derivative of sum(weight * inside_mm) by the points, (n, 2), and by the values of the parts.

        Args:
            points: (n, 2) points of the outline's right half, from end to end, mm.
            values: parameters of the parts.
            which: (nx, ny, nz) which field is the least in each cell, from `inside_mm`.
            weight: (nx, ny, nz) weight of each cell's distance.
        """
        chosen = np.where(which == 0, weight, 0.0).sum(axis=2)
        by_points = _outline_pulled_back(points, *self.axes[:2], chosen)
        by_values = []
        for k, (part, own) in enumerate(self._own(values)):
            chosen = np.where(which == k + 1, weight, 0.0)
            if isinstance(part, Bevel):
                chosen = chosen.sum(axis=0, keepdims=True)
            by_own, by_ends = _part_pulled_back(part, own, _ends(points), self.axes, self.web_z_mm, chosen)
            by_values.append(np.asarray(by_own))
            by_points[[0, -1], 1] += np.asarray(by_ends)
        return by_points, np.concatenate([np.zeros(0), *by_values])

    def _own(self, values: Array) -> list[tuple[FittedFeature, Array]]:
        ends = np.cumsum([len(part.names) for part in self.parts])
        return list(zip(self.parts, np.split(values, ends[:-1]), strict=True)) if self.parts else []


def smooth_step(inside_mm: Array, width_mm: float) -> tuple[Array, Array]:
    """Fill from signed distance, and its derivative by the distance, 1/mm.

    Args:
        inside_mm: signed distance, positive inside, any shape.
        width_mm: half-width of the step.
    """
    u = np.clip(inside_mm / width_mm, -1.0, 1.0)
    return 0.5 + 0.75 * u - 0.25 * u**3, 0.75 * (1 - u**2) / width_mm


def _part_field(
    part: FittedFeature, values: Array, ends: Array, axes: Axes, web_z_mm: tuple[float, float]
) -> Array:
    """Signed distance from what a part takes off, broadcastable to the cells, mm."""
    named = {name: values[i] for i, name in enumerate(part.names)}
    if isinstance(part, Pocket):
        return np.asarray(-_pocket_distance(part, named, axes, web_z_mm))
    return np.asarray(_bevel_distance(part, named, ends, axes, web_z_mm))


def _part_pulled_back(
    part: FittedFeature, values: Array, ends: Array, axes: Axes, web_z_mm: tuple[float, float], weight: Array
) -> tuple[Array, Array]:
    """Derivative of sum(weight * distance) by the values of a part and by the ends, by central differences.

    A compiled derivative would be exact, but the compiler may take minutes over one.
    """
    both = np.concatenate([values, ends])
    count = len(both) if isinstance(part, Bevel) else len(values)
    slopes = np.zeros(len(both))
    for i, step in enumerate(_STEP * np.eye(len(both))[:count]):
        above, below = (
            _part_field(part, shifted[: len(values)], shifted[len(values) :], axes, web_z_mm)
            for shifted in (both + step, both - step)
        )
        slopes[i] = float(((above - below) * weight).sum()) / (2 * _STEP)
    return slopes[: len(values)], slopes[len(values) :]


def _ends(points: Array) -> Array:
    return points[[0, -1], 1]


def _bevel_distance(part: Bevel, named: dict[str, Any], ends: Any, axes: Any, web_z_mm: Any) -> Any:
    """Signed distance below a bevel, (1, ny, nz), mm."""
    arc = bevel_arc_of(part, named, ends)
    depth, reach = _depth(part.face, axes[2], web_z_mm), arc.outward * axes[1][:, None]
    return arc.distance_mm(np, depth[None, :], reach)[None]


def bevel_arc_of(part: Bevel, named: dict[str, Any], ends: Any) -> BevelArc:
    """The arc of a bevel of the family.

    Args:
        part: the bevel.
        named: its parameters by name, mm.
        ends: least and largest y of the outline, mm.
    """
    if part.face == "journal":
        return BevelArc(named["y"], ends[1], named["depth"], named["crown"], 1.0)
    return BevelArc(-named["y"], -ends[0], named["depth"], named["crown"], -1.0)


def outline_distance(points: Array, x_mm: Array, y_mm: Array) -> Array:
    """Signed distance from the outline, (nx, ny), mm; positive inside.

    Args:
        points: (n, 2) points of the outline's right half, from end to end, mm.
        x_mm, y_mm: (nx,) and (ny,) coordinates of the cells.
    """
    return _nearest(points, x_mm, y_mm)[0]


def _outline_pulled_back(points: Array, x_mm: Array, y_mm: Array, weight: Array) -> Array:
    """Derivative of sum(weight * distance) by the points: a chord's ends move with the foot on it."""
    _, chord, along, normal = _nearest(points, x_mm, y_mm)
    result = np.zeros(points.shape)
    for end, share in ((chord, 1 - along), (chord + 1, along)):
        for axis in range(2):
            pull = (-weight * share * normal[..., axis]).ravel()
            result[:, axis] += np.bincount(end.ravel(), pull, len(points))
    return result


def _nearest(points: Array, x_mm: Array, y_mm: Array) -> tuple[Array, NDArray[np.intp], Array, Array]:
    """Signed distance, nearest chord, place on it (0 to 1) and unit vector of growing distance."""
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


def _pocket_distance(part: Pocket, named: dict[str, Any], axes: Any, web_z_mm: Any) -> Any:
    """Signed distance of a pocket, positive in it, broadcastable to the cells, mm."""
    x, y, z = axes[0][:, None, None], axes[1][None, :, None], axes[2]
    along = np.abs(y - named.get("y", 0.0))
    if part.face == "side":
        angle = np.deg2rad(named["draft"])
        deep = x - named["floor"]
        opening, lean = deep * np.tan(angle), np.cos(angle)
        height = np.abs(z - (web_z_mm[0] + web_z_mm[1]) / 2 - named["offset"])
        walls = named["height"] / 2 + opening - height
        if part.shape == "side":
            walls = np.minimum(walls, named["length"] / 2 + opening - along)
        return np.minimum(deep, walls * lean)
    across = x - named.get("x", 0.0)
    if part.shape == "cylinder":
        result = named["diameter"] / 2 - np.sqrt(across**2 + along**2 + 1e-12)
    else:
        result = np.minimum(named["size_x"] / 2 - np.abs(across), named["size_y"] / 2 - along)
    if part.face == "through":
        return result
    return np.minimum(result, named["depth"] - _depth(part.face, z, web_z_mm))


def _depth(face: str, z_mm: Any, web_z_mm: Any) -> Any:
    start, end = web_z_mm
    return z_mm - start if face == "journal" else end - z_mm
