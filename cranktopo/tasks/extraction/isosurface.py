"""Smooth iso-surface of a cell-wise density.

Cells that cannot hold material are filled from their nearest neighbours and the field is mirrored at the
grid's faces, so that the surface meets envelope, bores and web faces squarely before these cut it exactly.
Tricubic resampling (B-spline) removes the terraces of the cells, marching cubes (Lorensen and Cline, 1987;
in the variant whose output is always a closed 2-manifold) gives triangles, Taubin's lambda-mu filter (1995)
smooths them without shrinking. Where two sheets lie so near each other that smoothing would push one through
the other they stay as marching cubes found them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np
from manifold3d import Manifold
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.bodies.cells.grid import DensityGrid
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, solid_of

_PAD_CELLS = 3
REFINE = 2
"""Points of the lattice per cell and axis."""
_BEYOND_CELLS = 12
"""Cells by which a row goes on for its spline: beyond, its ends count for 1e-7."""
_CUBIC_AT_QUARTER = np.array([27.0, 235.0, 121.0, 1.0]) / 384
"""Cubic B-splines of four cells, the first centre 1.25 cells before the point."""
_ROUGH_STEPS = 3.0
"""Distance around a rough place within which the surface stays as it is, in steps of the lattice."""
_TAUBIN_LAMBDA, _TAUBIN_MU, _TAUBIN_STEPS = 0.5, 0.52, 10


@dataclass(frozen=True)
class FineField:
    """Resampled density on a regular lattice from its first point on; its outermost points are void."""

    origin_mm: Array
    spacing_mm: Array
    values: Array


Release = Callable[[Array, Array, Array, NDArray[np.bool_]], Array]
"""From a field, the place of its first point, its spacing (mm) and its usable points to what can be made."""


def resample(
    grid: DensityGrid, usable: NDArray[np.bool_], release: Release | None = None, ways: Sequence[int] = ()
) -> FineField:
    """Return the density on a lattice twice as fine as the cells, continued beyond what can hold material.

    Args:
        usable: (nx, ny, nz) cells that can hold material; the rest takes the nearest value of these.
    """
    filled = _filled(grid, usable)
    padded = np.pad(filled, _PAD_CELLS, mode="symmetric")
    fine = reduce(_on_quarters, range(padded.ndim), padded)
    spacing = grid.cell_mm / REFINE
    first = grid.origin_mm - _PAD_CELLS * grid.cell_mm + spacing / 2
    if release is not None:
        fine = _released(fine, grid, usable, release, ways)
    return FineField(first - spacing, spacing, np.pad(fine, 1, constant_values=0.0))


def _on_quarters(values: Array, axis: int) -> Array:
    """Return values of cells at a quarter of a cell before and after their centres, by cubic B-splines.

    Axis by axis this is `scipy.ndimage.zoom` by `REFINE` in a tenth of its time: 4 terms per point for 64.
    """
    from scipy import ndimage

    rows = np.moveaxis(values, axis, 0)
    longer = np.concatenate([rows[:1].repeat(_BEYOND_CELLS, 0), rows, rows[-1:].repeat(_BEYOND_CELLS, 0)])
    shares = ndimage.spline_filter1d(longer, 3, axis=0, mode="nearest")
    fine = np.empty((len(rows), REFINE, *rows.shape[1:]))
    for place, weights, origin in ((0, _CUBIC_AT_QUARTER[::-1], 0), (1, _CUBIC_AT_QUARTER, -1)):
        found = ndimage.correlate1d(shares, weights, axis=0, origin=origin)
        fine[:, place] = found[_BEYOND_CELLS : len(found) - _BEYOND_CELLS]
    return np.moveaxis(fine.reshape(-1, *rows.shape[1:]), 0, axis)


def blurred(field: FineField, steps: float) -> FineField:
    """Return the field under a Gaussian filter of a standard deviation in steps of the lattice."""
    from scipy import ndimage

    values = ndimage.gaussian_filter(field.values[1:-1, 1:-1, 1:-1], steps, mode="nearest")
    return replace(field, values=np.pad(values, 1))


def iso_solid(field: FineField, iso: float, tolerance_mm: float, rough_mm: Array | None = None) -> Manifold:
    """Return the smooth solid where the field exceeds an iso-value; empty when it does so nowhere.

    Args:
        tolerance_mm: how far simplification may move the surface.
        rough_mm: places (n, 3) around which the surface is not smoothed.
    """
    if not field.values.min() < iso < field.values.max():
        return Manifold()
    rough = _marching_cubes(field, iso)
    vertices, faces = rough.vertices_mm, rough.faces
    smooth = _taubin(rough)
    if rough_mm is not None and len(rough_mm):
        smooth = vertices + _smoothed_share(vertices, rough_mm, field.spacing_mm) * (smooth - vertices)
    return solid_of(SurfaceMesh(smooth, faces), "iso-surface of the density").simplify(tolerance_mm)


def unsmoothed_solid(field: FineField, iso: float) -> Manifold:
    """Return the solid where the field exceeds an iso-value that it holds, as marching cubes find it."""
    return solid_of(_marching_cubes(field, iso), "iso-surface of the density")


def _marching_cubes(field: FineField, iso: float) -> SurfaceMesh:
    from skimage.measure import marching_cubes

    vertices, faces, _, _ = marching_cubes(
        field.values, iso, gradient_direction="ascent", method="lorensen", allow_degenerate=True
    )
    points = vertices.astype(np.float64) * field.spacing_mm + field.origin_mm
    return SurfaceMesh(points, faces.astype(np.int64))


def _filled(grid: DensityGrid, usable: NDArray[np.bool_]) -> Array:
    from scipy import ndimage

    density = np.clip(grid.density, 0.0, 1.0)
    if usable.all() or not usable.any():
        return density
    nearest = ndimage.distance_transform_edt(
        ~usable, sampling=grid.cell_mm, return_distances=False, return_indices=True
    )
    filled: Array = density[tuple(nearest)]
    return filled


def _released(
    fine: Array, grid: DensityGrid, usable: NDArray[np.bool_], release: Release, ways: Sequence[int]
) -> Array:
    """Return the resampled field as its process makes it.

    Along its ways the mirror image beyond the grid's faces is no obstacle to tools: there the field goes on
    straight, so that walls keep their draft up to the faces. Beside them it is made like the field itself.
    """
    spacing, along = grid.cell_mm / REFINE, np.isin(np.arange(3), ways)
    cells = np.where(along, 0, _PAD_CELLS)
    within = np.kron(np.pad(usable, [(n, n) for n in cells], mode="edge"), np.ones((REFINE,) * 3, dtype=bool))
    beyond = [(n, n) for n in np.where(along, REFINE * _PAD_CELLS, 0)]
    inner = tuple(slice(n, size - n) for (n, _), size in zip(beyond, fine.shape, strict=True))
    first = grid.origin_mm + spacing / 2 - cells * grid.cell_mm
    released_field = release(fine[inner], first, spacing, within)
    return np.clip(np.pad(released_field, beyond, mode="reflect", reflect_type="odd"), 0.0, 1.0)


def _smoothed_share(vertices: Array, rough_mm: Array, spacing_mm: Array) -> Array:
    """Return the share of the smoothing that each vertex keeps, (n, 1): none near a rough place."""
    from scipy.spatial import KDTree

    distance, _ = KDTree(rough_mm / spacing_mm).query(vertices / spacing_mm)
    return np.asarray(np.clip(distance / _ROUGH_STEPS - 1, 0.0, 1.0))[:, None]


def _taubin(surface: SurfaceMesh) -> Array:
    import trimesh
    from scipy import sparse

    faces = surface.faces
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    shape = (len(surface.vertices_mm), len(surface.vertices_mm))
    neighbours = sparse.coo_matrix((np.ones(len(edges)), edges.T), shape=shape).tocsr()
    mean_of_neighbours = sparse.diags(1 / np.asarray(neighbours.sum(axis=1)).ravel()) @ neighbours
    mesh = surface.as_trimesh()
    trimesh.smoothing.filter_taubin(
        mesh,
        lamb=_TAUBIN_LAMBDA,
        nu=_TAUBIN_MU,
        iterations=_TAUBIN_STEPS,
        laplacian_operator=mean_of_neighbours,
    )
    return np.asarray(mesh.vertices, dtype=np.float64)
