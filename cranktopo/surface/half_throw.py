"""From a density to the closed surface of the half throw, journals exactly round, volume kept."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from manifold3d import Manifold
from numpy.typing import NDArray

from cranktopo.errors import CranktopoError, ExitCode, invalid
from cranktopo.frames import X, Y, Z
from cranktopo.scene import Scene
from cranktopo.surface.density_grid import DensityGrid, is_x_symmetric
from cranktopo.surface.isosurface import FineField, iso_solid, resample, unsmoothed_solid
from cranktopo.surface.solids import (
    envelope_solid,
    is_mirror_image,
    journal_halves,
    journal_stubs,
    snapped_to_mirror_plane,
    web_bores,
    web_region,
)
from cranktopo.triangles.self_intersections import self_intersections_mm
from cranktopo.triangles.surface_mesh import DEGENERATE_MM2, SurfaceMesh, mesh_of, solid_of, sound_mesh_of

Array = NDArray[np.float64]
SIMPLIFY_MM = 0.02
_SLIVERS_MM = (1e-3, 1e-4, 1e-5, 0.0)
"""How far taking out the slivers of a boolean may move the surface, from attempt to attempt."""
_ATTEMPTS = 4
_VOLUME_TOLERANCE = 1e-4
_ISO_RANGE = (0.05, 0.95)
_ISO_RESOLUTION = 1e-5
_X_AXIS = (1.0, 0.0, 0.0)


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


@dataclass(frozen=True)
class Cutter:
    """What turns an iso-surface into the web: envelope, bores, journal stubs, lateral symmetry."""

    envelope: Manifold
    bores: Manifold
    stubs: Manifold
    symmetric: bool

    def web(
        self, field: FineField, iso: float, rough_mm: Array | None = None, smoothed: bool = True
    ) -> Manifold:
        """The web at an iso-value.

        Args:
            iso: iso-value, 0 < iso < 1.
            rough_mm: places (n, 3) around which the surface is not smoothed.
            smoothed: False leaves the iso-surface as marching cubes find it.
        """
        solid = iso_solid(field, iso, SIMPLIFY_MM, rough_mm) if smoothed else unsmoothed_solid(field, iso)
        body = (solid ^ self.envelope) + self.stubs - self.bores
        if not self.symmetric:
            return body
        half = body.warp_batch(snapped_to_mirror_plane).trim_by_plane(_X_AXIS, 0.0)
        return half + half.mirror(_X_AXIS)

    def usable(self, grid: DensityGrid) -> NDArray[np.bool_]:
        """Cells whose centre lies in the envelope and in no bore."""
        from skimage.draw import polygon2mask

        solid = self.envelope + self.stubs - self.bores
        usable = np.zeros(grid.density.shape, dtype=bool)
        for layer, z in enumerate(grid.centres_mm(Z)):
            for contour in solid.slice(float(z)).to_polygons():
                cells = (contour - grid.origin_mm[[X, Y]]) / grid.cell_mm[[X, Y]] - 0.5
                usable[:, :, layer] ^= polygon2mask(usable.shape[:2], cells)
        return usable


def extract_half_throw(
    grid: DensityGrid,
    scene: Scene,
    solid_fraction: Array | None = None,
    smooth: Array | None = None,
) -> WebSurface:
    """Closed surface of the half throw, with the volume of the density.

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
    iso = find_iso(lambda value: float(cutter.web(field, value).volume()), target)
    body, mesh, dropped = _throw(cutter, field, iso, scene)
    web = web_region(body, scene)
    return WebSurface(
        half_throw=mesh,
        web=mesh_of(web),
        iso_value=iso,
        target_volume_mm3=target,
        volume_mm3=float(web.volume()),
        dropped_islands=len(dropped),
        dropped_volume_mm3=float(sum(piece.volume() for piece in dropped)),
        cavities=len(body.decompose()) - 1,
        x_symmetric=cutter.symmetric,
    )


def _throw(
    cutter: Cutter, field: FineField, iso: float, scene: Scene
) -> tuple[Manifold, SurfaceMesh, list[Manifold]]:
    """Half throw, its mesh and its islands: the first attempt whose surface does not pass through itself.

    Two things make a closed surface pass through itself: smoothing pushes one of two near sheets through the
    other, and taking out the slivers that a boolean leaves turns a face over. So slivers are first taken out
    within less and less; then the places that are left stay unsmoothed, at last the whole web. Where nothing
    helps the last attempt is returned, and the checks refuse it.
    """
    rough = np.zeros((0, 3))
    for attempt in range(_ATTEMPTS):
        web = cutter.web(field, iso, rough, smoothed=attempt < _ATTEMPTS - 1)
        for sliver_mm in _SLIVERS_MM:
            body, dropped = _keep_throw(web, scene, sliver_mm)
            mesh = sound_mesh_of(body, sliver_mm)
            places = self_intersections_mm(mesh)
            if not len(places) and mesh.areas_mm2.min() > DEGENERATE_MM2:
                return body, mesh, dropped
        rough = np.concatenate([rough, places])
    return body, mesh, dropped


