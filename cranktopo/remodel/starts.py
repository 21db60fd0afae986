"""Start values of the fit, read from cross-sections of the body."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cranktopo.remodel.family import Layout, station_shares
from cranktopo.remodel.occupancy import Occupancy

Array = NDArray[np.float64]
_TYPICAL = 0.75
"""Quantile over the height at which a lateral extent counts: pockets and bevels narrow some sections."""


def outline_start(layout: Layout, cells: Occupancy, reaches: list[tuple[float, float]]) -> Array:
    """Ends and half-widths at the stations, from the lateral extent of each row.

    Args:
        layout: the parameters.
        cells: the body.
        reaches: axes along the throw and the radii around them that the outline must clear, mm.
    """
    solid = cells.filled > 0.5
    rows = np.flatnonzero(solid.any(axis=(0, 2)))
    half = cells.cell_mm[1] / 2
    low, high = cells.y_mm[rows[0]] - half, cells.y_mm[rows[-1]] + half
    outer = cells.x_mm + cells.cell_mm[0] / 2
    extent = np.quantile((solid * outer[:, None, None]).max(axis=0), _TYPICAL, axis=-1)
    low = min(low, *(y - reach for y, reach in reaches))
    high = max(high, *(y + reach for y, reach in reaches))
    stations = low + (high - low) * station_shares(layout.stations)[1:-1]
    half_widths = np.interp(stations, cells.y_mm, extent)
    for y, reach in reaches:
        half_widths = np.maximum(half_widths, np.sqrt(np.maximum(reach**2 - (stations - y) ** 2, 0.0)))
    return np.concatenate([[low, high], half_widths])
