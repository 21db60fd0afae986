"""From a density to the closed surface of the half throw, journals exactly round, volume kept."""

from __future__ import annotations

from dataclasses import dataclass

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, ExitCode, invalid
from cranktopo.base.frames import Z
from cranktopo.bodies.cells.grid import DensityGrid
from cranktopo.bodies.prisms import web_region
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of
from cranktopo.tasks.extraction.cutter import build_cutter, fine_field
from cranktopo.tasks.extraction.sound_throw import sound_throw


@dataclass(frozen=True)
class WebSurface:
    """Surface of the half throw and how it was reached.

    Attributes:
        half_throw: web with both journal halves, bores removed.
        web: the part between the web faces.
        iso_value: density at the surface.
        target_volume_mm3: volume of the web by the density.
        volume_mm3: volume of the web by its surface, islands left out.
        dropped_islands: pieces that hung on nothing and were left out.
        dropped_volume_mm3: their volume.
        cavities: closed hollows inside the half throw.
        x_symmetric: the surface is its own mirror image in x = 0, by construction.
        fallback: what was done because the usual surface was not sound, as in `WAYS`; empty where it was.
    """

    half_throw: SurfaceMesh
    web: SurfaceMesh
    iso_value: float
    target_volume_mm3: float
    volume_mm3: float
    dropped_islands: int
    dropped_volume_mm3: float
    cavities: int
    x_symmetric: bool
    fallback: str


def extract_half_throw(
    grid: DensityGrid,
    scene: Scene,
    solid_fraction: Array | None = None,
    smooth: Array | None = None,
) -> WebSurface:
    """Return the closed surface of the half throw, with the volume of the density.

    The iso-value is the one at which the web, cut by envelope and bores, has the volume of the density to
    1e-4. Islands count in that volume and are left out afterwards, so that dropping much of them shows.

    Args:
        solid_fraction: (nx, ny, nz) part of each cell that can hold material; by default a cell counts in
            full (its density says how much it holds) and those with their centre outside the envelope
            or in a bore are taken as unusable.
        smooth: (nx, ny, nz) field in [0, 1] whose iso-surface bounds the web, such as the filtered density
            before its projection: a projected density steps from cell to cell, and the steps would show.
            The volume stays that of the density, which is taken for both by default.

    Returns:
        Surface in mm, coordinates rounded to single precision as the binary STL holds them.

    Raises:
        CranktopoError: empty density, no iso-value with that volume, journal and pin not connected, or a
            grid that does not span the web.
    """
    target = _target(grid, scene, solid_fraction)
    cutter = build_cutter(grid, scene, solid_fraction, smooth)
    field = fine_field(cutter, grid, scene, solid_fraction, smooth)
    throw = sound_throw(cutter, field, target, scene)
    web = web_region(throw.body, scene)
    return WebSurface(
        half_throw=throw.mesh,
        web=mesh_of(web),
        iso_value=throw.iso,
        target_volume_mm3=target,
        volume_mm3=float(web.volume()),
        dropped_islands=len(throw.islands),
        dropped_volume_mm3=float(sum(piece.volume() for piece in throw.islands)),
        cavities=len(throw.body.decompose()) - 1,
        x_symmetric=cutter.symmetric,
        fallback=throw.way.name,
    )


def _target(grid: DensityGrid, scene: Scene, solid_fraction: Array | None) -> float:
    if not grid.spans_web(scene):
        start, end = scene.web_z_mm
        raise invalid(
            "density grid",
            (float(grid.origin_mm[Z]), float(grid.upper_mm[Z])),
            f"must span the web from z = {start:g} to {end:g} mm",
            "The density belongs to another design.",
        )
    target = grid.volume_mm3(solid_fraction)
    if target <= 0:
        raise CranktopoError(
            "surface: the density is empty, there is no web to extract.",
            hint="Raise the volume fraction, or run more iterations.",
            code=ExitCode.CRITERION_NOT_MET,
        )
    return target
