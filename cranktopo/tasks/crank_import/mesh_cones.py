"""Cones of a body of triangles about the axes of its journals: lines of radius over height."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from cranktopo.base.arrays import Array, Int64, Mask
from cranktopo.tasks.crank_import.fits import uncovered_rad
from cranktopo.tasks.crank_import.mesh_skin import Skin
from cranktopo.tasks.crank_import.mesh_walls import OPEN_RAD
from cranktopo.tasks.importing.faces import ConeFace

_SHORTEST = 0.15
"""Height of a cone over its radius; what is shorter is a chamfer or a strip of a fillet."""
_CONICAL = 4.0
"""Difference of the radii at both ends over the distance of corners that belong to a face."""
_TRIES, _GROWN = 20, 12
"""Lines that are tried in a region, and rounds in which the triangles on each grow."""


def cones_about(skin: Skin, region: Int64, centres: Sequence[Array]) -> tuple[list[ConeFace], Int64]:
    """Return the whole cones of a region about axes along z, and the triangles that lie on none."""
    cones: list[ConeFace] = []
    for centre in centres:
        if len(region) and _round(skin, region, centre):
            left = np.ones(len(region), bool)
            for cone, on in _cones(skin, region, centre):
                cones.append(cone)
                left &= ~on
            region = region[left]
    return cones, region


def _round(skin: Skin, region: Int64, centre: Array) -> bool:
    return uncovered_rad(skin.triangles(region)[:, :, :2], centre) < OPEN_RAD


def _cones(skin: Skin, region: Int64, centre: Array) -> Iterator[tuple[ConeFace, Mask]]:
    """Yield cones about an axis and their triangles; a line begins at the largest triangle left."""
    corners, areas = skin.triangles(region), skin.areas[region].copy()
    profile = np.stack([np.linalg.norm(corners[:, :, :2] - centre, axis=2), corners[:, :, 2]], axis=2)
    for _ in range(_TRIES):
        start = int(areas.argmax())
        if areas[start] == 0:
            return
        on = _on_line(profile, start, areas > 0, skin.near_mm)
        cone = _cone(skin, region[on], profile[on].reshape(-1, 2), centre) if on.any() else None
        areas[on], areas[start] = 0.0, 0.0
        if cone is not None:
            yield cone, on


def _on_line(profile: Array, start: int, left: Mask, near_mm: float) -> Mask:
    """Return which triangles (m, 3, 2) of radii and heights lie on a line that grows from one of them."""
    on = np.zeros(len(left), bool)
    on[start] = True
    for _ in range(_GROWN):
        points = profile[on].reshape(-1, 2)
        if np.ptp(points[:, 1]) < near_mm:
            return np.zeros(len(left), bool)
        before, on = on, left & (_off(profile, _line(points)).max(axis=1) < near_mm)
        if not on.any() or (on == before).all():
            break
    return on


def _line(points: Array) -> Array:
    """Return slope and start of radius over height."""
    return np.polyfit(points[:, 1], points[:, 0], 1)


def _off(points: Array, line: Array) -> Array:
    """Return distances of points (..., 2) from a line."""
    return np.asarray(np.abs(points[..., 0] - np.polyval(line, points[..., 1])) / np.hypot(1.0, line[0]))


def _cone(skin: Skin, region: Int64, points: Array, centre: Array) -> ConeFace | None:
    """Return the cone on which triangles with corners (n, 2) lie; None where they are no whole one."""
    near = skin.near_mm
    line = _line(points)
    ends = [
        float(np.median(points[np.abs(points[:, 1] - z) < near, 1]))
        for z in (points[:, 1].min(), points[:, 1].max())
    ]
    radii = [float(np.polyval(line, z)) for z in ends]
    if (
        ends[1] - ends[0] < _SHORTEST * max(radii)
        or abs(radii[1] - radii[0]) < _CONICAL * near
        or not _round(skin, region, centre)
    ):
        return None
    away = skin.triangles(region).mean(axis=1)[:, :2] - centre
    out = float((away * skin.normals[region, :2]).sum(axis=1) @ skin.areas[region])
    middles = [np.array([*centre, z]) for z in ends]
    return ConeFace(np.array([0.0, 0.0, 1.0]), (middles[0], middles[1]), (radii[0], radii[1]), True, out > 0)
