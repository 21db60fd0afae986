"""The faces that bound a parametric web, as zero sets of distances that are smooth in place and parameters.

A point that stays on a face while a parameter p changes moves by V with gradient.V + d(distance)/dp = 0.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from cranktopo.remodel.family import Layout, flank_of
from cranktopo.scene import Scene
from cranktopo.scene.features.fitted import FittedFeature
from cranktopo.scene.features.flank import Flank

Array = NDArray[np.float64]
_STEP = 1e-6
"""Step of central differences, mm or degrees; the distances are smooth and of the size of the web."""
_COMPLEX = 1e-30
_SAMPLES = 24
"""Places per piece of the outline among which the search for the nearest begins."""
_NEWTON = 12


@dataclass(frozen=True)
class Contact:
    """A face at some points.

    Attributes:
        distance_mm: (n,) zero on the face.
        gradient: (n, 3) by the place.
        slopes: (n, parameters) derivatives by the parameters, per mm or degree.
    """

    distance_mm: Array
    gradient: Array
    slopes: Array


class WebFace(ABC):
    """One face of the web."""

    name: str

    @abstractmethod
    def contact(self, points_mm: Array, values: Array) -> Contact:
        """The face at points (3, n) for some values of the parameters."""


@dataclass(frozen=True)
class StillFace(WebFace):
    """A face that no parameter moves: web faces, bores, the plane of symmetry."""

    name: str
    distance_mm: Callable[[Array], Array]

    @override
    def contact(self, points_mm: Array, values: Array) -> Contact:
        gradient = _gradient(self.distance_mm, points_mm)
        return Contact(self.distance_mm(points_mm), gradient, np.zeros((points_mm.shape[1], len(values))))


@dataclass(frozen=True)
class FeatureFace(WebFace):
    """One of the faces of a feature.

    Attributes:
        number: which of them.
        first: place of the feature's first value among all.
    """

    name: str
    part: FittedFeature
    number: int
    first: int
    web_z_mm: tuple[float, float]

    @override
    def contact(self, points_mm: Array, values: Array) -> Contact:
        own = list(range(self.first, self.first + len(self.part.names)))
        moving = own + ([0, 1] if self.part.follows_ends else [])
        slopes = np.zeros((points_mm.shape[1], len(values)))
        for i in moving:
            step = _STEP * np.eye(len(values))[i]
            change = self._distance(points_mm, values + step) - self._distance(points_mm, values - step)
            slopes[:, i] = change / (2 * _STEP)
        gradient = _gradient(lambda at: self._distance(at, values), points_mm)
        return Contact(self._distance(points_mm, values), gradient, slopes)

    def _distance(self, points_mm: Array, values: Array) -> Array:
        named = dict(zip(self.part.names, values[self.first :], strict=False))
        x, y, z = points_mm
        distance = self.part.faces_mm(named, values[:2], (np.abs(x), y, z), self.web_z_mm)[self.number]
        return np.asarray(np.broadcast_to(distance, x.shape))


@dataclass(frozen=True)
class OutlineFace(WebFace):
    """The outline, swept along the crank axis; distances positive inside."""

    layout: Layout
    name: str = "outline"

    @override
    def contact(self, points_mm: Array, values: Array) -> Contact:
        at = np.stack([np.abs(points_mm[0]), points_mm[1]], axis=1)
        flank = flank_of(self.layout, values)
        piece, u = _nearest(flank, at)
        tangent = _point(flank, piece, u, 1)
        normal = np.stack([tangent[:, 1], -tangent[:, 0]], axis=1) / np.linalg.norm(tangent, axis=1)[:, None]
        distance = ((_point(flank, piece, u, 0) - at) * normal).sum(axis=1)
        slopes = np.zeros((len(at), len(values)))
        for i in range(self.layout.stations):
            moved = flank_of(self.layout, values + 1j * _COMPLEX * np.eye(len(values))[i])
            slopes[:, i] = (_point(moved, piece, u, 0).imag / _COMPLEX * normal).sum(axis=1)
        side = np.where(points_mm[0] < 0, -1.0, 1.0)
        gradient = np.stack([-side * normal[:, 0], -normal[:, 1], np.zeros(len(at))], axis=1)
        return Contact(distance, gradient, slopes)


def web_faces(scene: Scene, layout: Layout, *, mirrored: bool) -> list[WebFace]:
    """All faces of the web of a layout: still ones, its outline, those of its features.

    Args:
        mirrored: the model is the half x >= 0, so that the plane x = 0 bounds it as well.
    """
    return [*_still_faces(scene, mirrored), OutlineFace(layout), *_feature_faces(scene, layout)]


def _still_faces(scene: Scene, mirrored: bool) -> Iterator[WebFace]:
    if mirrored:
        yield StillFace("plane of symmetry", lambda at: at[0])
    for name, height in zip(("journal face", "pin face"), scene.web_z_mm, strict=True):
        yield StillFace(name, partial(_above, height))
    for journal, y in scene.throw.journals:
        if journal.bore_radius_mm:
            yield StillFace("bore", partial(_off_bore, y, journal.bore_radius_mm))


def _above(height: float, at: Array) -> Array:
    above: Array = at[2] - height
    return above


def _off_bore(y: float, radius: float, at: Array) -> Array:
    off: Array = np.hypot(at[0], at[1] - y) - radius
    return off


def _feature_faces(scene: Scene, layout: Layout) -> Iterator[WebFace]:
    first = layout.stations
    origin, one = np.zeros(2), (np.ones(1),) * 3
    for part in layout.parts:
        named = dict.fromkeys(part.names, 1.0)
        count = len(part.faces_mm(named, np.array([-1.0, 9.0]) + origin, one, scene.web_z_mm))
        for number in range(count):
            yield FeatureFace(f"{part.label} {number}", part, number, first, scene.web_z_mm)
        first += len(part.names)


def _gradient(distance_mm: Callable[[Array], Array], points_mm: Array) -> Array:
    """Derivative by the place, (n, 3)."""
    columns = []
    for axis in range(3):
        step = _STEP * np.eye(3)[axis][:, None]
        columns.append((distance_mm(points_mm + step) - distance_mm(points_mm - step)) / (2 * _STEP))
    return np.stack(columns, axis=1)


def _nearest(flank: Flank, at: Array) -> tuple[NDArray[np.intp], Array]:
    """Piece of the flank and place on it, 0 to 1, nearest to points (n, 2)."""
    from scipy.spatial import cKDTree

    u = (np.arange(_SAMPLES) + 0.5) / _SAMPLES
    _, found = cKDTree(flank.at(u).reshape(-1, 2)).query(at)
    piece, place = found // _SAMPLES, u[found % _SAMPLES]
    for _ in range(_NEWTON):
        gap = _point(flank, piece, place, 0) - at
        first, second = _point(flank, piece, place, 1), _point(flank, piece, place, 2)
        bend = (first * first).sum(axis=1)
        curvature = np.maximum(bend + (gap * second).sum(axis=1), bend / 2)
        place = np.clip(place - (gap * first).sum(axis=1) / curvature, 0.0, 1.0)
    return piece, place


def _point(flank: Flank, piece: NDArray[np.intp], u: Array, order: int) -> Array:
    """Points at u of chosen pieces, (n, 2), or their derivatives of an order by u."""
    length = flank.lengths_mm[piece][:, None]
    start, end = flank.points_mm[piece], flank.points_mm[piece + 1]
    leave, arrive = flank.slopes[piece] * length, flank.slopes[piece + 1] * length
    cubic = (start, leave, 3 * (end - start) - 2 * leave - arrive, leave + arrive - 2 * (end - start))
    t = u[:, None]
    if order == 0:
        return np.asarray(cubic[0] + t * (cubic[1] + t * (cubic[2] + t * cubic[3])))
    if order == 1:
        return np.asarray(cubic[1] + t * (2 * cubic[2] + 3 * t * cubic[3]))
    return np.asarray(2 * cubic[2] + 6 * t * cubic[3])
