"""The circle that touches a counterweight's flank and the outline of its web from outside.

The outline is a half-width over the place along the throw, whatever its kind. A point's distance from it is
the least over all places; the circle rolls in along the flank until that distance is its radius. For convex
outlines it is the only one, and Newton's steps from outside come down to it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError

_HalfWidth = Callable[[Array], Array]
_SAMPLES, _POINTS, _ROUNDS = 801, 65, 7
"""Places at which the search for the nearest begins; places in an interval, and how often it is narrowed."""
_STEP_MM = 1e-4
"""Half the step of the difference whose sign tells on which side of a place the nearest lies."""
_NEWTON, _SETTLED_MM, _LEAST_RISE = 60, 1e-11, 0.05
_TOUCHES_MM = 1e-6
_BISECTIONS = 60


@dataclass(frozen=True)
class TangentCircle:
    """A circle at x > 0 that touches flank and outline at two places (x, y), mm, and its mirror image."""

    centre: tuple[float, float]
    radius_mm: float
    on_flank: tuple[float, float]
    on_outline: tuple[float, float]

    @property
    def reach_mm(self) -> float:
        """Distance of the place on the flank from the crank axis."""
        return math.hypot(*self.on_flank)

    def off_mm(self, x_mm: Array, y_mm: Array) -> Array:
        """Distance of points on either side from the circle, positive outside it."""
        return np.asarray(np.hypot(*self._from_centre(x_mm, y_mm)) - self.radius_mm)

    def outward(self, x_mm: Array, y_mm: Array) -> tuple[Array, Array]:
        """Direction from the centre to points mirrored to x >= 0."""
        x, y = self._from_centre(x_mm, y_mm)
        away = np.maximum(np.hypot(x, y), 1e-12)
        return x / away, y / away

    def behind(self, x_mm: Array, y_mm: Array) -> NDArray[np.bool_]:
        """Tell whether points are seen from the centre between both places where it touches."""
        x, y = self._from_centre(x_mm, y_mm)
        (x1, y1), (x2, y2) = ((a - self.centre[0], b - self.centre[1]) for a, b in self.ends)
        return np.asarray((x1 * y - y1 * x <= 0) & (x * y2 - y * x2 <= 0))

    @property
    def ends(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Places at which it touches the flank and the outline."""
        return self.on_flank, self.on_outline

    def arc_mm(self, points: int) -> tuple[Array, Array]:
        """Points of the arc between flank and outline."""
        (x, y), r = self.centre, self.radius_mm
        first, last = (math.atan2(b - y, a - x) % (2 * math.pi) for a, b in self.ends)
        turn = np.linspace(first, last, points)
        return x + r * np.cos(turn), y + r * np.sin(turn)

    def _from_centre(self, x_mm: Array, y_mm: Array) -> tuple[Array, Array]:
        return np.abs(x_mm) - self.centre[0], y_mm - self.centre[1]


class OutlineSection:
    """An outline as the set of points between minus and plus its half-width."""

    def __init__(self, half_width_mm: _HalfWidth, y_range_mm: tuple[float, float]) -> None:
        self._half_width_mm, (self._low, self._high) = half_width_mm, y_range_mm
        middle, half = (self._low + self._high) / 2, (self._high - self._low) / 2
        self._y = middle - half * np.cos(np.linspace(0.0, np.pi, _SAMPLES))
        self._half = half_width_mm(self._y)

    @property
    def reach_mm(self) -> float:
        """Largest distance from the crank axis."""
        return float(np.hypot(self._half, self._y).max())

    def nearest(self, x_mm: float, y_mm: float) -> tuple[float, float]:
        """Point of the outline, or inside, nearest to a point at x >= 0."""
        k = int(_square(x_mm - self._half, y_mm - self._y).argmin())
        low, high = self._y[max(k - 1, 0)], self._y[min(k + 1, _SAMPLES - 1)]
        for _ in range(_ROUNDS):
            y = np.linspace(low, high, _POINTS)
            above, below = (self._squares(x_mm, y_mm, y + step) for step in (_STEP_MM, -_STEP_MM))
            first = int(np.argmax(np.append(above >= below, True)))
            low, high = y[max(first - 1, 0)], y[min(first, _POINTS - 1)]
        found = np.array([(low + high) / 2 if low > self._low else self._low])
        return min(x_mm, float(self._half_width_mm(found)[0])), float(found[0])

    def _squares(self, x_mm: float, y_mm: float, y: Array) -> Array:
        """Squared distances of a point from the outline at places, which end with the outline."""
        y = np.clip(y, self._low, self._high)
        return _square(x_mm - self._half_width_mm(y), y_mm - y)


def tangent_circle(outline: OutlineSection, half_angle: float, radius_mm: float) -> TangentCircle:
    """Return the circle at a flank without end, at an angle (rad) from the line away from the crankpin."""
    along, across = flank_directions(half_angle)
    reach = outline.reach_mm + 2 * radius_mm
    for _ in range(_NEWTON):
        centre = reach * along + radius_mm * across
        at = np.array(outline.nearest(*centre.tolist()))
        away = float(np.hypot(*(centre - at)))
        if abs(away - radius_mm) < _SETTLED_MM:
            break
        rise = float((centre - at) @ along) / max(away, _SETTLED_MM)
        reach -= (away - radius_mm) / max(rise, _LEAST_RISE)
    if abs(away - radius_mm) > _TOUCHES_MM:
        raise CranktopoError(
            f"web.counterweight.fillet_mm {radius_mm:g}: no circle was found that touches flank and outline.",
            hint="Change it, or half_angle_deg of the counterweight, slightly.",
        )
    touches = reach * along
    pairs = ((float(x), float(y)) for x, y in (centre, touches, at))
    middle, on_flank, on_outline = pairs
    return TangentCircle(middle, radius_mm, on_flank, on_outline)


def largest_radius_mm(outline: OutlineSection, half_angle: float, end_mm: float) -> float:
    """Return the radius of the circle that touches a flank at its end; 0 where that is inside the outline."""
    along, across = flank_directions(half_angle)

    def fits(radius_mm: float) -> bool:
        centre = end_mm * along + radius_mm * across
        return bool(np.hypot(*(centre - outline.nearest(*centre.tolist()))) > radius_mm)

    low, high = 0.0, 8 * (end_mm + outline.reach_mm)
    for _ in range(_BISECTIONS):
        middle = (low + high) / 2
        low, high = (middle, high) if fits(middle) else (low, middle)
    return low


def flank_directions(half_angle: float) -> tuple[Array, Array]:
    """Unit vectors along the flank at x > 0, outward, and across it, out of the counterweight."""
    sine, cosine = math.sin(half_angle), math.cos(half_angle)
    return np.array([sine, -cosine]), np.array([cosine, sine])


def _square(x: Array, y: Array) -> Array:
    return np.asarray(np.maximum(x, 0.0) ** 2 + y**2)
