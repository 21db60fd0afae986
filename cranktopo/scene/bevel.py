"""End bevels of the web: arcs in the plane of the crank axis and the throw, straight across the web."""

from __future__ import annotations

import math
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.scene.geometry import EndBevel, Web
from cranktopo.scene.outline import y_range_mm

Array = NDArray[np.float64]
_FLAT_MM = 1e-6
_LEAST_ROOT = 1e-6


@dataclass(frozen=True)
class BevelArc:
    """Arc of a bevel from its face to the end of the outline; circle through both ends with a given crown.

    Depth counts from the bevel's face into the web, reach from the crank axis outward along the throw:
    `outward` is +1 for the crankpin's end (reach = y) and -1 for the main journal's (reach = -y).

    Attributes:
        start_mm: reach where it meets its face.
        end_mm: reach of the outline's end.
        depth_mm: depth there.
        crown_mm: rise over the chord, away from the web.
        outward: sign of the throw direction.
    """

    start_mm: Any
    end_mm: Any
    depth_mm: Any
    crown_mm: Any
    outward: float

    def depth_at_mm(self, reach_mm: Array) -> Array:
        """Depth that is taken off at a reach; 0 before the start, the full depth beyond the end."""
        reach = np.clip(reach_mm, self.start_mm, self.end_mm)
        if self.crown_mm < _FLAT_MM:
            return np.asarray((reach - self.start_mm) / (self.end_mm - self.start_mm) * self.depth_mm)
        (depth, centre), radius = self.centre_mm, self.radius_mm
        root = np.sqrt(np.maximum(radius**2 - (reach - centre) ** 2, 0.0))
        return np.asarray(np.clip(depth - root, 0.0, self.depth_mm))

    def reach_at_mm(self, depth_mm: float) -> float:
        """Reach up to which the web goes at a depth; infinite below the bevel."""
        if depth_mm >= self.depth_mm:
            return math.inf
        if self.crown_mm < _FLAT_MM:
            return float(self.start_mm + depth_mm / self.depth_mm * (self.end_mm - self.start_mm))
        (depth, centre), radius = self.centre_mm, self.radius_mm
        return float(centre + math.sqrt(radius**2 - (depth_mm - depth) ** 2))

    @property
    def chord_mm(self) -> float:
        """Length of the chord."""
        return math.hypot(self.end_mm - self.start_mm, self.depth_mm)

    @property
    def radius_mm(self) -> float:
        """Radius of the arc; infinite for a plane."""
        if self.crown_mm < _FLAT_MM:
            return math.inf
        return (self.chord_mm**2 / 4 + self.crown_mm**2) / (2 * self.crown_mm)

    @property
    def centre_mm(self) -> tuple[float, float]:
        """Depth and reach of the arc's centre."""
        normal = self._normal
        back = self.crown_mm - self.radius_mm
        return (
            self.depth_mm / 2 + back * normal[0],
            (self.start_mm + self.end_mm) / 2 + back * normal[1],
        )

    @property
    def largest_crown_mm(self) -> float:
        """Crown at which the arc would turn back at one of its ends."""
        slope = math.atan2(self.end_mm - self.start_mm, self.depth_mm)
        return self.chord_mm / 2 * math.tan(min(slope, math.pi / 2 - slope) / 2)

    @property
    def _normal(self) -> tuple[float, float]:
        return -(self.end_mm - self.start_mm) / self.chord_mm, self.depth_mm / self.chord_mm

    def distance_mm(self, xp: ModuleType, depth_mm: Any, reach_mm: Any) -> Any:
        """Signed distance, positive on the web's side; beyond both ends that of the chord.

        Args:
            xp: numpy or jax.numpy.
            depth_mm, reach_mm: points, broadcastable.
        """
        rise, run = self.end_mm - self.start_mm, self.depth_mm
        length = xp.sqrt(rise**2 + run**2)
        bend = 2 * self.crown_mm / (length**2 / 4 + self.crown_mm**2)
        d, v = depth_mm - run / 2, reach_mm - (self.start_mm + self.end_mm) / 2
        along = xp.clip((d * run + v * rise) / length, -length / 2, length / 2)
        above = (v * run - d * rise) / length - self.crown_mm
        root = xp.sqrt(xp.maximum(1 - (bend * along) ** 2, _LEAST_ROOT))
        return -(above + bend * along**2 / (1 + root)) * root


def bevel_arc(web: Web, throw_radius_mm: float, bevel: EndBevel) -> BevelArc:
    """The arc of one of the web's bevels.

    Args:
        web: the bevelled web.
        throw_radius_mm: distance of the pin axis from the crank axis.
        bevel: one of its bevels.
    """
    low, high = y_range_mm(web, throw_radius_mm)
    if bevel.face == "journal":
        return BevelArc(bevel.y_mm, high, bevel.depth_mm, bevel.crown_mm, 1.0)
    return BevelArc(-bevel.y_mm, -low, bevel.depth_mm, bevel.crown_mm, -1.0)


def height_range_mm(web: Web, throw_radius_mm: float, y_mm: Array) -> tuple[Array, Array]:
    """Heights over the journal face between which the web lies at positions along the throw, mm.

    Args:
        web: the web.
        throw_radius_mm: distance of the pin axis from the crank axis.
        y_mm: positions along the throw, any shape.
    """
    low, high = np.zeros_like(y_mm), np.full_like(y_mm, web.thickness_mm)
    for bevel in web.bevel:
        arc = bevel_arc(web, throw_radius_mm, bevel)
        depth = arc.depth_at_mm(arc.outward * y_mm)
        if bevel.face == "journal":
            low = depth
        else:
            high = web.thickness_mm - depth
    return low, high


def throw_range_mm(web: Web, throw_radius_mm: float, height_mm: float) -> tuple[float, float]:
    """Range along the throw that the bevels leave at a height over the journal face, mm; may be infinite.

    Args:
        web: the web.
        throw_radius_mm: distance of the pin axis from the crank axis.
        height_mm: height over the journal face.
    """
    low, high = -math.inf, math.inf
    for bevel in web.bevel:
        arc = bevel_arc(web, throw_radius_mm, bevel)
        if bevel.face == "journal":
            high = arc.reach_at_mm(height_mm)
        else:
            low = -arc.reach_at_mm(web.thickness_mm - height_mm)
    return low, high


def bevel_cuts_mm(web: Web, sections: int) -> list[float]:
    """Heights over the journal face at which a bevelled web is cut into thin layers, mm.

    Args:
        web: the web.
        sections: number of layers per bevel.
    """
    cuts: list[float] = []
    for bevel in web.bevel:
        layers = np.linspace(0.0, bevel.depth_mm, sections + 1)
        cuts += list(layers if bevel.face == "journal" else web.thickness_mm - layers)
    return cuts