def fine_field(
    cutter: Cutter, grid: DensityGrid, scene: Scene, solid_fraction: Array | None, smooth: Array | None
) -> FineField:
    """The resampled field whose iso-surface bounds the web."""
    usable = cutter.usable(grid) if solid_fraction is None else solid_fraction > 0
    without_undercuts = scene.effects.manufacturing_constraint == "on"
    return resample(grid if smooth is None else replace(grid, density=smooth), usable, without_undercuts)


def find_iso(volume_at: Callable[[float], float], target_mm3: float) -> float:
    """Iso-value at which the enclosed volume reaches the target: secant steps inside a bisection bracket.

    Args:
        volume_at: volume (mm3) at an iso-value; it falls as the iso-value grows.

    Raises:
        CranktopoError: the volume jumps past the target, as it does for a grey or uniform density.
    """
    low, high = _ISO_RANGE
    iso, previous = 0.5, None
    while high - low > _ISO_RESOLUTION:
        error = volume_at(iso) - target_mm3
        if abs(error) <= _VOLUME_TOLERANCE * target_mm3:
            return iso
        low, high = (iso, high) if error > 0 else (low, iso)
        guess = iso + (0.05 if error > 0 else -0.05)
        if previous is not None and previous[1] != error:
            guess = iso - error * (iso - previous[0]) / (error - previous[1])
        previous = (iso, error)
        iso = guess if low < guess < high else (low + high) / 2
    raise CranktopoError(
        f"surface: no iso-value encloses the {target_mm3:.0f} mm3 of the density (the volume jumps from "
        f"{volume_at(high):.0f} to {volume_at(low):.0f} mm3 at {iso:.3f}).",
        hint="The density is too grey: run more iterations, or use a smaller filter radius.",
        code=ExitCode.CRITERION_NOT_MET,
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


def build_cutter(
    grid: DensityGrid, scene: Scene, solid_fraction: Array | None, smooth: Array | None
) -> Cutter:
    """Exact solids that bound the web."""
    envelope = envelope_solid(scene, grid)
    fields = [field for field in (solid_fraction, smooth) if field is not None]
    symmetric = is_x_symmetric(grid, *fields) and is_mirror_image(envelope)
    return Cutter(envelope, web_bores(scene), journal_stubs(scene), symmetric)


def _keep_throw(web: Manifold, scene: Scene, sliver_mm: float) -> tuple[Manifold, list[Manifold]]:
    """The piece of web and journals that holds both journals, and the islands that it left."""
    main, pin = journal_halves(scene)
    pieces = (web + main + pin).as_original().simplify(sliver_mm).decompose()
    islands = [piece for piece in pieces if piece.volume() > 0]
    hollows = [piece for piece in pieces if piece.volume() <= 0]
    throw = next((piece for piece in islands if _joins(piece, scene)), None)
    if throw is None:
        raise CranktopoError(
            f"surface: the web does not connect journal and crankpin ({len(islands)} separate pieces).",
            hint="Raise the volume fraction or the resolution, or run more iterations.",
            code=ExitCode.CRITERION_NOT_MET,
        )
    for hollow in hollows:
        throw -= _inside_out(hollow)  # a hollow of a dropped island takes nothing away
    return throw, [piece for piece in islands if not _joins(piece, scene)]


def _joins(piece: Manifold, scene: Scene) -> bool:
    """Whether a piece reaches both cut planes, which only the journals do."""
    bounds = piece.bounding_box()
    return bool(bounds[2] < 1e-6 and bounds[5] > scene.pitch_mm / 2 - 1e-6)


def _inside_out(hollow: Manifold) -> Manifold:
    mesh = hollow.to_mesh64()
    flipped = np.asarray(mesh.tri_verts)[:, ::-1]
    flipped_mesh = SurfaceMesh(np.asarray(mesh.vert_properties)[:, :3], flipped)
    return solid_of(flipped_mesh, "hollow of the surface")
