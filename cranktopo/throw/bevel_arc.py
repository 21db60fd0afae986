"""The arc of an end bevel, in the plane of the crank axis and the throw."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array

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
        crown_mm: rise over the chord, away from the web; negative where the arc is hollow.
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
        if abs(self.crown_mm) < _FLAT_MM:
            return np.asarray((reach - self.start_mm) / (self.end_mm - self.start_mm) * self.depth_mm)
        (depth, centre), radius = self.centre_mm, self.radius_mm
        root = np.sqrt(np.maximum(radius**2 - (reach - centre) ** 2, 0.0))
        return np.asarray(np.clip(depth - math.copysign(1.0, self.crown_mm) * root, 0.0, self.depth_mm))

    @property
    def title(self) -> str:
        """Name of its bevel in a sentence."""
        return "journal bevel" if self.outward > 0 else "pin bevel"

    @property
    def chord_mm(self) -> float:
        """Length of the chord."""
        return math.hypot(self.end_mm - self.start_mm, self.depth_mm)

    @property
    def radius_mm(self) -> float:
        """Radius of the arc, negative where it is hollow; infinite for a plane."""
        if abs(self.crown_mm) < _FLAT_MM:
            return math.inf
        return float((self.chord_mm**2 / 4 + self.crown_mm**2) / (2 * self.crown_mm))

    @property
    def centre_mm(self) -> tuple[float, float]:
        """Depth and reach of the arc's centre."""
        normal = self._normal
        back = self.crown_mm - self.radius_mm
        return (self.depth_mm / 2 + back * normal[0], (self.start_mm + self.end_mm) / 2 + back * normal[1])

    @property
    def largest_crown_mm(self) -> float:
        """Crown, of either sign, at which the arc would turn back at one of its ends."""
        slope = math.atan2(self.end_mm - self.start_mm, self.depth_mm)
        return self.chord_mm / 2 * math.tan(min(slope, math.pi / 2 - slope) / 2)

    @property
    def _normal(self) -> tuple[float, float]:
        return -(self.end_mm - self.start_mm) / self.chord_mm, self.depth_mm / self.chord_mm

    def distance_mm(self, depth_mm: Any, reach_mm: Any) -> Any:
        """Signed distance of points, broadcastable, positive in the web; beyond its ends the chord's."""
        rise, run = self.end_mm - self.start_mm, self.depth_mm
        length = np.sqrt(rise**2 + run**2)
        bend = 2 * self.crown_mm / (length**2 / 4 + self.crown_mm**2)
        d, v = depth_mm - run / 2, reach_mm - (self.start_mm + self.end_mm) / 2
        along = np.clip((d * run + v * rise) / length, -length / 2, length / 2)
        above = (v * run - d * rise) / length - self.crown_mm
        root = np.sqrt(np.maximum(1 - (bend * along) ** 2, _LEAST_ROOT))
        return -(above + bend * along**2 / (1 + root)) * root
