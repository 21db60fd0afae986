"""An outline with the draft that its die needs: straight lines where it would be steeper.

The die opens across the throw. Seen along the crank, no half-width may fall faster than by the cotangent of
the draft; the least outline around another that keeps this follows it, and lines of that slope from where
they touch it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.root import root

_HalfWidth = Callable[[Array], Array]
_Corner = tuple[float, float]
_SAMPLES = 4001
_PLACE_MM = 1e-12
_TOLERANCE, _INWARD = 1e-7, 1e-9
"""Of half-widths over the outline's length; distance of a sample inward of the ends over it."""


@dataclass(frozen=True)
class DraftedOutline:
    """Half-widths of an outline, in each filler those of straight lines between corners (y, half-width)."""

    own: _HalfWidth
    own_range_mm: tuple[float, float]
    fillers: tuple[tuple[_Corner, ...], ...]

    def half_width_mm(self, y_mm: Array) -> Array:
        """Half of its width at places along the throw; 0 beyond its ends."""
        low, high = self.own_range_mm
        half = np.where((y_mm >= low) & (y_mm <= high), self.own(y_mm), 0.0)
        for corners in self.fillers:
            y, widths = zip(*corners, strict=True)
            half = np.where((y_mm >= y[0]) & (y_mm <= y[-1]), np.interp(y_mm, y, widths), half)
        return np.asarray(half)

    @property
    def y_range_mm(self) -> tuple[float, float]:
        """Its extent along the throw."""
        ends = [*self.own_range_mm, *(y for corners in self.fillers for y, _ in corners)]
        return min(ends), max(ends)

    @property
    def corners_mm(self) -> tuple[float, ...]:
        """Places along the throw of its corners."""
        return tuple(y for corners in self.fillers for y, _ in corners)


def drafted_outline(
    own: _HalfWidth, range_mm: tuple[float, float], draft_tangent: float, land_mm: float
) -> DraftedOutline:
    """Return an outline with draft.

    Args:
        own: half-widths at places along the throw, of an outline without jumps between its ends.
        draft_tangent: tangent of the draft.
        land_mm: half-width below which there is none: the land of the flash.
    """
    search = _Search(own, range_mm, 1 / draft_tangent, land_mm)
    return DraftedOutline(own, range_mm, tuple(search.fillers()))


