"""The fit of one layout to the voxel fill of a body: initial guess of the outline, misfit, search."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.base.notes import Pace
from cranktopo.design.schema import Scene
from cranktopo.numerics.optimisers.gradient_search import minimise
from cranktopo.tasks.refit.family import Layout, flank_of, station_shares
from cranktopo.tasks.refit.model_fill import added_mm, smooth_step
from cranktopo.tasks.refit.parametric_web import ParametricWeb, reaches_mm
from cranktopo.throw.manufacturing_limits import ManufacturingLimits
from cranktopo.throw.profile import flank_half_width_mm

if TYPE_CHECKING:
    from manifold3d import Manifold


MOST = 0.5 + 1e-6
"""Share of a cell that is most of it; a plane through its middle leaves half of it but for rounding."""
_MARGIN_CELLS = 3
_DIGITS, _DIGITS_MM = 4, 3
"""Decimals of fills and of the grid's ends: bodies that differ by rounding have the same cells."""
_LINES = 3
"""Lines per cell, in y and in z, along which the body's lateral extent is taken."""


@dataclass(frozen=True)
class VoxelFill:
    """Share of each cell that is filled, mean of both sides of x = 0; centres have x > 0 only."""

    x_mm: Array
    y_mm: Array
    z_mm: Array
    cell_mm: Array
    filled: Array

    @property
    def solid(self) -> NDArray[np.bool_]:
        """Cells that are filled for the most part, (nx, ny, nz)."""
        return self.filled > MOST

    @property
    def volume_mm3(self) -> float:
        """Volume of both sides, mm3."""
        return float(2 * self.filled.sum() * np.prod(self.cell_mm))


def voxel_fill(body: Manifold, scene: Scene, cell_mm: float) -> VoxelFill:
    """Return the fill of the cells between the web faces.

    Exact in x (lengths of chords), by the mean of 3 x 3 lines per cell in y and z.

    Raises:
        CranktopoError: nothing of the body lies between the web faces.
    """
    start, end = scene.web_z_mm
    x0, y0, z0, x1, y1, z1 = np.round(body.bounding_box(), _DIGITS_MM).tolist()
    if body.is_empty() or z1 <= start or z0 >= end:
        raise CranktopoError(
            f"surface: nothing lies between the web faces at z = {start:g} and {end:g} mm.",
            hint="Give the design that the surface belongs to, in mm.",
        )
    margin = _MARGIN_CELLS * cell_mm
    x = _edges(0.0, max(-x0, x1) + margin, cell_mm)
    y, z = _edges(y0 - margin, y1 + margin, cell_mm), _edges(start, end, cell_mm)
    filled = np.stack([_layer(body, x, y, pair) for pair in pairwise(z)], axis=-1).round(_DIGITS)
    sizes = np.array([e[1] - e[0] for e in (x, y, z)])
    cx, cy, cz = ((e[:-1] + e[1:]) / 2 for e in (x, y, z))
    return VoxelFill(cx, cy, cz, sizes, filled)


def _edges(low: float, high: float, cell: float) -> Array:
    return np.linspace(low, high, max(1, int(np.ceil((high - low) / cell - 1e-9))) + 1)


def _layer(body: Manifold, x: Array, y: Array, z: tuple[float, float]) -> Array:
    offsets = (np.arange(_LINES) + 0.5) / _LINES
    rows = (y[:-1, None] + np.diff(y)[:, None] * offsets).ravel()
    total = np.zeros((len(x) - 1, len(rows)))
    for height in z[0] + (z[1] - z[0]) * offsets:
        for contour in body.slice(float(height)).to_polygons():
            total += _signed_lengths(np.asarray(contour), x, rows)
    share = total / (2 * _LINES * np.diff(x)[:, None])
    return np.asarray(share.reshape(len(x) - 1, len(y) - 1, _LINES).mean(axis=-1))


def _signed_lengths(contour: Array, x: Array, rows: Array) -> Array:
    """Return the length of each x cell that a contour encloses on each row; holes count negative."""
    a, b = contour, np.roll(contour, -1, axis=0)
    crosses = (a[:, None, 1] <= rows) != (b[:, None, 1] <= rows)
    edge, row = np.nonzero(crosses)
    rise = b[edge, 1] - a[edge, 1]
    at = a[edge, 0] + (rows[row] - a[edge, 1]) / rise * (b[edge, 0] - a[edge, 0])
    # What lies right of a falling edge (left of a rising one) cancels except inside the contour.
    sign = np.sign(rise)
    right = np.clip(at[:, None], x[:-1], x[1:]) - x[:-1]
    left = x[1:] - np.clip(-at[:, None], x[:-1], x[1:])
    lengths = np.zeros((len(rows), len(x) - 1))
    np.add.at(lengths, row, sign[:, None] * (right + left))
    return lengths.T


_TOLERANCE = 1e-4
_FLAT = 1e-8
_KEPT = 5e-3
"""Violation that rounding of the parameters absorbs."""
_EVALUATIONS = 200
_REACH = 15.0
"""Largest move of a parameter in one search, mm or degrees."""


