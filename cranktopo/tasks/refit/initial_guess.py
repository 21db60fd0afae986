"""Initial guess of the outline, read from cross-sections of the body; features guess for themselves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.tasks.refit.constraints import reaches_mm
from cranktopo.tasks.refit.family import Layout, flank_of, station_shares
from cranktopo.tasks.refit.model_fill import added_mm
from cranktopo.tasks.refit.search import FitProblem
from cranktopo.throw.profile import flank_half_width_mm

_TYPICAL = 0.75
"""Quantile over the height at which a lateral extent counts: pockets and bevels narrow some sections."""


def outline_guess(problem: FitProblem, stations: int) -> Array:
    """Return ends and half-widths at the stations, from each row's lateral extent; clear of the journals.

    Args:
        stations: points of the profile, both round ends included.
    """
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
    """Return the same web with another number of stations, its outline taken over.

    Args:
        values: (n,) parameters of the web, mm or degrees.
        stations: points of the new profile, both round ends included.
    """
    n = layout.stations
    low, high = values[:2]
    places = low + (high - low) * station_shares(stations)[1:-1]
    half_widths = flank_half_width_mm(flank_of(layout, values), places)
    return np.concatenate([values[:2], half_widths, values[n:]])


def _extents(problem: FitProblem) -> Array:
    """Return the lateral extent of each row in each layer, (ny, nz), mm."""
    cells = problem.target
    outer = cells.x_mm + cells.cell_mm[0] / 2
    return np.asarray((_solid(problem) * outer[:, None, None]).max(axis=0))


def _solid(problem: FitProblem) -> NDArray[np.bool_]:
    """Return the cells that the body fills clear of the counterweight, whose rim cuts cells, (nx, ny, nz)."""
    cells = problem.target
    added = added_mm(problem.scene, (cells.x_mm, cells.y_mm, cells.z_mm))
    return cells.solid if added is None else cells.solid & (added < -cells.cell_mm.max())
