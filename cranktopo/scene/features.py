"""What is cut out of a web: bores and pockets as z-prismatic features, before any CAD kernel is asked."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cranktopo.scene.geometry import BoxPocket, CylinderPocket, Pocket
from cranktopo.scene.outline import largest_half_width_mm
from cranktopo.scene.schema import Scene

Array = NDArray[np.float64]

_BEYOND_MM = 1.0
"""How far the tool of a sloped side pocket reaches beyond the outline."""


@dataclass(frozen=True)
class Disc:
    """A round hole parallel to the crank axis.

    Attributes:
        key: key path of the feature in the scene.
        x_mm, y_mm, radius_mm: centre and radius.
        z_mm: axial range (start, end) inside the web.
    """

    key: str
    x_mm: float
    y_mm: float
    radius_mm: float
    z_mm: tuple[float, float]

    def spans(self, y_mm: Array) -> tuple[Array, Array]:
        """Lateral interval (from, to) that the hole takes at each y, mm; empty where from >= to."""
        half = np.sqrt(np.maximum(self.radius_mm**2 - (y_mm - self.y_mm) ** 2, 0.0))
        return self.x_mm - half, self.x_mm + half

    def contains(self, x_mm: Array, y_mm: Array) -> NDArray[np.bool_]:
        """Whether points lie inside the hole's cross-section.

        Args:
            x_mm, y_mm: the points, broadcastable.
        """
        return (x_mm - self.x_mm) ** 2 + (y_mm - self.y_mm) ** 2 < self.radius_mm**2

    @property
    def y_range_mm(self) -> tuple[float, float]:
        """Extent along the throw, mm."""
        return self.y_mm - self.radius_mm, self.y_mm + self.radius_mm

    def distance_mm(self, y_mm: float) -> float:
        """Distance of the hole's edge from the axis (0, y), mm; negative if it covers the axis."""
        return float(np.hypot(self.x_mm, self.y_mm - y_mm)) - self.radius_mm


@dataclass(frozen=True)
class Slab:
    """A rectangular hole: x and y ranges, z range; attributes in mm, key as in `Disc`."""

    key: str
    x_range_mm: tuple[float, float]
    y_range_mm: tuple[float, float]
    z_mm: tuple[float, float]

    def spans(self, y_mm: Array) -> tuple[Array, Array]:
        """Lateral interval (from, to) that the hole takes at each y, mm; empty where from >= to."""
        inside = (y_mm > self.y_range_mm[0]) & (y_mm < self.y_range_mm[1])
        start = np.full(y_mm.shape, self.x_range_mm[0])
        return start, np.where(inside, self.x_range_mm[1], start)

    def contains(self, x_mm: Array, y_mm: Array) -> NDArray[np.bool_]:
        """Whether points lie inside the hole's cross-section.

        Args:
            x_mm, y_mm: the points, broadcastable.
        """
        (x0, x1), (y0, y1) = self.x_range_mm, self.y_range_mm
        return (x_mm > x0) & (x_mm < x1) & (y_mm > y0) & (y_mm < y1)

    def distance_mm(self, y_mm: float) -> float:
        """Distance of the hole's edge from the axis (0, y), mm; 0 if it covers the axis."""
        (x0, x1), (y0, y1) = self.x_range_mm, self.y_range_mm
        return float(np.hypot(max(x0, -x1, 0.0), max(y0 - y_mm, y_mm - y1, 0.0)))


