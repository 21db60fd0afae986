"""The rounded edge between the floor of a pocket and its walls, which open by a draft."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array, Mask
from cranktopo.throw.feature import ThrowView

_TINY = 1e-12


def slope_of(draft_deg: float) -> float:
    """Return by how much a wall opens per mm of height."""
    return math.tan(math.radians(draft_deg))


@dataclass(frozen=True)
class FloorRounding:
    """An arc from the floor to the wall, which both touch; without a radius the edge is sharp.

    Heights are those over the floor. Growth is how far a section lies outside the foot, where the walls would
    meet the floor; where the edge is round it is negative.
    """

    radius_mm: float
    slope: float

    @property
    def foot_mm(self) -> float:
        """Distance inside the foot of the walls at which the arc leaves the floor."""
        return self.radius_mm * (math.hypot(1.0, self.slope) - self.slope)

    @property
    def top_mm(self) -> float:
        """Height at which the arc ends on the wall."""
        return self.radius_mm * (1.0 - self.slope / math.hypot(1.0, self.slope))

    @property
    def kinks_mm(self) -> tuple[float, ...]:
        """Growth at which the floor ends and the wall begins."""
        return (-self.foot_mm, self.slope * self.top_mm) if self.radius_mm else (0.0,)

    def growth_mm(self, height: Array) -> Array:
        """Return the growth of the section at heights."""
        growth = self.slope * height
        if not self.radius_mm:
            return np.asarray(growth)
        arc = np.sqrt(np.maximum(self.radius_mm**2 - (self.radius_mm - height) ** 2, 0.0)) - self.foot_mm
        return np.where(height < self.top_mm, arc, growth)

    def height_mm(self, growth: Array) -> Array:
        """Return the height at which the section has grown by so much; infinite where it never does."""
        wall = np.maximum(growth, 0.0) / self.slope if self.slope else np.full_like(growth, np.inf)
        if not self.radius_mm:
            return np.asarray(wall)
        along = np.clip(growth + self.foot_mm, 0.0, self.radius_mm)
        arc = self.radius_mm - np.sqrt(self.radius_mm**2 - along**2)
        return np.where(growth < self.slope * self.top_mm, arc, wall)

    def tube_mm(self, growth: Array, floor: Array) -> Array:
        """Signed distance from the tube of the arc, positive in the material; of the whole tube.

        Args:
            growth: that of a point's place, where the walls would have no draft.
            floor: distance of points below the floor, negative above it.
        """
        out, down = growth + self.foot_mm, floor + self.radius_mm
        return np.asarray(np.sqrt(out**2 + down**2 + _TINY) - self.radius_mm)

    def seams_mm(self, growth: Array, floor: Array) -> list[Array]:
        """Return distances from surfaces that cross the tube where it leaves floor and wall."""
        return [growth + self.foot_mm, floor + self.top_mm]

    def outside_mm(self, plain: Sequence[Array], growth: Array, floor: Array) -> Array:
        """Return the signed distance from a pocket with floor and walls as given, its edge rounded.

        The tube counts between its tangents on the floor and on the wall.
        """
        sharp = functools.reduce(np.maximum, plain)
        return np.where(self._holds(growth, floor), np.maximum(sharp, self.tube_mm(growth, floor)), sharp)

    def _holds(self, growth: Array, floor: Array) -> Mask:
        out, down = growth + self.foot_mm, floor + self.radius_mm
        return np.asarray((out > 0) & (down > self.slope * out))


def check_floor_radius(
    scene: ThrowView, key: str, rounding: FloorRounding, depth_mm: float, *sizes_mm: float
) -> None:
    """Refuse the `floor_radius_mm` of the pocket of a key that its depth and sizes do not hold."""
    if rounding.top_mm > depth_mm:
        allowed = f"rises {rounding.top_mm:.4g} mm over the floor, more than the depth of {depth_mm:g} mm"
        raise scene.invalid(f"{key}.floor_radius_mm", allowed)
    if sizes_mm and rounding.foot_mm > _FLATTEST * min(sizes_mm) / 2:
        raise scene.invalid(f"{key}.floor_radius_mm", "leaves no flat floor", "Widen the pocket.")


def check_floor_corners(scene: ThrowView, key: str, rounding: FloorRounding, corner_mm: float) -> None:
    """Refuse corners of the floor that are sharper than the rounding of its edge needs."""
    if corner_mm < rounding.foot_mm:
        allowed = f"needs a corner_radius_mm of at least {rounding.foot_mm:.4g} mm"
        raise scene.invalid(f"{key}.floor_radius_mm", allowed)


_FLATTEST = 0.99
"""Most of half a floor that the rounding of its edge may take: the CAD kernel makes no line of it."""
