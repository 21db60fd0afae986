"""From a density field to a watertight surface."""

from cranktopo.surface.export import write_stl
from cranktopo.surface.extract import WebSurface, extract_half_throw
from cranktopo.surface.gates import GateReport, check_surface
from cranktopo.surface.grid import DensityGrid
from cranktopo.surface.mesh import SurfaceMesh

__all__ = [
    "DensityGrid",
    "GateReport",
    "SurfaceMesh",
    "WebSurface",
    "check_surface",
    "extract_half_throw",
    "write_stl",
]
