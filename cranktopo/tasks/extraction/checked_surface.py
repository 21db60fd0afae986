"""From a design of the optimiser to a surface that passed every check before it is written."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.bodies.cells.domain import Domain
from cranktopo.bodies.cells.grid import DensityGrid
from cranktopo.bodies.prisms import envelope_solid
from cranktopo.bodies.undercuts import Undercuts, undercuts
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import (
    check_manifold,
    check_self_intersection,
    shell_volumes_mm3,
    surface_refusal,
)
from cranktopo.tasks.density.loop import WebDensities
from cranktopo.tasks.extraction.half_throw import WebSurface, extract_half_throw
from cranktopo.tasks.extraction.walls import LeastWalls, measure

_VOLUME_TOLERANCE_PERCENT = 0.5


@dataclass(frozen=True)
class SurfaceReport:
    """Measured values of a surface that passed; the volume error is against the density, with sign."""

    vertices: int
    faces: int
    bodies: int
    cavities: int
    volume_mm3: float
    web_volume_mm3: float
    web_volume_error_percent: float


def check_surface(surface: WebSurface) -> SurfaceReport:
    """Check that the surface is one sound body with the volume of the density.

    Raises:
        CranktopoError: first check that fails, with code CRITERION_NOT_MET.
    """
    mesh = surface.half_throw
    check_manifold(mesh)
    check_self_intersection(mesh)
    shells = shell_volumes_mm3(mesh)
    bodies = int((shells > 0).sum())
    if bodies != 1:
        raise surface_refusal(
            f"{bodies} separate bodies instead of 1", "Raise the volume fraction, or take smaller cells."
        )
    error = 100 * (surface.volume_mm3 / surface.target_volume_mm3 - 1)
    if not abs(error) <= _VOLUME_TOLERANCE_PERCENT:
        raise surface_refusal(
            f"the web has {surface.volume_mm3:.0f} mm3, {error:+z.2f} % of the density's "
            f"{surface.target_volume_mm3:.0f} mm3 (allowed {_VOLUME_TOLERANCE_PERCENT} %; "
            f"{surface.dropped_islands} islands with {surface.dropped_volume_mm3:.0f} mm3 left out)",
            "Run more iterations, or raise the filter radius so that no islands form.",
        )
    return SurfaceReport(
        vertices=len(mesh.vertices_mm),
        faces=len(mesh.faces),
        bodies=bodies,
        cavities=len(shells) - bodies,
        volume_mm3=mesh.volume_mm3,
        web_volume_mm3=surface.volume_mm3,
        web_volume_error_percent=error,
    )


@dataclass(frozen=True)
class CheckedSurface:
    """The surface of a design, and the fields that it was made of.

    Attributes:
        grid: physical density of the web's cells.
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
        """Return what the scene's process cannot leave, to half a cell."""
        return undercuts(self.surface.web, scene, self.cell_mm / 2)

    def walls(self, scene: Scene) -> LeastWalls:
        """Return what the shaped walls measure."""
        return measure(self.surface.half_throw, envelope_solid(scene, self.grid), scene, self.cell_mm)


def checked_surface(scene: DesignLike, domain: Domain, design: WebDensities) -> CheckedSurface:
    """Return the surface of a design.

    Raises:
        CranktopoError: a surface that fails a check, as that of a grey density does.
    """
    scene = as_scene(scene, whole=False)
    grid, usable, smooth = web_fields(domain, design)
    surface = extract_half_throw(grid, scene, usable, smooth)
    return CheckedSurface(surface, check_surface(surface), grid, usable, smooth)


def web_fields(domain: Domain, design: WebDensities) -> tuple[DensityGrid, Array, Array]:
    """Return the web's density over the full width, the usable part of each cell, and the filtered density.

    Journals that go on through a clearance count as solid.
    """
    first, last = domain.web_layers
    fixed, free = domain.passive_fraction[:, :, first:last], domain.design_fraction[:, :, first:last]
    usable = fixed + free
    share = np.divide(free, usable, out=np.zeros_like(free), where=usable > 0)
    solid = np.where(usable > 0, 1.0 - share, 0.0)
    fields = [solid + share * design.physical, usable, solid + share * design.filtered]
    x = domain.grid.x_mm
    if domain.mirrored_x:
        fields = [np.concatenate([field[::-1], field]) for field in fields]
        x = np.concatenate([-x[:0:-1], x])
    y, z = domain.grid.y_mm, domain.grid.z_mm[first : last + 1]
    origin = np.array([x[0], y[0], z[0]])
    cell = np.array([x[1] - x[0], y[1] - y[0], (z[-1] - z[0]) / (last - first)])
    density, usable, smooth = (np.clip(field, 0.0, 1.0) for field in fields)
    return DensityGrid(origin, cell, density), usable, smooth
