"""Oil drillings on the cells: void that no optimiser fills, and a wall around it that none takes away."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from cranktopo.domain.envelope_section import envelope_outline
from cranktopo.domain.grid import Grid
from cranktopo.errors import invalid
from cranktopo.scene.drilling import Channel, channels
from cranktopo.scene.schema import Scene

Array = NDArray[np.float64]
WALL = 1.0
"""Thickness of the wall over the drilling's radius."""
_POINTS = 8
"""Sample points of a cell along each axis."""
_HEIGHTS = 24
"""Heights of the web at which the envelope must hold the drilling."""


def drill_cells(scene: Scene, grid: Grid, planes: dict[str, Array]) -> dict[str, Array]:
    """Fractions of the cells after drilling; the same ones where the scene has no drilling.

    Args:
        planes: fractions `fixed`, `design`, `pin` and `web`, each (nx, ny, nz).

    Raises:
        CranktopoError: a drilling leaves the design envelope.
    """
    for channel in channels(scene):
        if planes["design"].any():
            _check_held(scene, channel)
            planes = _with_wall(grid, channel, planes)
        hole = _fraction(grid, channel, channel.radius_mm)
        planes = {kind: fraction * (1 - hole) for kind, fraction in planes.items()}
    return planes


def _with_wall(grid: Grid, channel: Channel, planes: dict[str, Array]) -> dict[str, Array]:
    """The fractions with what is designable around a drilling fixed, the drilling itself included."""
    wall = _fraction(grid, channel, (1 + WALL) * channel.radius_mm)
    kept = wall * planes["design"]
    return {**planes, "fixed": planes["fixed"] + kept, "design": planes["design"] - kept}


def _check_held(scene: Scene, channel: Channel) -> None:
    """The envelope must hold a drilling and the wall around it between the web's faces."""
    (start, end), envelope = scene.web_z_mm, scene.envelope
    points = channel.surface_mm((1 + WALL) * channel.radius_mm)
    edges = np.linspace(start, end, _HEIGHTS + 1)
    assert envelope is not None  # or there is nothing to design
    for low, high in pairwise(edges.tolist()):
        here = points[(points[:, 2] > low) & (points[:, 2] < high)]
        if len(here) and not envelope_outline(envelope, (low + high) / 2)(here[:, 0], here[:, 1]).all():
            raise invalid(
                "envelope",
                envelope.shape,
                f"does not hold {channel.key} and the wall of {WALL * channel.radius_mm:.3g} mm around it",
                "Enlarge the envelope, or move the drilling.",
            )


def _fraction(grid: Grid, channel: Channel, radius_mm: float) -> Array:
    """Share of each cell within a distance of the drilling's axis, from 8 x 8 x 8 points."""
    result = np.zeros(grid.cells)
    points = channel.surface_mm(radius_mm)
    low, high = points.min(axis=0), points.max(axis=0)
    nodes = grid.x_mm, grid.y_mm, grid.z_mm
    ranges = [_cells(n, low[axis], high[axis]) for axis, n in enumerate(nodes)]
    if any(first >= last for first, last in ranges):
        return result
    x, y = (_samples(n[first : last + 1]) for n, (first, last) in zip(nodes[:2], ranges[:2], strict=True))
    (x0, x1), (y0, y1), (z0, z1) = ranges
    for layer in range(z0, z1):
        z = _samples(grid.z_mm[layer : layer + 2])
        away = channel.distance_mm(x[:, None, None], y[None, :, None], z[None, None, :])
        inside = (away < radius_mm).reshape(x1 - x0, _POINTS, y1 - y0, _POINTS, _POINTS)
        result[x0:x1, y0:y1, layer] = inside.mean(axis=(1, 3, 4))
    return result


def _cells(nodes: Array, low: float, high: float) -> tuple[int, int]:
    """First and past-the-last cell that a range touches."""
    first = int(np.searchsorted(nodes, low, side="right")) - 1
    last = int(np.searchsorted(nodes, high, side="left"))
    return max(first, 0), min(last, len(nodes) - 1)


def _samples(nodes: Array) -> Array:
    offsets = (np.arange(_POINTS) + 0.5) / _POINTS
    return np.asarray((nodes[:-1, None] + np.diff(nodes)[:, None] * offsets).ravel())
