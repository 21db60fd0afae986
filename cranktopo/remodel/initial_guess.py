"""Start values of the fit, read from cross-sections of the body and from what a first fit leaves over."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cranktopo.remodel.constraints import reaches_mm
from cranktopo.remodel.family import Bevel, Layout, Pocket, flank_of, station_shares
from cranktopo.remodel.search import FitProblem
from cranktopo.scene.profile import flank_half_width_mm

Array = NDArray[np.float64]
_TYPICAL = 0.75
"""Quantile over the height at which a lateral extent counts: pockets and bevels narrow some sections."""
_HALF = 0.5
_DRAFT_DEG = 10.0


def outline_start(problem: FitProblem, stations: int) -> Array:
    """Ends and half-widths at the stations, from the lateral extent of each row; clear of the journals.

    Args:
        problem: gives the cells of the body, the journals and the least wall.
        stations: points of the profile, both round ends included.
    """
    cells = problem.target
    solid = cells.filled > _HALF
    rows = np.flatnonzero(solid.any(axis=(0, 2)))
    half = cells.cell_mm[1] / 2
    low, high = cells.y_mm[rows[0]] - half, cells.y_mm[rows[-1]] + half
    extent = np.quantile(_extents(problem), _TYPICAL, axis=-1)
    reaches = reaches_mm(problem.scene, problem.rules)
    low = min(low, *(y - reach for y, reach in reaches))
    high = max(high, *(y + reach for y, reach in reaches))
    places = low + (high - low) * station_shares(stations)[1:-1]
    half_widths = np.interp(places, cells.y_mm, extent)
    for y, reach in reaches:
        half_widths = np.maximum(half_widths, np.sqrt(np.maximum(reach**2 - (places - y) ** 2, 0.0)))
    return np.concatenate([[low, high], half_widths])


def with_stations(layout: Layout, values: Array, stations: int) -> Array:
    """The same web with another number of stations, its outline taken over.

    Args:
        layout: which parameters the web has.
        values: (n,) its parameters, mm or degrees.
        stations: points of the new profile, both round ends included.
    """
    n = layout.stations
    low, high = values[:2]
    places = low + (high - low) * station_shares(stations)[1:-1]
    half_widths = flank_half_width_mm(flank_of(np, layout, values), places)
    return np.concatenate([values[:2], half_widths, values[n:]])


def bevel_start(problem: FitProblem, part: Bevel) -> Array:
    """Start, depth and crown (0) of a bevel, mm, from how far the body reaches at each height.

    Args:
        problem: gives the cells of the body and the least wall.
        part: the bevel.
    """
    cells = problem.target
    solid = (cells.filled > _HALF).any(axis=0)
    outward = 1.0 if part.face == "journal" else -1.0
    reach = np.where(solid, outward * cells.y_mm[:, None], -np.inf).max(axis=0)
    if part.face == "pin":
        reach = reach[::-1]
    below = np.flatnonzero(reach >= reach.max() - cells.cell_mm[1])
    depth = (below[0] + _HALF) * cells.cell_mm[2]
    deepest = problem.scene.web.thickness_mm - problem.rules.min_wall_mm
    return np.array([outward * reach[0], float(np.clip(depth, 1.0, deepest)), 0.0])


def side_starts(problem: FitProblem) -> list[tuple[Pocket, Array]]:
    """A side pocket and a groove, where the middle of the body is narrower than both faces."""
    values = side_start(problem)
    if values is None:
        return []
    side, groove = Pocket("side", "side"), Pocket("groove", "side")
    return [(side, values), (groove, values[[side.names.index(name) for name in groove.names]])]


def side_start(problem: FitProblem) -> Array | None:
    """Place and size of a side pocket from where the middle is narrower than both faces, or None."""
    cells = problem.target
    extent = _extents(problem)
    layers = extent.shape[1]
    third = max(1, layers // 3)
    middle = extent[:, third : layers - third].min(axis=1)
    faces = np.minimum(extent[:, :third].max(axis=1), extent[:, layers - third :].max(axis=1))
    depth = faces - middle
    if depth.max() <= 0:
        return None
    inside = np.flatnonzero(depth > depth.max() / 2)
    y = cells.y_mm[inside]
    thickness = problem.scene.web.thickness_mm
    floor = float(np.median(middle[inside]))
    return np.array([y.mean(), max(y[-1] - y[0], 6.0), thickness / 4, floor, 0.0, _DRAFT_DEG])


def pocket_start(
    part: Pocket, low: Array, high: Array, volume_mm3: float, scene_z: tuple[float, float]
) -> Array:
    """Start values of a pocket that fills a leftover.

    Args:
        part: what kind.
        low, high: corners of the leftover's bounding box, |x| >= 0, (3,), mm.
        volume_mm3: its volume on one side of x = 0.
        scene_z: web faces, mm.
    """
    depth = (high[2] - scene_z[0]) if part.face == "journal" else (scene_z[1] - low[2])
    height = high[2] - low[2]
    centre = (low + high) / 2
    values = [centre[0]] if part.pair else []
    values.append(centre[1])
    area = volume_mm3 / height * (1.0 if part.pair else 2.0)
    if part.shape == "cylinder":
        values.append(2 * np.sqrt(area / np.pi))
    else:
        values += [(high[0] - low[0]) if part.pair else 2 * high[0], high[1] - low[1]]
    return np.array(values if part.face == "through" else [*values, depth])


def _extents(problem: FitProblem) -> Array:
    """Lateral extent of each row in each layer, (ny, nz), mm."""
    cells = problem.target
    outer = cells.x_mm + cells.cell_mm[0] / 2
    return np.asarray(((cells.filled > _HALF) * outer[:, None, None]).max(axis=0))
