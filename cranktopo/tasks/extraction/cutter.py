"""The cutter that turns an iso-surface into the web: exact solids, what the process leaves, the iso-value.

Between the cells `released` is the hard form of what `optimise.forging_constraint` and `optimise.tool_access`
do smoothly on cells. A tool's radius is left to the cells.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from manifold3d import Manifold
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.frames import X, Y, Z
from cranktopo.bodies.cells.grid import DensityGrid, is_x_symmetric
from cranktopo.bodies.prisms import (
    ON_MIRROR_MM,
    envelope_solid,
    feature_holes,
    is_mirror_image,
    journal_stubs,
    kept_solid,
    snapped_to_mirror_plane,
    web_bores,
)
from cranktopo.bodies.undercuts import Withdrawal, withdrawal_of
from cranktopo.design.halves import kept_asymmetry
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, solid_of
from cranktopo.tasks.extraction.isosurface import FineField, iso_solid, resample, unsmoothed_solid


def released(
    field: Array, first_mm: Array, spacing_mm: Array, usable: NDArray[np.bool_], scene: Scene
) -> Array:
    """Return the least field above a given one that its process can make; unusable points are no obstacle."""
    way = withdrawal_of(scene)
    if way.parting_mm is not None:
        return _by_die(field, first_mm, spacing_mm, way, scene)
    main, pin = _journal_sections(field, first_mm, spacing_mm, scene)
    solid = np.concatenate([main, np.where(usable, field, 0.0), pin], axis=2)
    left = np.min([_closed_along(solid, axis, spacing_mm, scene) for axis in way.axes], axis=0)
    # In a bore the solid on both sides goes on: what the drill leaves beside it has no gap.
    return np.where(usable, left[:, :, 1:-1], np.maximum(field, left[:, :, 1:-1]))


def _journal_sections(field: Array, first_mm: Array, spacing_mm: Array, scene: Scene) -> tuple[Array, Array]:
    x, y = (first_mm[axis] + spacing_mm[axis] * np.arange(field.shape[axis]) for axis in (X, Y))
    main, pin = (
        (np.hypot(x[:, None], y[None, :] - centre) < journal.radius_mm).astype(np.float64)[:, :, None]
        for journal, centre in scene.throw.journals
    )
    return main, pin


def _by_die(field: Array, first_mm: Array, spacing_mm: Array, way: Withdrawal, scene: Scene) -> Array:
    """Return each side raised to what lies further out.

    What ends at the parting plane goes on to the first points beyond it: its edge, which smoothing rounds,
    would otherwise be caught in its own half.
    """
    axis = X if way.axis is None else way.axis
    parted = way.parting_mm or 0.0
    moved = np.moveaxis(field, axis, 0).copy()
    places = first_mm[axis] + spacing_mm[axis] * np.arange(len(moved))
    count = int(np.count_nonzero(places < parted))
    draft_slope = _draft_slope(spacing_mm, axis, scene)
    moved[:count] = closed(moved[:count], draft_slope)
    moved[count:] = closed(moved[count:][::-1], draft_slope)[::-1]
    moved[count - 1 : count + 1] = moved[count - 1 : count + 1].max(axis=0)
    return np.moveaxis(moved, 0, axis)


def _closed_along(solid: Array, axis: int, spacing_mm: Array, scene: Scene) -> Array:
    moved, draft_slope = np.moveaxis(solid, axis, 0), _draft_slope(spacing_mm, axis, scene)
    both = np.minimum(closed(moved, draft_slope), closed(moved[::-1], draft_slope)[::-1])
    return np.moveaxis(both, 0, axis)


def closed(field: Array, draft_slope: tuple[float, float]) -> Array:
    """Raise the field, layer by layer from the first on, to the layers before it and their draft."""
    if not any(draft_slope):
        return np.asarray(np.maximum.accumulate(field))
    found = field.copy()
    for layer in range(1, len(found)):
        found[layer] = np.maximum(found[layer], _dilated(found[layer - 1], draft_slope))
    return found


def _dilated(layer: Array, draft_slope: tuple[float, float]) -> Array:
    """Return a layer and its steepest climb over so many points along each axis; flat beyond its edges."""
    square = np.zeros_like(layer)
    for axis, part in enumerate(draft_slope):
        padded = np.pad(layer, [(1, 1) if axis == other else (0, 0) for other in range(2)], mode="edge")
        sides = np.stack([np.take(padded, range(k, k + layer.shape[axis]), axis) for k in (0, 2)])
        square += (part * np.maximum(0.0, sides.max(axis=0) - layer)) ** 2
    return layer + np.sqrt(square)


def _draft_slope(spacing_mm: Array, axis: int, scene: Scene) -> tuple[float, float]:
    if scene.optimise.process == "milled":
        return 0.0, 0.0
    slope = math.tan(math.radians(scene.optimise.draft_deg)) * float(spacing_mm[axis])
    first, second = (slope / float(step) for other, step in enumerate(spacing_mm) if other != axis)
    return first, second


SIMPLIFY_MM = 0.02
_VOLUME_TOLERANCE = 1e-4
_JUMP_TOLERANCE = 1e-3
"""Relative error of the volume beside a jump: a die makes columns of one density that come and go at once."""
_ISO_RANGE = (0.05, 0.95)
_ISO_RESOLUTION = 1e-5
_X_AXIS = (1.0, 0.0, 0.0)


@dataclass(frozen=True)
class Cutter:
    """Exact solids around an iso-surface: envelope, bores, journal stubs and counterweight, symmetry."""

    envelope: Manifold
    bores: Manifold
    stubs: Manifold
    symmetric: bool

    def web(
        self,
        field: FineField,
        iso: float,
        rough_mm: Array | None = None,
        smoothed: bool = True,
        on_mirror_mm: float = ON_MIRROR_MM,
    ) -> Manifold:
        """Return the web at an iso-value.

        Args:
            rough_mm: places (n, 3) around which the surface is not smoothed.
            on_mirror_mm: points nearer to x = 0 are put on it where the web is its own mirror image.
        """
        solid = iso_solid(field, iso, SIMPLIFY_MM, rough_mm) if smoothed else unsmoothed_solid(field, iso)
        body = (solid ^ self.envelope) + self.stubs - self.bores
        if not self.symmetric:
            return body
        snapped = body.warp_batch(partial(snapped_to_mirror_plane, within_mm=on_mirror_mm))
        half = snapped.trim_by_plane(_X_AXIS, 0.0)
        return half + half.mirror(_X_AXIS)

    def usable(self, grid: DensityGrid) -> NDArray[np.bool_]:
        """Return the cells whose centre lies in the envelope and in no bore."""
        from skimage.draw import polygon2mask

        solid = self.envelope + self.stubs - self.bores
        usable = np.zeros(grid.density.shape, dtype=bool)
        for layer, z in enumerate(grid.centres_mm(Z)):
            for contour in solid.slice(float(z)).to_polygons():
                cells = (contour - grid.origin_mm[[X, Y]]) / grid.cell_mm[[X, Y]] - 0.5
                usable[:, :, layer] ^= polygon2mask(usable.shape[:2], cells)
        return usable


def build_cutter(
    grid: DensityGrid, scene: Scene, solid_fraction: Array | None, smooth: Array | None
) -> Cutter:
    """Return the exact solids that bound the web."""
    envelope = envelope_solid(scene, grid)
    fields = [field for field in (solid_fraction, smooth) if field is not None]
    symmetric = is_x_symmetric(grid, *fields) and is_mirror_image(envelope) and not kept_asymmetry(scene)
    bores = web_bores(scene) + feature_holes(scene)
    return Cutter(envelope, bores, journal_stubs(scene) + kept_solid(scene), symmetric)


def fine_field(
    cutter: Cutter, grid: DensityGrid, scene: Scene, solid_fraction: Array | None, smooth: Array | None
) -> FineField:
    """Return the resampled field whose iso-surface bounds the web."""
    usable = cutter.usable(grid) if solid_fraction is None else solid_fraction > 0
    by_process = scene.effects.manufacturing_constraint == "on"
    release = partial(released, scene=scene) if by_process else None
    ways = withdrawal_of(scene).axes if by_process else ()
    return resample(grid if smooth is None else replace(grid, density=smooth), usable, release, ways)


def find_iso(volume_at: Callable[[float], float], target_mm3: float) -> float:
    """Return the iso-value that encloses the target volume: secant steps inside a bisection bracket.

    Raises:
        CranktopoError: the volume jumps far past the target, as it does for a grey or uniform density.
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
    volumes = {value: volume_at(value) for value in (high, low)}
    near = min(volumes, key=lambda value: abs(volumes[value] - target_mm3))
    if abs(volumes[near] - target_mm3) <= _JUMP_TOLERANCE * target_mm3:
        return near
    raise CranktopoError(
        f"surface: no iso-value encloses the {target_mm3:.0f} mm3 of the density (the volume jumps from "
        f"{volumes[high]:.0f} to {volumes[low]:.0f} mm3 at {iso:.3f}).",
        hint="The density is too grey: run more iterations, or use a smaller filter radius.",
        code=ExitCode.CRITERION_NOT_MET,
    )


