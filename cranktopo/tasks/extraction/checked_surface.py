"""From a design of the optimiser to a surface that passed every check."""

from __future__ import annotations

from dataclasses import dataclass

from cranktopo.base.arrays import Array
from cranktopo.bodies.cells.domain import Domain
from cranktopo.bodies.density_grid import DensityGrid
from cranktopo.bodies.prisms import envelope_solid
from cranktopo.bodies.undercuts import Undercuts, undercuts
from cranktopo.design.schema import Scene
from cranktopo.tasks.density.loop import WebDensities
from cranktopo.tasks.extraction.half_throw import WebSurface, extract_half_throw
from cranktopo.tasks.extraction.surface_checks import SurfaceReport, check_surface
from cranktopo.tasks.extraction.walls import measure
from cranktopo.tasks.extraction.web_fields import web_fields


@dataclass(frozen=True)
class CheckedSurface:
    """The surface of a design, and the fields that it was made of.

    Attributes:
        grid: physical density of the web's cells.
        usable: part of each cell that can hold material.
        smooth: filtered density.
    """

    surface: WebSurface
    report: SurfaceReport
    grid: DensityGrid
    usable: Array
    smooth: Array

    @property
    def cell_mm(self) -> float:
        """Smallest edge of the cells."""
        return float(self.grid.cell_mm.min())

    def undercuts(self, scene: Scene) -> Undercuts:
        """What the scene's process cannot leave, to half a cell."""
        return undercuts(self.surface.web, scene, self.cell_mm / 2)

    def walls(self, scene: Scene) -> dict[str, float | None]:
        """Least draft (deg), member and gap (mm) of the walls that were shaped; None where there is none."""
        return measure(self.surface.half_throw, envelope_solid(scene, self.grid), scene, self.cell_mm)


def checked_surface(scene: Scene, domain: Domain, design: WebDensities) -> CheckedSurface:
    """Surface of a design.

    Raises:
        CranktopoError: a surface that fails a check, as that of a grey density does.
    """
    grid, usable, smooth = web_fields(domain, design)
    surface = extract_half_throw(grid, scene, usable, smooth)
    return CheckedSurface(surface, check_surface(surface), grid, usable, smooth)
