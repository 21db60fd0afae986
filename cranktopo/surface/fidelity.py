"""How true a surface is to its density, and how thin it gets."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cranktopo.frames import X, Y, Z
from cranktopo.scene import Scene
from cranktopo.surface.cutter import build_cutter, fine_field
from cranktopo.surface.density_grid import DensityGrid
from cranktopo.surface.half_throw import WebSurface
from cranktopo.surface.iso_distance import iso_surface_distances_mm
from cranktopo.triangles.surface_mesh import SurfaceMesh, solid_of

Array = NDArray[np.float64]
# A ball in an edge of 90 degrees misses points up to 0.146 of its diameter deep, in one of 45 degrees up to
# 0.31; in a member that is too thin for it the ball misses the middle, half of its diameter deep. What lies
# between counts as thin: knife edges below 35 degrees do. Voxels blur that by a part of their edge.
_CORE, _BLUR_VOXELS, _REACH_VOXELS = 0.35, 0.25, 0.5
_MARGIN_VOXELS = 8


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


def minimum_member_mm(mesh: SurfaceMesh, z_mm: tuple[float, float], voxel_mm: float) -> float:
    """Thickness of the thinnest member between two heights: the smallest ball that it keeps out.

    The body is opened by larger and larger balls (T. Hildebrand and P. Rueegsegger, J. Microscopy 185, 1997,
    local thickness). The first diameter whose ball misses not just the rounding of corners but the middle of
    a member is that member's thickness.

    Args:
        voxel_mm: edge of the voxels; the result is within 1.5 of them, and never below 2.

    Returns:
        Thickness, mm; that of the whole body where no member is thinner.
    """
    solid, inside = _voxels(mesh, z_mm, voxel_mm)
    depth = _depth(solid, voxel_mm)
    most = 2 * float(depth.max())
    for diameter in np.arange(2 * voxel_mm, most, voxel_mm / 2):
        reached = _distance(depth >= diameter / 2, voxel_mm) <= diameter / 2 + _REACH_VOXELS * voxel_mm
        if np.any(inside & ~reached & (depth >= _CORE * diameter + _BLUR_VOXELS * voxel_mm)):
            return float(diameter)
    return most


def _voxels(
    mesh: SurfaceMesh, z_mm: tuple[float, float], voxel_mm: float
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Solid voxels with a margin of the journals, and those of them between the two heights."""
    from skimage.draw import polygon2mask

    body = solid_of(mesh)
    bottom, top = mesh.vertices_mm.min(axis=0), mesh.vertices_mm.max(axis=0)
    low, high = bottom - 2 * voxel_mm, top + 2 * voxel_mm
    margin = _MARGIN_VOXELS * voxel_mm
    ends = max(bottom[Z], z_mm[0] - margin), min(top[Z], z_mm[1] + margin)
    layers = np.arange(ends[0] + voxel_mm / 2, ends[1], voxel_mm)
    shape = tuple(int(n) for n in np.ceil((high - low)[[X, Y]] / voxel_mm))
    solid = np.zeros((*shape, len(layers)), dtype=bool)
    for number, z in enumerate(layers):
        for contour in body.slice(float(z)).to_polygons():
            solid[:, :, number] ^= polygon2mask(shape, (contour - low[[X, Y]]) / voxel_mm - 0.5)
    between = (layers > z_mm[0]) & (layers < z_mm[1])
    return solid, solid & between


def _depth(solid: NDArray[np.bool_], voxel_mm: float) -> Array:
    """Distance of voxel centres to the surface, mm; the body goes on beyond both end planes."""
    return np.maximum(_distance(~solid, voxel_mm) - voxel_mm / 2, 0.0)


def _distance(seeds: NDArray[np.bool_], voxel_mm: float) -> Array:
    """Distance of every voxel to the nearest seed, mm."""
    from scipy import ndimage

    return np.asarray(ndimage.distance_transform_edt(~seeds, sampling=voxel_mm), dtype=np.float64)
