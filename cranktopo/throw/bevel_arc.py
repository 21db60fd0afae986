"""The arc of an end bevel, in the plane of the crank axis and the throw."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array

_FLAT_MM = 1e-6
_LEAST_ROOT = 1e-6
_LEAST_SINE, _LEAST_COSINE = 1e-4, 0.5
"""Of angles that only an arc that turns back goes beyond."""


@dataclass(frozen=True)
class BevelArc:
    """Arc of a bevel from its face to the end of the outline; circle through both ends with a given crown.

    Depth counts from the bevel's face into the web, reach from the crank axis outward along the throw:
    `outward` is +1 for the crankpin's end (reach = y) and -1 for the main journal's (reach = -y). With a
    draft it is the section x = 0: aside of it the same arc, continued along its tangents, lies deeper in the
    web, moved at right angles to its chord.

    Attributes:
        start_mm: reach where it meets its face.
        end_mm: reach of the outline's end.
        depth_mm: depth there.
        crown_mm: rise over the chord, away from the web; negative where the arc is hollow.
        outward: sign of the throw direction.
        draft_deg: least angle of its surface to the direction across the web.
    """

    start_mm: Any
    end_mm: Any
    depth_mm: Any
    crown_mm: Any
    outward: float
    draft_deg: float = 0.0

    def depth_at_mm(self, reach_mm: Array, aside_mm: Any = 0.0) -> Array:
        """Depth that is taken off at a reach, so far from x = 0; 0 before the start.

        Beyond the end it is the full depth, with a draft that of the tangent.
        """
        if not self.draft_deg:
            return self._section_depth_mm(reach_mm)
        fallen, (first, last) = self.drop * aside_mm / self.chord_mm, self._end_slopes
        reach = reach_mm + fallen * self.depth_mm
        beyond = np.minimum(reach - self.start_mm, 0.0) * first + np.maximum(reach - self.end_mm, 0.0) * last
        deeper = fallen * (self.end_mm - self.start_mm)
        return np.asarray(np.maximum(self._section_depth_mm(reach) + beyond + deeper, 0.0))

    def _section_depth_mm(self, reach_mm: Array) -> Array:
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

    def between_mm(self, pieces: int) -> list[tuple[float, float]]:
        """Depths and reaches of the points that part the arc into pieces of the same length."""
        depth, reach = self.centre_mm
        start = complex(self.start_mm - reach, -depth)
        turn = cmath.phase(complex(self.end_mm - reach, self.depth_mm - depth) / start)
        points = (start * cmath.rect(1.0, turn * k / pieces) for k in range(1, pieces))
        return [(depth + point.imag, reach + point.real) for point in points]

    @property
    def largest_crown_mm(self) -> float:
        """Crown, of either sign, at which the arc would turn back at one of its ends."""
        slope = math.atan2(self.end_mm - self.start_mm, self.depth_mm)
        return self.chord_mm / 2 * math.tan(min(slope, math.pi / 2 - slope) / 2)

    @property
    def drop(self) -> Any:
        """Depth that the arc gains at right angles to its chord, per mm from x = 0.

        At both ends, where the arc leaves its chord's direction most, the surface has the draft, else more.
        """
        chord, bow = (self.end_mm - self.start_mm) ** 2 + self.depth_mm**2, 4 * self.crown_mm**2
        turn = np.maximum((chord - bow) / (chord + bow), _LEAST_COSINE)
        return math.tan(math.radians(self.draft_deg)) / turn

    @property
    def inward(self) -> Any:
        """Distance of its edge on the face inward of the start, per mm from x = 0."""
        start, _ = self.end_angles
        return math.tan(math.radians(self.draft_deg)) / np.maximum(np.sin(start), _LEAST_SINE)

    @property
    def _end_slopes(self) -> tuple[Any, Any]:
        """Depth per mm of reach at both ends."""
        start, end = self.end_angles
        return np.tan(start), np.tan(end)

    @property
    def end_angles(self) -> tuple[Any, Any]:
        """Angles between the arc and its face at both ends, rad."""
        rise, run = self.end_mm - self.start_mm, self.depth_mm
        chord, turn = np.arctan2(run, rise), 2 * np.arctan(2 * self.crown_mm / np.hypot(rise, run))
        return chord - turn, chord + turn

    @property
    def _normal(self) -> tuple[float, float]:
        return -(self.end_mm - self.start_mm) / self.chord_mm, self.depth_mm / self.chord_mm

    def distance_mm(self, depth_mm: Any, reach_mm: Any, aside_mm: Any = 0.0) -> Any:
        """Signed distance of points, broadcastable, positive in the web; beyond its ends the chord's.

        With a draft it is the distance so far from x = 0, beyond its ends the tangents'.
        """
        above, root = self._above_mm(depth_mm, reach_mm)
        if not self.draft_deg:
            return -above * root
        slope = self.drop
        return -(above + slope * aside_mm) * root / np.sqrt(1 + (slope * root) ** 2)

    def from_mm(self, depth_mm: Any, reach_mm: Any) -> Any:
        """Distance from x = 0 at which its surface is at a depth and reach; 0 where it takes off all."""
        return np.maximum(-self._above_mm(depth_mm, reach_mm)[0] / self.drop, 0.0)

    def _above_mm(self, depth_mm: Any, reach_mm: Any) -> tuple[Any, Any]:
        """Height of points over the arc, away from the web along its chord's normal; cosine of its turn."""
        rise, run = self.end_mm - self.start_mm, self.depth_mm
        length = np.sqrt(rise**2 + run**2)
        bend = 2 * self.crown_mm / (length**2 / 4 + self.crown_mm**2)
        d, v = depth_mm - run / 2, reach_mm - (self.start_mm + self.end_mm) / 2
        on_chord = (d * run + v * rise) / length
        along = np.clip(on_chord, -length / 2, length / 2)
        above = (v * run - d * rise) / length - self.crown_mm
        root = np.sqrt(np.maximum(1 - (bend * along) ** 2, _LEAST_ROOT))
        above = above + bend * along**2 / (1 + root)
        if self.draft_deg:
            above = above + np.abs(on_chord - along) * bend * np.abs(along) / root
        return above, root
