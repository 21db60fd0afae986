"""The cutter that turns an iso-surface into the web: exact solids, and the iso-value of the volume."""

from __future__ import annotations

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
    is_mirror_image,
    journal_stubs,
    kept_solid,
    snapped_to_mirror_plane,
    web_bores,
)
from cranktopo.bodies.undercuts import withdrawal_of
from cranktopo.design.schema import Scene
from cranktopo.tasks.extraction.isosurface import FineField, iso_solid, resample, unsmoothed_solid
from cranktopo.tasks.extraction.release import released

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
            iso: iso-value, 0 < iso < 1.
            rough_mm: places (n, 3) around which the surface is not smoothed.
            smoothed: False leaves the iso-surface as marching cubes find it.
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
    symmetric = is_x_symmetric(grid, *fields) and is_mirror_image(envelope)
    return Cutter(envelope, web_bores(scene), journal_stubs(scene) + kept_solid(scene), symmetric)


def fine_field(
    cutter: Cutter, grid: DensityGrid, scene: Scene, solid_fraction: Array | None, smooth: Array | None
) -> FineField:
    """Return the resampled field whose iso-surface bounds the web."""
    usable = cutter.usable(grid) if solid_fraction is None else solid_fraction > 0
    made = scene.effects.manufacturing_constraint == "on"
    release = partial(released, scene=scene) if made else None
    ways = withdrawal_of(scene).axes if made else ()
    return resample(grid if smooth is None else replace(grid, density=smooth), usable, release, ways)


def find_iso(volume_at: Callable[[float], float], target_mm3: float) -> float:
    """Return the iso-value that encloses the target volume: secant steps inside a bisection bracket.

    Args:
        volume_at: volume (mm3) at an iso-value; it falls as the iso-value grows.

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