@dataclass(frozen=True)
class Wedge:
    """One of the two slots of a side pocket with sloped walls; key as in `Disc`.

    Attributes:
        key: key path of the pocket.
        side: sign of x.
        floor_mm, outer_mm: |x| of the floor and of the tool's end, beyond the outline.
        y_mm, half_length_mm: along the throw, at the floor.
        z_centre_mm, half_height_mm: along the crank axis, at the floor.
        slope: how much each wall opens per mm of |x|.
    """

    key: str
    side: float
    floor_mm: float
    outer_mm: float
    y_mm: float
    half_length_mm: float
    z_centre_mm: float
    half_height_mm: float
    slope: float

    def spans(self, y_mm: Array) -> tuple[Array, Array]:
        """Lateral interval (from, to) at mid-height at each y, mm; empty where from >= to."""
        inner = np.minimum(self.open_from_mm(y_mm), self.outer_mm)
        outer = np.full_like(inner, self.outer_mm)
        return (inner, outer) if self.side > 0 else (-outer, -inner)

    def open_from_mm(self, y_mm: Array) -> Array:
        """|x| from which the slot is open at mid-height at each y, mm."""
        beyond = np.maximum(np.abs(y_mm - self.y_mm) - self.half_length_mm, 0.0)
        return np.asarray(self.floor_mm + beyond / self.slope)

    @property
    def y_range_mm(self) -> tuple[float, float]:
        """Extent along the throw at the tool's end, mm."""
        half = self.half_length_mm + self._opening_mm
        return self.y_mm - half, self.y_mm + half

    @property
    def z_mm(self) -> tuple[float, float]:
        """Extent along the crank axis at the tool's end, mm."""
        half = self.half_height_mm + self._opening_mm
        return self.z_centre_mm - half, self.z_centre_mm + half

    def contains(self, x_mm: Array, y_mm: Array) -> NDArray[np.bool_]:
        """Whether points lie inside the slot at mid-height.

        Args:
            x_mm, y_mm: the points, broadcastable.
        """
        return np.asarray(self.side * x_mm > self.open_from_mm(y_mm))

    def distance_mm(self, y_mm: float) -> float:
        """Distance of the slot from the axis (0, y), mm, at mid-height."""
        y = np.linspace(*self.y_range_mm, 2001)
        return float(np.hypot(self.open_from_mm(y), y - y_mm).min())

    @property
    def _opening_mm(self) -> float:
        return self.slope * (self.outer_mm - self.floor_mm)


Feature = Disc | Slab | Wedge


def bores(scene: Scene) -> list[Disc]:
    """The bores of main journal and crankpin where they run through the web, in that order."""
    throw = scene.throw
    found = []
    for name, journal, y in (
        ("main_journal", throw.main_journal, 0.0),
        ("crankpin", throw.crankpin, throw.radius_mm),
    ):
        if journal.bore_diameter_mm:
            key = f"throw.{name}.bore_diameter_mm"
            found.append(Disc(key, 0.0, y, journal.bore_radius_mm, scene.web_z_mm))
    return found


def pockets(scene: Scene) -> list[Feature]:
    """The pockets of the web in scene order; a side pocket gives its two slots."""
    return [feature for i, p in enumerate(scene.web.pocket) for feature in _pocket(scene, i, p)]


def _pocket(scene: Scene, index: int, pocket: Pocket) -> list[Feature]:
    key, (start, end) = f"web.pocket[{index}]", scene.web_z_mm
    if isinstance(pocket, CylinderPocket):
        z = _depth_range(scene, pocket.face, pocket.depth_mm)
        return [Disc(key, pocket.x_mm, pocket.y_mm, pocket.diameter_mm / 2, z)]
    if isinstance(pocket, BoxPocket):
        half_x, half_y = pocket.size_x_mm / 2, pocket.size_y_mm / 2
        x, y = (pocket.x_mm - half_x, pocket.x_mm + half_x), (pocket.y_mm - half_y, pocket.y_mm + half_y)
        return [Slab(key, x, y, _depth_range(scene, pocket.face, pocket.depth_mm))]
    middle, half = (start + end) / 2 + pocket.offset_mm, pocket.height_mm / 2
    width = 2 * largest_half_width_mm(scene.web)
    if pocket.slope > 0:
        floor, outer = width / 2 - pocket.depth_mm, width / 2 + _BEYOND_MM
        size = (floor, outer, pocket.y_mm, pocket.length_mm / 2, middle, half, pocket.slope)
        return [Wedge(key, side, *size) for side in (1.0, -1.0)]
    inner, outer = width / 2 - pocket.depth_mm, width
    y = (pocket.y_mm - pocket.length_mm / 2, pocket.y_mm + pocket.length_mm / 2)
    z = (middle - half, middle + half)
    return [Slab(key, (inner, outer), y, z), Slab(key, (-outer, -inner), y, z)]


def _depth_range(scene: Scene, face: str, depth: float | None) -> tuple[float, float]:
    start, end = scene.web_z_mm
    if face == "through" or depth is None:
        return start, end
    return (start, start + depth) if face == "journal" else (end - depth, end)