_FACETS_ALONG = 100
"""Facets that a surface's longest extent is cut into at least."""
_NEIGHBOURS = 24
_MOST_POINTS = 20000


def iso_surface_distances_mm(cutter: Cutter, field: FineField, iso: float, web: SurfaceMesh) -> Array:
    """Return the distances from an iso-surface, before any smoothing, to the surface of a web, (n,), mm.

    Only its points inside the envelope and outside bores and journals count: elsewhere the exact solids make
    the surface. At most 20 000 points, evenly chosen.
    """
    raw = unsmoothed_solid(field, iso)
    # Booleans keep the vertices they do not remove: those that are left bound the web.
    left = _vertices((raw ^ cutter.envelope) - cutter.stubs - cutter.bores)
    points = _common(_vertices(raw), left)
    points = points[:: max(1, len(points) // _MOST_POINTS)]
    return distances_mm(points, web)


def distances_mm(points_mm: Array, mesh: SurfaceMesh) -> Array:
    """Return the distance of points to the nearest of the facets around, cut small before, (n,), mm.

    An upper bound, sharp where facets are regular.
    """
    import trimesh
    from scipy.spatial import cKDTree

    corners = refined_corners_mm(mesh, mesh.extent_mm / _FACETS_ALONG)
    count = min(_NEIGHBOURS, len(corners))
    _, near = cKDTree(corners.mean(axis=1)).query(points_mm, k=count)
    pairs = corners[near.reshape(-1)]
    targets = np.repeat(points_mm, count, axis=0)
    closest = trimesh.triangles.closest_point(pairs, targets)
    gaps = np.linalg.norm(closest - targets, axis=1).reshape(-1, count)
    return np.asarray(gaps.min(axis=1))


def refined_corners_mm(mesh: SurfaceMesh, length_mm: float) -> Array:
    """Return the corners of a surface's triangles, cut until no edge is longer, (m, 3 corners, 3), mm."""
    fine = solid_of(mesh).refine_to_length(length_mm).to_mesh64()
    return np.asarray(fine.vert_properties)[:, :3][np.asarray(fine.tri_verts).astype(np.int64)]


def _vertices(solid: Manifold) -> Array:
    return np.asarray(solid.to_mesh64().vert_properties)[:, :3]


def _common(points: Array, kept: Array) -> Array:
    """Return the points that are, bit for bit, among the kept ones."""
    rows = {row.tobytes() for row in np.ascontiguousarray(kept)}
    return points[[row.tobytes() in rows for row in np.ascontiguousarray(points)]]
