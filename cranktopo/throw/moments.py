"""Volume and moments of bodies without a CAD kernel: exact across the web, Gauss quadrature along it.

At each place along the throw the heights are known between which the section is smooth, so the quadrature
over them is exact for straight walls; intervals along the throw are halved until both halves add up. It is
the mass of the web and the oracle of its solid.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache, reduce

import numpy as np

from cranktopo.base.arrays import Array, Index, Mask
from cranktopo.base.quadrature import gauss_legendre
from cranktopo.throw.crossings import crossings
from cranktopo.throw.feature import Body
from cranktopo.throw.web import web_spans

_HEIGHTS, _PLACES = 12, 12
"""Gauss points of an interval along the crank axis and along the throw."""
_MIDDLE = np.array([0.5]), np.array([1.0])
"""The one point that is enough along the crank axis where all bodies are prisms."""
_TOLERANCE = 1e-11
"""Largest change of an integral by halving an interval, over the whole."""
_HALVINGS = 40
_MOST_INTERVALS = 1000
"""Open at a time; more are open only where rounding is all that is left to gain."""


@dataclass(frozen=True)
class Moments:
    """Moments of a body of unit density about the crank axis, or times a density those of its mass.

    Volume in mm3, integrals of x and y in mm4, that of x^2 + y^2 in mm5.
    """

    volume: float
    first_x: float
    first_y: float
    polar: float

    def __add__(self, other: Moments) -> Moments:
        return Moments(*(one + two for one, two in zip(self._all, other._all, strict=True)))

    def __sub__(self, other: Moments) -> Moments:
        return self + other.times(-1)

    def times(self, factor: float) -> Moments:
        """Return all moments multiplied by a height or a density."""
        return Moments(*(factor * value for value in self._all))

    @property
    def _all(self) -> tuple[float, float, float, float]:
        return self.volume, self.first_x, self.first_y, self.polar


def body_moments(bodies: Sequence[Body], before_z_mm: float | None = None) -> Moments:
    """Return the moments of what bodies leave; with a height, weighted by the distance before it, mm.

    Bores come last: a plan asks for a web with and without them, and a drag of one leaves the rest as it is.
    """
    exact = [(body, body.exact_moments(before_z_mm)) for body in bodies]
    cut = sorted((body for body, found in exact if found is None), key=lambda body: body.bore)
    rest = sum(not body.bore for body in cut)
    found = [_integrals(tuple(cut[:rest])), *(_taken(cut[:n], cut[n]) for n in range(rest, len(cut)))]
    weighted = (one if before_z_mm is None else one.times(before_z_mm) - by_z for one, by_z in found)
    total, *taken = (*weighted, *(Moments(*found) for _, found in exact if found is not None))
    return reduce(operator.sub, taken, total)


def _taken(bodies: Sequence[Body], bore: Body) -> tuple[Moments, Moments]:
    """Return the moments of what a bore takes out of what bodies leave, and those times the height."""
    low, high = bore.y_range_mm
    near = [one for one in bodies if one.y_range_mm[0] < high and one.y_range_mm[1] > low]
    return _taken_beside(tuple(near), bore)


@lru_cache(maxsize=32)
def _taken_beside(bodies: tuple[Body, ...], bore: Body) -> tuple[Moments, Moments]:
    bored, (low, high) = (*bodies, bore), bore.y_range_mm
    places = _breaks(bored)
    halves = np.append(places, (low + high) / 2)  # a moment about its middle has no size
    within = (halves >= max(low, places[0])) & (halves <= min(high, places[-1]))
    return _between(bored, np.unique(halves[within]), bodies)


@lru_cache(maxsize=32)
def _integrals(bodies: tuple[Body, ...]) -> tuple[Moments, Moments]:
    """Return the moments of what bodies leave, and those times the height: their sections cost the same once.

    Kept by the bodies alone, as scenes of one web differ in loads and effects.
    """
    return _between(bodies, _breaks(bodies))


def _between(
    bodies: Sequence[Body], breaks: Array, whole: Sequence[Body] | None = None
) -> tuple[Moments, Moments]:
    """Return the moments of what bodies leave between places along the throw, and those times the height.

    With a `whole`, of what they take out of what that leaves.
    """

    def slices(y: Array) -> Array:
        row, z, weight = _heights(bodies, y)
        at = _moments_at(bodies, y[row], z)
        at = at if whole is None else _moments_at(whole, y[row], z) - at
        columns = np.concatenate([at * one[:, None] for one in (weight, weight * z)], axis=1).T
        return np.stack([np.bincount(row, column, len(y)) for column in columns], axis=1)

    found = integrate(slices, breaks).tolist()
    return Moments(*found[:4]), Moments(*found[4:])


def body_section_moments(bodies: Sequence[Body], z_mm: float) -> Moments:
    """Return the moments of the section that bodies leave at a height, per mm of height."""
    found = integrate(lambda y: _moments_at(bodies, y, np.full_like(y, z_mm)), _breaks(bodies))
    return Moments(*found.tolist())


def _breaks(bodies: Sequence[Body]) -> Array:
    ends = [y for body in bodies if body.adds for y in body.y_range_mm]
    places = np.array(sorted({y for body in bodies for y in body.y_breaks_mm}))
    return places[(places >= min(ends)) & (places <= max(ends))]


def _heights(bodies: Sequence[Body], y: Array) -> tuple[Index, Array, Array]:
    """Points of the quadrature along the crank axis: places along the throw by number, heights, weights.

    Where no body changes its section one point is enough, and there is none where two breaks are one.
    """
    breaks = _breaks_along(bodies, y)
    row, column = np.nonzero(breaks[:, 1:] > breaks[:, :-1])
    low, size = breaks[row, column], breaks[row, column + 1] - breaks[row, column]
    changing, middle = np.zeros(len(row), dtype=bool), low + size / 2
    for body in bodies:
        here = _beside(body, y)[row] if body.changing_z_mm else changing
        for start, end in body.changing_z_mm:
            changing |= here & (middle > start) & (middle < end)
    parts = []
    for chosen, (share, weights) in ((~changing, _MIDDLE), (changing, gauss_rule(_HEIGHTS))):
        at, tall = low[chosen][:, None], size[chosen][:, None]
        places = np.repeat(row[chosen], len(share))
        parts.append((places, (at + tall * share).ravel(), (tall * weights).ravel()))
    rows, heights, shares = (np.concatenate(one) for one in zip(*parts, strict=True))
    return rows, heights, shares


def _breaks_along(bodies: Sequence[Body], y: Array) -> Array:
    """Heights between which the section is smooth at places along the throw, (y, heights), rising."""
    material = [body for body in bodies if body.adds]
    low, high = min(body.z_mm[0] for body in material), max(body.z_mm[1] for body in material)
    middle = np.asarray((low + high) / 2)
    half = np.max([right for body in material for _, right in body.spans(y, middle)], axis=0)
    breaks = np.stack([one for body in bodies for one in _breaks_of(body, y, half, low)], axis=1)
    breaks = np.sort(np.clip(breaks, low, high), axis=1)
    if any(body.oblique for body in bodies):
        breaks = np.sort(np.concatenate([breaks, crossings(bodies, y, breaks)], axis=1), axis=1)
    return breaks


def _breaks_of(body: Body, y: Array, half: Array, elsewhere: float) -> list[Array]:
    here = _beside(body, y)
    return [np.where(here, z, elsewhere) for z in body.z_breaks_mm(y, half)]


def _beside(body: Body, y: Array) -> Mask:
    """Tell which places along the throw lie within a body's extent."""
    low, high = body.y_range_mm
    return (y > low) & (y < high)


