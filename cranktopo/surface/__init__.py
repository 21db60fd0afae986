"""From a density field to a watertight surface."""

from cranktopo.surface.density_grid import DensityGrid
from cranktopo.surface.half_throw import WebSurface, extract_half_throw
from cranktopo.surface.surface_checks import SurfaceReport, check_surface

__all__ = [
    "DensityGrid",
    "SurfaceReport",
    "WebSurface",
    "check_surface",
    "extract_half_throw",
]
