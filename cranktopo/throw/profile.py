"""The profile outline: half-widths at stations along the throw, joined by one smooth curve, its flank.

The flank is a cubic spline of x and y over the chord length between its points, with continuous curvature.
An end with half-width 0 is round: the curve crosses x = 0 at a right angle, with the curvature of its own
mirror image. An end with a half-width above 0 is cut straight across. The formulae are analytic, so that a
complex step differentiates them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from typing_extensions import override

from cranktopo.base.arrays import Array, shared
from cranktopo.base.errors import invalid
from cranktopo.base.table import LengthOrZero, Place
from cranktopo.throw.primitives import Bezier, Curve, LineSegment
from cranktopo.throw.web import WebTable

_BISECTIONS = 52


@dataclass(frozen=True)
class Flank:
    """The right flank of a profile: cubic pieces between points (n, 2) of increasing y, mm.

    Each piece has its chord's length as parameter range; `slopes` (n, 2) are the derivatives by it.
    """

    points_mm: Any
    lengths_mm: Any
    slopes: Any

    def at(self, u: Any) -> Any:
        """Points of every piece at places (u,) from 0 to 1 in each, (pieces, u, 2), mm."""
        return _blended(self._pieces(), np.asarray(u)[None, :, None])

    def along(self, chords: int) -> Any:
        """Points at equal steps of the piece number, both ends included, (chords + 1, 2), mm."""
        pieces = self.points_mm.shape[0] - 1
        place = np.linspace(0, pieces, chords + 1)
        piece = np.minimum(place.astype(int), pieces - 1)
        return _blended([part[piece, 0] for part in self._pieces()], np.asarray(place - piece)[:, None])

    def derivatives(self, u: Any) -> tuple[Any, Any]:
        """First and second derivative at places (u,) in each piece, (pieces, u, 2) each, - and 1/mm."""
        start, end, leave, arrive = self._pieces()
        t, length = np.asarray(u)[None, :, None], self.lengths_mm[:, None, None]
        first = 6 * t * (1 - t) * (end - start) + leave * (1 - t) * (1 - 3 * t) + arrive * t * (3 * t - 2)
        second = (6 - 12 * t) * (end - start) + leave * (6 * t - 4) + arrive * (6 * t - 2)
        return first / length, second / length**2

    def curvature_per_mm(self, u: Any) -> Any:
        """Signed curvature at places in each piece, (pieces, u), 1/mm; positive where the web is convex."""
        first, second = self.derivatives(u)
        cross = first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
        return cross / (first**2).sum(axis=-1) ** 1.5

    def _pieces(self) -> tuple[Any, Any, Any, Any]:
        length = self.lengths_mm[:, None, None]
        return (
            self.points_mm[:-1, None],
            self.points_mm[1:, None],
            self.slopes[:-1, None] * length,
            self.slopes[1:, None] * length,
        )


def _blended(ends: Sequence[Any], t: Any) -> Any:
    start, end, leave, arrive = ends
    return (
        start * (1 + 2 * t) * (1 - t) ** 2
        + end * t**2 * (3 - 2 * t)
        + leave * t * (1 - t) ** 2
        + arrive * t**2 * (t - 1)
    )


def flank_through(half_widths_mm: Any, stations_mm: Any, round_ends: tuple[bool, bool]) -> Flank:
    """Return the flank through half-widths at stations, (n,) each, mm; a round end crosses x = 0 smoothly."""
    points = np.stack([half_widths_mm, stations_mm], axis=1)
    lengths = np.sqrt(((points[1:] - points[:-1]) ** 2).sum(axis=1))
    free = _slopes(lengths, points, (False, False))
    held = _slopes(lengths, points, round_ends)
    # In a mirror x is odd, so its second derivative vanishes, and y is even, so its first one does.
    return Flank(points, lengths, np.stack([free[:, 0], held[:, 1]], axis=1))


def _slopes(lengths: Any, points: Any, clamped: tuple[bool, bool]) -> Any:
    """Derivatives at the points of the C2 spline; an end has derivative 0 (clamped) or no curvature."""
    one, zero = np.ones(1), np.zeros(1)
    inverse = 1 / lengths
    middle = 2 * (inverse[:-1] + inverse[1:])
    diagonal = np.concatenate([one if clamped[0] else 2 * one, middle, one if clamped[1] else 2 * one])
    upper = np.concatenate([zero if clamped[0] else one, inverse[1:]])
    lower = np.concatenate([inverse[:-1], zero if clamped[1] else one])
    chords = (points[1:] - points[:-1]) * inverse[:, None]
    inner = 3 * (chords[:-1] * inverse[:-1, None] + chords[1:] * inverse[1:, None])
    first = 0.0 if clamped[0] else 3.0
    last = 0.0 if clamped[1] else 3.0
    right = np.concatenate([first * chords[:1], inner, last * chords[-1:]])
    matrix = np.diag(diagonal) + np.diag(upper, 1) + np.diag(lower, -1)
    return np.linalg.solve(matrix, right)


def flank_half_width_mm(flank: Flank, y_mm: Array) -> Array:
    """Return the half-width of a right flank at positions along the throw, mm; 0 beyond the ends."""
    stations = flank.points_mm[:, 1]
    inside = (y_mm >= stations[0]) & (y_mm <= stations[-1])
    # Cells ask at the same places for every height, and a drag that moves no station at those of before.
    y, back = np.unique(np.clip(y_mm, stations[0], stations[-1]), return_inverse=True)
    key = tuple(np.ascontiguousarray(one).tobytes() for one in (flank.points_mm, flank.slopes, y))
    half = _half_widths(*key)[back].reshape(y_mm.shape)
    return np.asarray(np.where(inside, np.maximum(half, 0.0), 0.0))


@lru_cache(maxsize=128)
def _half_widths(points: bytes, slopes: bytes, places: bytes) -> Array:
    """Return the half-widths at places along the throw of the flank through points with slopes."""
    at, ways = (np.frombuffer(one).reshape(-1, 2) for one in (points, slopes))
    flank, y = Flank(at, np.sqrt((np.diff(at, axis=0) ** 2).sum(axis=1)), ways), np.frombuffer(places)
    piece = np.clip(np.searchsorted(at[:, 1], y, side="right") - 1, 0, len(at) - 2)
    start, first, second, third = _cubic(flank, piece, 1)
    low, step = np.zeros_like(y), 1.0
    for _ in range(_BISECTIONS):
        step /= 2
        middle = low + step
        below = start + middle * (first + middle * (second + middle * third)) < y
        low = np.where(below, middle, low)
    return shared(_hermite(flank, piece, low + step / 2, 0))


def largest_half_width_mm(flank: Flank) -> float:
    """Largest half-width of the curve, mm: it may lie between two stations."""
    pieces = np.arange(len(flank.lengths_mm))
    _, first, second, third = _cubic(flank, pieces, 0)
    with np.errstate(divide="ignore", invalid="ignore"):  # pieces that do not turn
        far = -(second + np.copysign(np.sqrt(second**2 - 3 * third * first), second))
        turning = np.array([far / (3 * third), first / far])
    turning = np.where((turning > 0) & (turning < 1), turning, 0.0)
    return float(max(flank.points_mm[:, 0].max(), *(_hermite(flank, pieces, u, 0).max() for u in turning)))


def _hermite(flank: Flank, piece: NDArray[np.int64], u: Array, axis: int) -> Array:
    start, first, second, third = _cubic(flank, piece, axis)
    return np.asarray(start + u * (first + u * (second + u * third)))


def _cubic(flank: Flank, piece: NDArray[np.int64], axis: int) -> tuple[Array, Array, Array, Array]:
    """Coefficients of one coordinate of chosen pieces by powers of u, the constant first."""
    points, slopes = flank.points_mm[:, axis], flank.slopes[:, axis]
    length = flank.lengths_mm[piece]
    start, chord = points[piece], points[piece + 1] - points[piece]
    leave, arrive = slopes[piece] * length, slopes[piece + 1] * length
    return start, leave, 3 * chord - 2 * leave - arrive, leave + arrive - 2 * chord


class ProfileWeb(WebTable):
    """Half-widths at stations along the throw, joined by a curve of continuous curvature.

    A half-width of 0 at an end closes the outline with a round end.
    """

    outline: Literal["profile"]
    stations_mm: tuple[Place, ...] = Field(
        min_length=3, examples=[(-24.0, -15.0, 5.0, 24.0, 45.0, 64.0, 72.0)]
    )
    """Places along the throw from the crank axis, increasing."""
    half_widths_mm: tuple[LengthOrZero, ...] = Field(
        min_length=3, examples=[(0.0, 19.0, 31.0, 34.0, 30.0, 19.0, 0.0)]
    )
    """Half-width at each station; 0 at an end makes that end round."""

    @property
    def round_ends(self) -> tuple[bool, bool]:
        """True if the lower and the upper end are round and not cut straight across."""
        return self.half_widths_mm[0] == 0, self.half_widths_mm[-1] == 0

    @property
    def flank(self) -> Flank:
        """Its right flank."""
        return _flank(self)

    @override
    def half_width_mm(self, throw_radius_mm: float, y_mm: Array) -> Array:
        return flank_half_width_mm(self.flank, y_mm)

    @override
    def y_range_mm(self, throw_radius_mm: float) -> tuple[float, float]:
        return self.stations_mm[0], self.stations_mm[-1]

    @property
    @override
    def largest_half_width_mm(self) -> float:
        return largest_half_width_mm(self.flank)

    @override
    def kinks_mm(self, throw_radius_mm: float) -> tuple[float, ...]:
        return self.stations_mm

    def contour(self, throw_radius_mm: float, z_mm: float) -> tuple[Curve, ...]:
        """Right flank, end, left flank, end; a flank is one Bezier cubic per station, exactly the spline.

        One B-spline over all stations would be shorter, but the CAD kernel loses 0.3 % of the volume of such
        a face.
        """
        y, half = self.stations_mm, self.half_widths_mm
        top = [(half[-1], y[-1]), (0.0, y[-1]), (-half[-1], y[-1])]
        bottom = [(-half[0], y[0]), (0.0, y[0]), (half[0], y[0])]
        over, under = (
            [LineSegment((*a, z_mm), (*b, z_mm)) for a, b in pairwise(end) if a != b] for end in (top, bottom)
        )
        return (*self._beziers(1.0, z_mm), *over, *self._beziers(-1.0, z_mm)[::-1], *under)

    def _beziers(self, side: float, z: float) -> list[Curve]:
        flank = self.flank
        curves: list[Curve] = []
        for i, length in enumerate(flank.lengths_mm):
            (x0, y0), (x1, y1) = flank.points_mm[i : i + 2].tolist()
            (dx0, dy0), (dx1, dy1) = (flank.slopes[i : i + 2] / 3 * length).tolist()
            corners = ((x0, y0), (x0 + dx0, y0 + dy0), (x1 - dx1, y1 - dy1), (x1, y1))
            curves.append(Bezier(tuple((side * x, y, z) for x, y in corners)))
        return curves

    @override
    def check_outline(self, throw_radius_mm: float) -> None:
        if len(self.stations_mm) != len(self.half_widths_mm):
            allowed = f"must have one value per station ({len(self.stations_mm)})"
            raise invalid("web.half_widths_mm", self.half_widths_mm, allowed)
        if any(b <= a for a, b in pairwise(self.stations_mm)):
            raise invalid("web.stations_mm", self.stations_mm, "must increase")
        self._check_curve()

    def _check_curve(self) -> None:
        """The curve between the stations has one half-width at each y, and stays off the mid-plane."""
        u = np.linspace(0, 1, 101)
        rise = self.flank.derivatives(u)[0][..., 1]
        turned = np.argwhere((rise < -1e-9) | (self.flank.at(u)[..., 0] < -1e-9))
        if len(turned):
            low, high = self.stations_mm[turned[0, 0] : turned[0, 0] + 2]
            raise invalid(
                "web.half_widths_mm",
                self.half_widths_mm,
                f"the curve folds back between the stations at {low:g} and {high:g} mm",
                "Add a station there, or let the half-width change less.",
            )


@lru_cache(maxsize=64)
def _flank(web: ProfileWeb) -> Flank:
    half = np.array(web.half_widths_mm, dtype=np.float64)
    return flank_through(half, np.array(web.stations_mm, dtype=np.float64), web.round_ends)
