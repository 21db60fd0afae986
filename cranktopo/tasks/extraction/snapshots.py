"""The intermediate designs that a run keeps, as the cells of the web that a report can show."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cranktopo.bodies.cells.domain import Domain
from cranktopo.bodies.density_grid import DensityGrid
from cranktopo.report.viewer.scene3d import DesignSnapshot
from cranktopo.runs.directories import RunStore
from cranktopo.runs.iterations import load_iteration, saved_iterations
from cranktopo.tasks.density.loop import design_of
from cranktopo.tasks.density.material import Interpolation
from cranktopo.tasks.extraction.web_fields import web_fields

MOST_SNAPSHOTS = 60
MOST_CELLS = 6_000_000
"""Of all snapshots together, one byte each before compression; finer grids are averaged over blocks."""


def snapshots(run: RunStore, domain: Domain, chain: Interpolation) -> tuple[DesignSnapshot, ...]:
    """At most 60 designs of a run in order, the first and the last included; none where it keeps none.

    Call inside `double_precision()`; `chain` is the filter chain of the run's own cells.

    Raises:
        CranktopoError: a file of the run is damaged.
    """
    numbers = evenly_spread(saved_iterations(run.path), MOST_SNAPSHOTS)
    found = []
    for number in numbers:
        x, beta = load_iteration(run.path, number)
        grid = web_fields(domain, design_of(chain, x, beta))[0]
        found.append(DesignSnapshot(number, coarsened(grid, len(numbers))))
    return tuple(found)


def evenly_spread(numbers: Sequence[int], most: int) -> list[int]:
    """At most so many of the numbers, evenly spread, with both ends."""
    if len(numbers) <= most:
        return list(numbers)
    return [numbers[round(i * (len(numbers) - 1) / (most - 1))] for i in range(most)]


def coarsened(grid: DensityGrid, count: int) -> DensityGrid:
    """One of `count` grids, averaged over the smallest blocks that keep all of them within `MOST_CELLS`."""
    size = next(n for n in range(1, 100) if count * grid.density.size <= MOST_CELLS * n**3)
    if size == 1:
        return grid
    return DensityGrid(grid.origin_mm, grid.cell_mm * size, _block_means(grid.density, size))


def _block_means(field: NDArray[np.float64], size: int) -> NDArray[np.float64]:
    """Means over blocks; the last blocks of an axis are filled up with void."""
    padded = np.pad(field, [(0, -n % size) for n in field.shape])
    blocks = padded.reshape([part for n in padded.shape for part in (n // size, size)])
    return blocks.mean(axis=(1, 3, 5))