def _moments_at(bodies: Sequence[Body], y: Array, z: Array) -> Array:
    """Integrals over x of 1, x, y and x2 + y2 through the material, on the last axis."""
    left, right = web_spans(bodies, y, z)
    length = (right - left).sum(axis=0)
    squares = right * right, left * left  # products, as powers of three take five times as long
    first = (squares[0] - squares[1]).sum(axis=0) / 2
    second = (squares[0] * right - squares[1] * left).sum(axis=0) / 3
    return np.stack([length, first, length * y, second + length * y**2], axis=-1)


def integrate(function: Callable[[Array], Array], breaks: Array, tolerance: float = _TOLERANCE) -> Array:
    """Return integrals (n,) of a function with values (y, n) between breaks.

    Intervals are halved until that changes no integral by more than the tolerance, over the whole.
    """
    low, high = breaks[:-1], breaks[1:]
    values = _quadrature(function, low, high)
    total, scale = np.zeros(values.shape[1]), np.abs(values).sum(axis=0)
    scale[1::4] = scale[2::4]
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        below, above = _of_halves(function, low, middle, high)
        open_ = (np.abs(below + above - values) > tolerance * scale).any(axis=1)
        total += (below + above)[~open_].sum(axis=0)
        low, high = (np.concatenate([a[open_], b[open_]]) for a, b in ((low, middle), (middle, high)))
        values = np.concatenate([below[open_], above[open_]])
        if len(values) == 0 or len(values) > _MOST_INTERVALS:
            break
    return np.asarray(total + values.sum(axis=0))


def _of_halves(
    function: Callable[[Array], Array], low: Array, middle: Array, high: Array
) -> tuple[Array, Array]:
    """Return the quadratures of both halves of intervals, in one call: most of it is calls."""
    both = _quadrature(function, np.concatenate([low, middle]), np.concatenate([middle, high]))
    return both[: len(low)], both[len(low) :]


def _quadrature(function: Callable[[Array], Array], low: Array, high: Array) -> Array:
    share, weights = gauss_rule(_PLACES)
    size = (high - low)[:, None]
    values = function((low[:, None] + size * share).ravel()).reshape(len(low), _PLACES, -1)
    return np.asarray((values * (size * weights)[..., None]).sum(axis=1))


@lru_cache(maxsize=4)
def gauss_rule(points: int) -> tuple[Array, Array]:
    """Gauss points of 0 .. 1 and weights, through 3 u2 - 2 u3, which takes square roots at both ends."""
    nodes, weights = gauss_legendre(points)
    u = (nodes + 1) / 2
    return u**2 * (3 - 2 * u), weights / 2 * 6 * u * (1 - u)
