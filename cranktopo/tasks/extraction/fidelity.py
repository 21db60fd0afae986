"""How true a surface is to its density."""

from __future__ import annotations

from cranktopo.base.arrays import Array
from cranktopo.bodies.density_grid import DensityGrid
from cranktopo.design.schema import Scene
from cranktopo.tasks.extraction.cutter import build_cutter, fine_field
from cranktopo.tasks.extraction.half_throw import WebSurface
from cranktopo.tasks.extraction.iso_distance import iso_surface_distances_mm


def iso_distance_mm(
    surface: WebSurface,
    grid: DensityGrid,
    scene: Scene,
    solid_fraction: Array | None = None,
    smooth: Array | None = None,
) -> Array:
    """Distances from the iso-surface of the resampled density, before any smoothing, to the final surface.

    Only its points inside the envelope and outside bores and journals count: elsewhere the exact solids make
    the surface.

    Returns:
        One distance per point, (n,), mm; at most 20 000 points, evenly chosen.
    """
    cutter = build_cutter(grid, scene, solid_fraction, smooth)
    field = fine_field(cutter, grid, scene, solid_fraction, smooth)
    return iso_surface_distances_mm(cutter, field, surface.iso_value, surface.web)
