"""Oblique bores of a body of triangles: drillings, found whole or by the folds along them, and bevels."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from cranktopo.base.arrays import Array, Int64, Mask
from cranktopo.tasks.crank_import.fits import across, circle, covered_rad, median_direction, rms, tilt
from cranktopo.tasks.crank_import.mesh_skin import Skin
from cranktopo.tasks.importing.faces import CylinderFace, from_line_mm

BENT_RAD = (3e-3, 0.75)
"""Angle between neighbours that may be facets of one round face."""
_ACROSS = 1 - 1e-4
"""Part along the crank of the normal of a face across it."""
FEWEST = 6
"""Triangles, and corners, of a cylinder at least."""
_SMALL = 0.05
"""Area of a drilling over the body's."""
_BARREL = 0.02
"""Mean square of the normals along its axis on a cylinder of coarse triangles."""
_MOST_BORES = 20
"""Directions of drillings with rounded outlets that are looked for."""
_BESIDE = 0.01
"""Part along a drilling of the normals of its wall."""
_BORED = 0.98
"""Largest part of a drilling's direction along the walls: what lies along the crank is a wall."""
_COLLINEAR = 1 - 1e-4


def drillings(skin: Skin, left: Mask) -> Iterator[CylinderFace]:
    """Yield oblique bores, and take their triangles out of `left`.

    Sharp edges bound them; those that rounded outlets join to journals are found by the folds along them.
    """
    inner = np.abs(skin.normals[:, 2]) < _ACROSS
    yield from _bores(skin, skin.regions(inner, BENT_RAD[1]), left)
    for _ in range(_MOST_BORES):
        axis = _oblique(skin, left & inner)
        if axis is None:
            return
        beside = left & inner & (np.abs(skin.normals @ axis) < _BESIDE)
        found = list(_bores(skin, skin.regions(beside, BENT_RAD[1]), left))
        if not found:
            return
        yield from found


def _bores(skin: Skin, regions: Iterable[Int64], left: Mask) -> Iterator[CylinderFace]:
    for region in list(regions):
        if len(region) >= FEWEST and skin.areas[region].sum() < _SMALL * skin.areas.sum():
            bore = bore_of(skin, region)
            if bore is not None and abs(bore.axis[2]) < _BORED:
                left[region] = False
                yield bore


def _oblique(skin: Skin, chosen: Mask) -> Array | None:
    """Return the direction off the crank's along which most of the folds of chosen triangles lie."""
    one, other = skin.pairs.T
    bent = chosen[one] & chosen[other] & (skin.folds > BENT_RAD[0]) & (skin.folds < BENT_RAD[1])
    folds = np.cross(skin.normals[one[bent]], skin.normals[other[bent]])
    folds /= np.linalg.norm(folds, axis=1)[:, None]
    aside = np.abs(folds[:, 2]) < _BORED
    weights = (skin.areas[one[bent]] + skin.areas[other[bent]])[aside]
    return median_direction(folds[aside], weights, _BESIDE)


def bore_of(skin: Skin, region: Int64) -> CylinderFace | None:
    """Return the cylinder that all of a region lies on; None where it lies on none."""
    normals, areas = skin.normals[region], skin.areas[region]
    values, vectors = np.linalg.eigh((normals.T * areas) @ normals / areas.sum())
    points = skin.corners(region)
    if values[0] > _BARREL or values[1] < _BARREL or len(points) < FEWEST:
        return None
    axis = _along(points, vectors[:, 0])
    frame = across(axis)
    found = circle(points @ frame.T)
    if np.abs(found.off_mm).max() > 2 * skin.near_mm:
        return None
    turn, middle = covered_rad(points @ frame.T, found.centre)
    heights = points @ axis
    centre = found.centre @ frame
    on = found.radius * np.array([np.cos(middle), np.sin(middle)]) @ frame
    out = (((skin.triangles(region).mean(axis=1) - centre) * normals).sum(axis=1) * areas).sum() > 0
    span = (float(heights.min()), float(heights.max()))
    at = centre + on + axis * sum(span) / 2
    return CylinderFace(centre, axis, found.radius, span, turn, bool(out), at, rms(found.off_mm))


def _along(points: Array, axis: Array) -> Array:
    """Return the axis of a cylinder through points (n, 3), from one that is nearly it."""
    for _ in range(3):
        frame = across(axis)
        found, heights = circle(points @ frame.T), points @ axis
        unit = (points @ frame.T - found.centre) / found.radius
        slopes = tilt(unit, heights - heights.mean(), found.off_mm)
        if np.linalg.norm(slopes) > 0.2:
            break
        axis = axis + slopes @ frame
        axis = axis / np.linalg.norm(axis)
    return axis


def of_one_bore(bores: Sequence[CylinderFace], near_mm: float) -> Iterator[CylinderFace]:
    """Yield bores and bevels, those on one line that were found in parts on the line of the longest."""
    longest: list[CylinderFace] = []
    for bore in sorted(bores, key=lambda bore: -bore.area_mm2):
        same = next(
            (
                other
                for other in longest
                if abs(other.radius_mm - bore.radius_mm) < 5 * near_mm
                and abs(other.axis @ bore.axis) > _COLLINEAR
                and from_line_mm(bore.middle_mm, other.point_mm, other.axis) < other.radius_mm + 5 * near_mm
            ),
            None,
        )
        if same is None:
            longest.append(bore)
            yield bore
        else:
            start = float((bore.point_mm - same.point_mm) @ same.axis)
            sign = float(np.sign(bore.axis @ same.axis))
            ends = sorted(start + sign * end for end in bore.span_mm)
            yield replace(
                bore,
                point_mm=same.point_mm,
                axis=same.axis,
                radius_mm=same.radius_mm,
                span_mm=(ends[0], ends[1]),
            )
