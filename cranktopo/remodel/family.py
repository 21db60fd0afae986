"""The web family of the re-model as a differentiable function: parameters -> fill of cells, and its bounds.

Everything is a signed distance (positive inside) put through a smooth step whose width shrinks during the
fit. The step is odd about the surface, so that a flat surface is fitted without bias at any width.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.remodel.checks import SHOULDER_MM
from cranktopo.remodel.occupancy import Occupancy
from cranktopo.remodel.rules import Rules
from cranktopo.scene import Scene
from cranktopo.scene.profile import Flank, flank_through

Array = NDArray[np.float64]
CHORDS = 10
"""Chords per piece of the outline in the distance field."""
_CHECKS = 12
_LEAST_RISE = 0.01
"""Least rise in y per mm along the outline, which keeps its half-width single-valued."""
_ROUNDING_MM = 0.01
"""Parameters are rounded to 0.01 mm in the scene; the constraints keep that much clear."""


@dataclass(frozen=True)
class Layout:
    """Which parameters a web of the family has.

    Attributes:
        stations: points of the profile, both round ends included.
    """

    stations: int

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters, mm each, in the order of the vector."""
        return ("y_low", "y_high", *(f"half_width_{i}" for i in range(1, self.stations - 1)))


def station_shares(stations: int) -> Array:
    """Places of the stations between both ends, 0 to 1: denser toward the ends, as Chebyshev's points."""
    return np.asarray((1 - np.cos(np.pi * np.arange(stations) / (stations - 1))) / 2)


def flank_of(xp: Any, layout: Layout, values: Any) -> Flank:
    """The outline of a parameter vector; `xp` is numpy or jax.numpy."""
    n = layout.stations
    low, high = values[0], values[1]
    stations = low + (high - low) * xp.asarray(station_shares(n))
    zero = xp.zeros(1)
    return flank_through(xp, xp.concatenate([zero, values[2:n], zero]), stations, (True, True))


def fill(layout: Layout, values: Any, cells: Occupancy, width_mm: float) -> Any:
    """Fill of every cell by the web of a parameter vector, bores not cut, (nx, ny, nz); JAX.

    Args:
        layout: the parameters.
        values: their values, mm.
        cells: where.
        width_mm: half-width of the smooth step.
    """
    import jax.numpy as jnp

    inside = outline_distance(flank_of(jnp, layout, values), cells.x_mm, cells.y_mm)[:, :, None]
    return _step(jnp.broadcast_to(inside, cells.filled.shape) / width_mm)


def outline_distance(flank: Flank, x_mm: Array, y_mm: Array) -> Any:
    """Signed distance from the outline, positive inside, at x >= 0 times y, (nx, ny), mm; JAX."""
    import jax.numpy as jnp

    pieces = flank.at(jnp, np.linspace(0, 1, CHORDS + 1))
    start, end = pieces[:, :-1].reshape(-1, 2), pieces[:, 1:].reshape(-1, 2)
    x, y = jnp.asarray(x_mm)[:, None, None], jnp.asarray(y_mm)[None, :, None]
    dx, dy = end[:, 0] - start[:, 0], end[:, 1] - start[:, 1]
    px, py = x - start[:, 0], y - start[:, 1]
    along = jnp.clip((px * dx + py * dy) / (dx**2 + dy**2), 0.0, 1.0)
    square = (px - along * dx) ** 2 + (py - along * dy) ** 2
    distance = jnp.sqrt(square.min(axis=-1) + 1e-12)
    across = (start[:, 1] <= y) & (y < end[:, 1])
    edge = jnp.where(across, start[:, 0] + py / dy * dx, 0.0).sum(axis=-1)
    return jnp.where(x[..., 0] < edge, distance, -distance)


def violations(layout: Layout, values: Any, scene: Scene, rules: Rules) -> Any:
    """Manufacturing constraints, each satisfied where it is <= 0; JAX.

    Walls and shoulders around both axes (mm), radius of curvature (times the rule), single-valued outline.
    """
    import jax.numpy as jnp

    flank = flank_of(jnp, layout, values)
    u = (np.arange(_CHECKS) + 0.5) / _CHECKS
    points = flank.at(jnp, u).reshape(-1, 2)
    rise = flank.derivatives(jnp, u)[0][..., 1].ravel()
    bend = flank.curvature_per_mm(jnp, u).ravel() * rules.min_radius_mm
    walls = [
        reach - jnp.sqrt(points[:, 0] ** 2 + (points[:, 1] - y) ** 2) for y, reach in reaches_mm(scene, rules)
    ]
    ends = jnp.stack(
        [
            reaches_mm(scene, rules)[0][1] + values[0],
            reaches_mm(scene, rules)[1][1] + scene.throw.radius_mm - values[1],
        ]
    )
    return jnp.concatenate([*walls, ends, bend - 1, -bend - 1, _LEAST_RISE - rise[1:-1]])


def reaches_mm(scene: Scene, rules: Rules) -> list[tuple[float, float]]:
    """Axes and least distance of the outline from it, mm: wall around the bore, shoulder of the fillet."""
    throw = scene.throw
    pairs = ((0.0, throw.main_journal), (throw.radius_mm, throw.crankpin))
    return [
        (
            y,
            max(j.bore_radius_mm + rules.min_wall_mm, j.radius_mm + j.fillet_mm + SHOULDER_MM)
            + 2 * _ROUNDING_MM,
        )
        for y, j in pairs
    ]


def web_of(layout: Layout, values: Array, scene: Scene) -> dict[str, Any]:
    """The `[web]` table of a parameter vector, rounded to 0.01 mm, as plain data."""
    n = layout.stations
    flank = flank_of(np, layout, np.asarray(values, dtype=np.float64))
    return {
        "thickness_mm": scene.web.thickness_mm,
        "outline": "profile",
        "stations_mm": [round(float(y), 2) for y in flank.points_mm[:, 1]],
        "half_widths_mm": [0.0, *(round(float(h), 2) for h in values[2:n]), 0.0],
    }


def _step(distance: Any) -> Any:
    """Smooth step from 0 at -1 to 1 at +1 with a continuous slope."""
    import jax.numpy as jnp

    u = jnp.clip(distance, -1.0, 1.0)
    return 0.5 + 0.75 * u - 0.25 * u**3
