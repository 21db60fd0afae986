"""Area moments of the web's cross-section at each height, with bores and pockets taken out."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from cranktopo.scene.bevel import bevel_cuts_mm, throw_range_mm
from cranktopo.scene.geometry import BoxPocket, CylinderPocket, Web
from cranktopo.scene.outline import half_width_mm, largest_half_width_mm, y_range_mm
from cranktopo.scene.schema import Scene
from cranktopo.scene.side_pocket import side_cuts_mm, side_floor_mm

Array = NDArray[np.float64]
SECTIONS = 6
"""Layers of a bevel or of sloped pocket walls, two Gauss points each: below 1e-4 of the web's volume."""
STRIPS = 20001  # an arc's end costs about STRIPS^-1.5 of its area: below 1e-6


@dataclass(frozen=True)
class Moments:
    """Moments of a plane area or of a prism (then times its height).

    Attributes:
        area: integral of 1, mm2 (mm3).
        first_x: integral of x, mm3 (mm4).
        first_y: integral of y, mm3 (mm4).
        polar: integral of x^2 + y^2 about the crank axis, mm4 (mm5).
    """

    area: float
    first_x: float
    first_y: float
    polar: float

    def __add__(self, other: Moments) -> Moments:
        return Moments(
            self.area + other.area,
            self.first_x + other.first_x,
            self.first_y + other.first_y,
            self.polar + other.polar,
        )

    def times(self, factor: float) -> Moments:
        """All moments multiplied by a height or a density."""
        return Moments(self.area * factor, self.first_x * factor, self.first_y * factor, self.polar * factor)


def web_moments(scene: Scene) -> Moments:
    """Moments of one whole web: the sections between the cuts of the pockets, times their heights."""
    start, stop = scene.web_z_mm
    bevels = [start + height for height in bevel_cuts_mm(scene.web, SECTIONS)]
    sloped = bool(bevels) or any(p.shape == "side" and p.slope for p in scene.web.pocket)
    cuts = sorted({start, stop, *(z for z in [*_pocket_cuts(scene), *bevels] if start < z < stop)})
    total = Moments(0.0, 0.0, 0.0, 0.0)
    for low, high in pairwise(cuts):
        middle, offset = (low + high) / 2, (high - low) / math.sqrt(12)
        for z in (middle - offset, middle + offset) if sloped else (middle,):
            share = 0.5 if sloped else 1.0
            total = total + section_moments(scene, z).times(share * (high - low))
    return total


def section_moments(scene: Scene, z_mm: float) -> Moments:
    """Moments of the web's cross-section at a height inside the web.

    The section is cut into strips along x; holes are intervals of each strip, so overlapping holes and
    holes across the outline count once.

    Args:
        scene: the scene.
        z_mm: height above the mid-main-journal plane, between the web faces, mm.
    """
    radius = scene.throw.radius_mm
    step, y, edge = _strips(scene.web, radius)
    lowest, highest = throw_range_mm(scene.web, radius, z_mm - scene.web_z_mm[0])
    edge = np.where((y >= lowest) & (y <= highest), edge, 0.0)
    left, right = _solid_intervals(edge, _holes(scene, z_mm, y))
    length = (right - left).sum(axis=0)
    return Moments(
        area=float(length.sum() * step),
        first_x=float((right**2 - left**2).sum() / 2 * step),
        first_y=float((length * y).sum() * step),
        polar=float(((right**3 - left**3).sum() / 3 + (length * y**2).sum()) * step),
    )


@lru_cache(maxsize=4)
def _strips(web: Web, radius_mm: float) -> tuple[float, Array, Array]:
    """Height of a strip, places of the strips along the throw, half-widths there; one for all sections."""
    low, high = y_range_mm(web, radius_mm)
    step = (high - low) / STRIPS
    y: Array = low + step * (np.arange(STRIPS, dtype=np.float64) + 0.5)
    return step, y, half_width_mm(web, radius_mm, y)


def _pocket_cuts(scene: Scene) -> list[float]:
    """Heights at which a pocket begins or ends."""
    start, stop = scene.web_z_mm
    cuts: list[float] = []
    for pocket in scene.web.pocket:
        if pocket.shape == "side":
            cuts += [start + height for height in side_cuts_mm(scene.web, pocket, SECTIONS)]
        elif pocket.depth_mm is not None:
            cuts.append(start + pocket.depth_mm if pocket.face == "journal" else stop - pocket.depth_mm)
    return cuts


def _holes(scene: Scene, z: float, y: Array) -> list[tuple[Array, Array]]:
    """Left and right ends of the hole in each strip, one pair per hole; empty strips have left = right."""
    throw = scene.throw
    holes = [_disc(y, 0.0, 0.0, throw.main_journal.bore_radius_mm)]
    holes.append(_disc(y, 0.0, throw.radius_mm, throw.crankpin.bore_radius_mm))
    start, stop = scene.web_z_mm
    wall = np.full_like(y, 2 * largest_half_width_mm(scene.web))
    for pocket in scene.web.pocket:
        if pocket.shape == "side":
            inner = np.minimum(side_floor_mm(scene.web, pocket, z - start, y), wall)
            holes += [(inner, wall), (-wall, -inner)]
        elif _reaches(pocket, z, start, stop):
            holes.append(_pocket(pocket, y))
    return holes


def _reaches(pocket: CylinderPocket | BoxPocket, z: float, start: float, stop: float) -> bool:
    if pocket.face == "through" or pocket.depth_mm is None:
        return True
    return (z - start if pocket.face == "journal" else stop - z) < pocket.depth_mm


def _pocket(pocket: CylinderPocket | BoxPocket, y: Array) -> tuple[Array, Array]:
    if pocket.shape == "cylinder":
        return _disc(y, pocket.x_mm, pocket.y_mm, pocket.diameter_mm / 2)
    half = np.where(np.abs(y - pocket.y_mm) < pocket.size_y_mm / 2, pocket.size_x_mm / 2, 0.0)
    return pocket.x_mm - half, pocket.x_mm + half


def _disc(y: Array, x0: float, y0: float, radius: float) -> tuple[Array, Array]:
    half = np.sqrt(np.maximum(radius**2 - (y - y0) ** 2, 0.0))
    return x0 - half, x0 + half


def _solid_intervals(edge: Array, holes: list[tuple[Array, Array]]) -> tuple[Array, Array]:
    """Ends of what is left of -edge .. edge between the holes, (holes + 1, strips) each."""
    starts = np.clip(np.array([left for left, _ in holes]), -edge, edge)
    stops = np.clip(np.array([right for _, right in holes]), -edge, edge)
    order = starts.argsort(axis=0)
    starts, stops = np.take_along_axis(starts, order, 0), np.take_along_axis(stops, order, 0)
    left = np.maximum.accumulate(np.vstack([-edge[None], stops]), axis=0)
    right = np.maximum(np.vstack([starts, edge[None]]), left)
    return left, right