class _Search:
    """Lines that fall and rise by `slope` from where they touch an outline, above its own half-widths."""

    def __init__(self, own: _HalfWidth, range_mm: tuple[float, float], slope: float, land_mm: float) -> None:
        (low, high), self.slope, self.land_mm = range_mm, slope, land_mm
        self.ends, self._inward = (low, high), _INWARD * (high - low)
        self._own = own
        inside = (low + high) / 2 - (high - low) / 2 * np.cos(np.linspace(0, np.pi, _SAMPLES))
        self.y = np.concatenate([[low - self._inward], inside, [high + self._inward]])
        bare = np.where((self.y >= low) & (self.y <= high), self.width(self.y), -land_mm - slope)
        widths = np.where(bare < 0, bare, np.maximum(bare, land_mm))
        self.falling = np.maximum.accumulate(widths + slope * self.y) - slope * self.y
        self.rising = np.maximum.accumulate((widths - slope * self.y)[::-1])[::-1] + slope * self.y
        self.least = bare + _TOLERANCE * (high - low)
        self.open = np.maximum(self.falling, self.rising) > self.least

    def width(self, y_mm: Array) -> Array:
        """Own half-widths, at the ends those just inside."""
        low, high = self.ends
        return self._own(np.clip(y_mm, low + self._inward, high - self._inward))

    def fillers(self) -> list[tuple[_Corner, ...]]:
        """Return the corners of each filler."""
        edges = np.flatnonzero(np.diff(np.concatenate([[False], self.open, [False]])))
        found = (self._distinct(self._corners(int(a) - 1, int(b))) for a, b in edges.reshape(-1, 2))
        return [corners for corners in found if len(corners) > 1]

    def _distinct(self, corners: tuple[_Corner, ...]) -> tuple[_Corner, ...]:
        """Return corners without those that are where the one before is, or hardly beyond an end."""
        apart = (after[0] - before[0] > 10 * self._inward for before, after in pairwise(corners))
        return (corners[0], *(corner for corner, new in zip(corners[1:], apart, strict=True) if new))

    def _corners(self, before: int, after: int) -> tuple[_Corner, ...]:
        """Return the corners between the last sample before and the first after a filler; -1, n for none."""
        last = len(self.y)
        falling_line = (
            self._touch(before, 1)
            if before >= 0 and self.falling[before + 1] > self.least[before + 1]
            else None
        )
        rising_line = (
            self._touch(after, -1)
            if after < last and self.rising[after - 1] > self.least[after - 1]
            else None
        )
        if falling_line and rising_line:
            return _valley(falling_line, rising_line, self.slope, self.land_mm)
        if falling_line:
            return self._line(falling_line, 1, after, after == last)
        if rising_line:
            return tuple(reversed(self._line(rising_line, -1, before, before < 0)))
        return self._flat(before, after)

    def _touch(self, sample: int, way: int) -> _Corner:
        """Return where a line that falls onward, the way along the throw, leaves the outline."""
        from scipy.optimize import minimize_scalar

        y = self.y[np.clip([sample - way, sample + way], 0, len(self.y) - 1)]
        bounds = float(y.min()), float(y.max())

        def below(place: float) -> float:
            return -max(float(self.width(np.array(place))), self.land_mm) - way * self.slope * place

        found = minimize_scalar(below, bounds=bounds, method="bounded", options={"xatol": 1e-10})
        place = float(np.clip(min((*bounds, float(found.x)), key=below), *self.ends))
        return place, max(float(self.width(np.array(place))), self.land_mm)

    def _line(self, touch: _Corner, way: int, sample: int, end: bool) -> tuple[_Corner, ...]:
        """Return the line from where it touches to the outline again, or beyond its end to the land."""
        (y, width), slope = touch, way * self.slope
        landed = y + (width - self.land_mm) / slope
        if not end:
            return touch, self._crossing(touch, slope, sample, way)
        limit = self.ends[way > 0]
        flat = ((limit, self.land_mm),) if way * (limit - landed) > self._inward else ()
        return touch, (landed, self.land_mm), *flat

    def _crossing(self, touch: _Corner, slope: float, sample: int, way: int) -> _Corner:
        def gap(place: float) -> float:
            return touch[1] - slope * (place - touch[0]) - float(self.width(np.array(place)))

        open_, closed = float(self.y[sample - way]), float(self.y[sample])
        place = closed if gap(closed) >= 0 else root(gap, open_, closed, _PLACE_MM)
        return place, float(self.width(np.array(place)))

    def _flat(self, before: int, after: int) -> tuple[_Corner, ...]:
        """Return the land alone, where the outline ends narrower than it."""

        def gap(place: float) -> float:
            return float(self.width(np.array(place))) - self.land_mm

        start, end = self.ends
        if before >= 0:
            start = root(gap, self.y[before], self.y[before + 1], _PLACE_MM)
        if after < len(self.y):
            end = root(gap, self.y[after - 1], self.y[after], _PLACE_MM)
        return (start, self.land_mm), (end, self.land_mm)


def _valley(falling_line: _Corner, rising_line: _Corner, slope: float, land_mm: float) -> tuple[_Corner, ...]:
    """Return two lines that meet, or end in the land between them."""
    (a, wide), (b, other) = falling_line, rising_line
    middle = (a + b) / 2 + (wide - other) / (2 * slope)
    lowest = wide - slope * (middle - a)
    if lowest >= land_mm:
        return falling_line, (middle, lowest), rising_line
    return (
        falling_line,
        (a + (wide - land_mm) / slope, land_mm),
        (b - (other - land_mm) / slope, land_mm),
        rising_line,
    )
