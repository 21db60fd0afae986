"""From a density to the closed surface of the half throw, journals exactly round, volume kept.

Smoothing may push one of two near sheets through the other; taking out the slivers that a boolean leaves may
turn a face over; putting points on the mirror plane may leave a crack without width in it; sheets may meet in
single edges or vertices. So slivers are first taken out within less and less. Then follow the ways of `WAYS`,
each of which moves the surface by a small part of a cell; what it leads to must have the density's volume and
lie near the iso-surface, or the next one is tried.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache, partial

import numpy as np
from manifold3d import Manifold

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, ExitCode, invalid
from cranktopo.base.frames import Z
from cranktopo.bodies.cells.grid import DensityGrid
from cranktopo.bodies.prisms import ON_MIRROR_MM, journal_halves, web_region
from cranktopo.design.halves import usual_scale
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import (
    SurfaceMesh,
    manifold_fault,
    mesh_of,
    self_intersections_mm,
    solid_of,
    sound_mesh_of,
)
from cranktopo.tasks.extraction.cutter import (
    Cutter,
    build_cutter,
    find_iso,
    fine_field,
    iso_surface_distances_mm,
)
from cranktopo.tasks.extraction.isosurface import REFINE, FineField, blurred

_NEAR_MM, _FARTHER_MM = (1e-3, 1e-4, 1e-5, 0.0), (4e-3, 1.6e-2)
"""Distances of the first attempts to take slivers out, and for a throw of usual size those of the last."""
VOLUME_SHARE = 2.5e-3
"""Largest difference from the volume of the density by any way but the usual."""
DISTANCE_CELLS = 1.0
"""Largest distance from the iso-surface by any way but the usual, in cells."""


@dataclass(frozen=True)
class ExtractionMethod:
    """One way from the field to the web.

    Attributes:
        name: what differs from the usual way, in words.
        spared: places where the surface passed through itself so far stay unsmoothed.
        smoothed: False leaves all of the iso-surface as marching cubes find it.
        on_mirror_mm: points nearer to x = 0 are put on it.
        shift: of the iso-value.
        blur: of the field, standard deviation in steps of its lattice; the volume stays.
    """

    name: str
    spared: bool = False
    smoothed: bool = True
    on_mirror_mm: float = ON_MIRROR_MM
    shift: float = 0.0
    blur: float = 0.0


_USUAL = ExtractionMethod("")
WAYS = (
    ExtractionMethod("no point moved onto the mirror plane", on_mirror_mm=0.0),
    ExtractionMethod("places unsmoothed", spared=True),
    ExtractionMethod("more places unsmoothed", spared=True),
    ExtractionMethod("iso-value raised by 0.001", shift=1e-3),
    ExtractionMethod("iso-value lowered by 0.001", shift=-1e-3),
    ExtractionMethod("not smoothed", smoothed=False),
    ExtractionMethod("not smoothed, iso-value raised by 0.001", smoothed=False, shift=1e-3),
    ExtractionMethod("field blurred by half a cell", blur=0.5 * REFINE),
    ExtractionMethod("field blurred by half a cell, not smoothed", blur=0.5 * REFINE, smoothed=False),
    ExtractionMethod("field blurred by a cell", blur=1.0 * REFINE),
)


@dataclass(frozen=True)
class _SoundThrow:
    """The half throw of one way: the piece that joins both journals, its surface, what hangs on nothing."""

    body: Manifold
    mesh: SurfaceMesh
    islands: list[Manifold]
    iso: float
    way: ExtractionMethod


@dataclass(frozen=True)
class _HalfThrowField:
    """Source of a surface; `iso` is that of the usual way, `target_mm3` by the density."""

    cutter: Cutter
    field: FineField
    iso: float
    target_mm3: float
    scene: Scene


def _sound_throw(cutter: Cutter, field: FineField, target_mm3: float, scene: Scene) -> _SoundThrow:
    """Return the half throw by the first way that leads to a sound surface.

    Where none does, that of the usual way is returned, and the checks refuse it.

    Raises:
        CranktopoError: no iso-value with that volume, or journal and pin not connected.
    """
    usual = lru_cache(maxsize=2)(partial(cutter.web, field))  # that of the last value is needed again
    iso = find_iso(lambda value: float(usual(value).volume()), target_mm3)
    source = _HalfThrowField(cutter, field, iso, target_mm3, scene)
    first, places = _joined(_USUAL, source, iso, usual(iso))
    if places is None:
        return first
    rough = places
    for way in WAYS:
        if way.spared and not len(rough):
            continue
        try:
            found, places = _by(way, source, rough)
        except CranktopoError:  # nothing left that joins the journals
            continue
        if places is None and _near(found, source):
            return found
        rough = rough if places is None else np.concatenate([rough, places])
    return first


def _by(way: ExtractionMethod, source: _HalfThrowField, rough: Array) -> tuple[_SoundThrow, Array | None]:
    """Return the throw of a way; None where it is sound, else the places where it passes through itself."""
    cutter, field, iso = source.cutter, source.field, source.iso
    if way.blur:
        field = blurred(field, way.blur)
        iso = find_iso(lambda value: float(_web(way, cutter, field, value).volume()), source.target_mm3)
    iso += way.shift
    return _joined(way, source, iso, _web(way, cutter, field, iso, rough if way.spared else None))


def _joined(
    way: ExtractionMethod, source: _HalfThrowField, iso: float, web: Manifold
) -> tuple[_SoundThrow, Array | None]:
    """Return the throw of a web as `_by` does."""
    for sliver_mm in slivers_mm(source.scene):
        body, islands = _keep_throw(web, source.scene, sliver_mm)
        mesh = sound_mesh_of(body, sliver_mm)
        found, places = _SoundThrow(body, mesh, islands, iso, way), np.zeros((0, 3))
        if not manifold_fault(mesh):
            places = self_intersections_mm(mesh)
            if not len(places):
                return found, None
    return found, places


def slivers_mm(scene: Scene) -> tuple[float, ...]:
    """Return by how much taking out the slivers of a boolean may move the surface, from attempt to attempt.

    The last distances are in proportion to the throw: an STL rounds to 0.03 um at half a metre, and that
    turns faces over which are thinner.
    """
    return (*_NEAR_MM, *(mm / usual_scale(scene) for mm in _FARTHER_MM))


def _web(
    way: ExtractionMethod, cutter: Cutter, field: FineField, iso: float, rough: Array | None = None
) -> Manifold:
    return cutter.web(field, iso, rough, way.smoothed, way.on_mirror_mm)


def _near(found: _SoundThrow, source: _HalfThrowField) -> bool:
    """Tell whether a throw has the volume of the density, islands counted, and lies near its iso-surface."""
    web = web_region(found.body, source.scene)
    volume = web.volume() + sum(piece.volume() for piece in found.islands)
    if abs(volume - source.target_mm3) > VOLUME_SHARE * source.target_mm3:
        return False
    limit = DISTANCE_CELLS * REFINE * float(source.field.spacing_mm.max())
    distances = iso_surface_distances_mm(source.cutter, source.field, source.iso, mesh_of(web))
    return float(distances.max(initial=0.0)) <= limit


def _keep_throw(web: Manifold, scene: Scene, sliver_mm: float) -> tuple[Manifold, list[Manifold]]:
    """Return the piece of web and journals that holds both journals, and the islands that it left."""
    main, pin = journal_halves(scene)
    pieces = (web + main + pin).as_original().simplify(sliver_mm).decompose()
    islands = [piece for piece in pieces if piece.volume() > 0]
    hollows = [piece for piece in pieces if piece.volume() <= 0]
    throw = next((piece for piece in islands if _joins(piece, scene)), None)
    if throw is None:
        raise CranktopoError(
            f"surface: the web does not connect journal and crankpin ({len(islands)} separate pieces).",
            hint="Raise the volume fraction, take smaller cells, or run more iterations.",
            code=ExitCode.CRITERION_NOT_MET,
        )
    for hollow in hollows:
        throw -= _inside_out(hollow)  # a hollow of a dropped island takes nothing away
    return throw, [piece for piece in islands if not _joins(piece, scene)]


def _joins(piece: Manifold, scene: Scene) -> bool:
    bounds = piece.bounding_box()
    return bool(bounds[2] < 1e-6 and bounds[5] > scene.pitch_mm / 2 - 1e-6)


def _inside_out(hollow: Manifold) -> Manifold:
    mesh = hollow.to_mesh64()
    flipped = np.asarray(mesh.tri_verts)[:, ::-1]
    flipped_mesh = SurfaceMesh(np.asarray(mesh.vert_properties)[:, :3], flipped)
    return solid_of(flipped_mesh, "hollow of the surface")


@dataclass(frozen=True)
class WebSurface:
    """Surface of the half throw and how it was reached.

    Attributes:
        half_throw: web with both journal halves, bores removed.
        web: the part between the web faces.
        target_volume_mm3: volume of the web by the density.
        volume_mm3: volume of the web by its surface, islands left out.
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
    grid: DensityGrid, scene: Scene, solid_fraction: Array | None = None, smooth: Array | None = None
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

    Raises:
        CranktopoError: empty density, no iso-value with that volume, journal and pin not connected, or a
            grid that does not span the web.
    """
    target = _target(grid, scene, solid_fraction)
    cutter = build_cutter(grid, scene, solid_fraction, smooth)
    field = fine_field(cutter, grid, scene, solid_fraction, smooth)
    throw = _sound_throw(cutter, field, target, scene)
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
