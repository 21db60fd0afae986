"""The intermediate designs that a run keeps, as the cells of the web that a report can show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cranktopo.domain.build import Domain, build_domain
from cranktopo.fem.precision import double_precision
from cranktopo.optimise.loop import build_chain, design_of
from cranktopo.optimise.material import Interpolation
from cranktopo.scene import Scene
from cranktopo.store import RunStore, load_iteration, saved_iterations
from cranktopo.surface import DensityGrid
from cranktopo.surface.web_fields import web_fields

MOST_STEPS = 60
MOST_CELLS = 6_000_000
"""Of all steps together, one byte each before compression; finer grids are averaged over blocks."""


@dataclass(frozen=True)
class DesignSnapshot:
    """A design on its way.

    Attributes:
        iteration: its number.
        cells: physical density of the web's cells.
    """

    iteration: int
    cells: DensityGrid


def steps(run: RunStore, scene: Scene, domain: Domain | None = None) -> tuple[DesignSnapshot, ...]:
    """The designs of a run's iterations, at most 60 of them, the first and the last included.

    Args:
        run: an optimise run.
        scene: its scene, as simulated.
        domain: its cells; built again where they are not given.

    Returns:
        Steps in order; none where the run keeps none or its grid can no longer be built.

    Raises:
        CranktopoError: a file of the run is damaged.
    """
    numbers = _spread(saved_iterations(run.path), MOST_STEPS)
    if not numbers or scene.envelope is None:
        return ()
    with double_precision():
        cells = domain or build_domain(scene, scene.optimise.resolution_mm)
        chain = build_chain(scene, cells)
        return tuple(DesignSnapshot(n, _coarse(_cells(run, cells, chain, n), len(numbers))) for n in numbers)


def _spread(numbers: Sequence[int], most: int) -> list[int]:
    """At most so many of the numbers, evenly spread, with both ends."""
    if len(numbers) <= most:
        return list(numbers)
    return [numbers[round(i * (len(numbers) - 1) / (most - 1))] for i in range(most)]


def _cells(run: RunStore, domain: Domain, chain: Interpolation, iteration: int) -> DensityGrid:
    x, beta = load_iteration(run.path, iteration)
    return web_fields(domain, design_of(chain, x, beta))[0]


def _coarse(grid: DensityGrid, count: int) -> DensityGrid:
    """The grid averaged over blocks of n cells each way, n the smallest that keeps to the limit."""
    size = next(n for n in range(1, 100) if count * grid.density.size <= MOST_CELLS * n**3)
    return (
        grid
        if size == 1
        else DensityGrid(grid.origin_mm, grid.cell_mm * size, _block_means(grid.density, size))
    )


def _block_means(field: NDArray[np.float64], size: int) -> NDArray[np.float64]:
    """Means over blocks; the last blocks of an axis are filled up with void."""
    padded = np.pad(field, [(0, -n % size) for n in field.shape])
    blocks = padded.reshape([part for n in padded.shape for part in (n // size, size)])
    return blocks.mean(axis=(1, 3, 5))