@dataclass(frozen=True)
class FitProblem:
    """Fill to match and rules to keep; `free` is the share of each cell that no bore or drilling takes.

    `pace` hears of every search.
    """

    target: VoxelFill
    free: Array
    scene: Scene
    limits: ManufacturingLimits
    pace: Pace = field(default_factory=lambda: Pace("fit", 1))


class Fit:
    """Misfit of a web, as functions of its parameters."""

    def __init__(self, problem: FitProblem, layout: Layout) -> None:
        cells = problem.target
        axes = cells.x_mm, cells.y_mm, cells.z_mm
        self.web = ParametricWeb(layout, problem.scene, problem.limits, axes)
        self._target, self._free = cells.filled, problem.free

    def misfit(self, values: Array, width_mm: float) -> tuple[float, Callable[[], Array]]:
        """Return the squared difference of the fills over the filled volume, and what finds its gradient."""
        inside, which = self.web.inside_mm(values)
        model, steepness = smooth_step(inside, width_mm)
        off = model * self._free - self._target

        def gradient() -> Array:
            weight = 2 * off * self._free * steepness / self._target.sum()
            return self.web.vjp(values, which, weight)

        return float((off**2).sum() / self._target.sum()), gradient

    def fill(self, values: Array, width_mm: float) -> Array:
        """Return the fill of the cells, bores and drillings cut out, by half the width of the step."""
        return smooth_step(self.web.inside_mm(values)[0], width_mm)[0] * self._free

    def overlap(self, values: Array, width_mm: float) -> float:
        """Return the intersection over union of the fills."""
        model = self.fill(values, width_mm)
        return float(np.minimum(model, self._target).sum() / np.maximum(model, self._target).sum())


def minimise_misfit(
    fit: Fit, guess: Array, widths_mm: tuple[float, ...], step: str = "fit"
) -> tuple[Array, float]:
    """Return values that keep the constraints, by searches with ever sharper steps, and their misfit.

    The misfit is infinite when none were found.
    """
    values, error = guess, np.inf
    pace = Pace(f"{step}, webs of {len(guess)} dimensions", len(widths_mm) * _EVALUATIONS, at_most=True)
    for width in widths_mm:
        values, error = _minimise(fit, values, width, pace)
        if not np.isfinite(error):
            break
    return values, error


def _minimise(fit: Fit, guess: Array, width_mm: float, pace: Pace) -> tuple[Array, float]:
    best, least = guess, np.inf
    bounds = np.maximum(fit.web.bounds[0], guess - _REACH), np.minimum(fit.web.bounds[1], guess + _REACH)

    def value(values: Array) -> tuple[float, Callable[[], Array]]:
        nonlocal best, least
        pace.begin()
        result, gradient = fit.misfit(values, width_mm)
        if result < least and np.max(fit.web.constraints(values)) < _KEPT:
            best, least = values.copy(), float(result)
        return float(result), gradient

    def constrain(values: Array) -> tuple[Array, Callable[[], Array]]:
        return fit.web.constraints(values), lambda: fit.web.gradients(values)

    minimise(value, constrain, bounds, guess, _TOLERANCE, _EVALUATIONS, _FLAT)
    return best, least


_TYPICAL = 0.75
"""Quantile over the height at which a lateral extent counts: pockets and bevels narrow some sections."""


def outline_guess(problem: FitProblem, stations: int) -> Array:
    """Return ends and half-widths at the stations, from each row's lateral extent; clear of the journals."""
    cells = problem.target
    rows = np.flatnonzero(_solid(problem).any(axis=(0, 2)))
    half = cells.cell_mm[1] / 2
    low, high = cells.y_mm[rows[0]] - half, cells.y_mm[rows[-1]] + half
    extent = np.quantile(_extents(problem), _TYPICAL, axis=-1)
    reaches = reaches_mm(problem.scene, problem.limits)
    low = min(low, *(y - reach for y, reach in reaches))
    high = max(high, *(y + reach for y, reach in reaches))
    places = low + (high - low) * station_shares(stations)[1:-1]
    half_widths = np.interp(places, cells.y_mm, extent)
    for y, reach in reaches:
        half_widths = np.maximum(half_widths, np.sqrt(np.maximum(reach**2 - (places - y) ** 2, 0.0)))
    return np.concatenate([[low, high], half_widths])


def with_stations(layout: Layout, values: Array, stations: int) -> Array:
    """Return the same web with another number of stations, both ends included, its outline taken over."""
    n = layout.stations
    low, high = values[:2]
    places = low + (high - low) * station_shares(stations)[1:-1]
    half_widths = flank_half_width_mm(flank_of(layout, values), places)
    return np.concatenate([values[:2], half_widths, values[n:]])


def _extents(problem: FitProblem) -> Array:
    cells = problem.target
    outer = cells.x_mm + cells.cell_mm[0] / 2
    return np.asarray((_solid(problem) * outer[:, None, None]).max(axis=0))


def _solid(problem: FitProblem) -> NDArray[np.bool_]:
    """Return the cells that the body fills clear of the counterweight, whose rim cuts cells, (nx, ny, nz)."""
    cells = problem.target
    added = added_mm(problem.scene, (cells.x_mm, cells.y_mm, cells.z_mm))
    return cells.solid if added is None else cells.solid & (added < -cells.cell_mm.max())
