"""Walls of a body of triangles that stand along its crank axis: planes and cylinders, found seen along it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from cranktopo.base.arrays import Array, Int64, Mask
from cranktopo.tasks.crank_import.fits import circle, covered_rad, rms, trimmed_circle, uncovered_rad
from cranktopo.tasks.crank_import.mesh_skin import Skin
from cranktopo.tasks.importing.faces import CylinderFace, PlaneFace

FULL_RAD = 2 * np.pi - 0.65
"""Angle that the corners of a whole cylinder cover at least: a few facets may lie between."""
OPEN_RAD = 0.15
"""Angle that no triangle of it covers at most, narrower than a keyway."""
_WHOLE = 0.9
"""Share of a region's area that lies on one cylinder, which is then all of it."""
_TRIES, _MOST = 40, 40
"""Places at which a circle and a line are tried for each wall of a region, and its walls."""
_GROWN = 12
"""Rounds in which the triangles on a circle grow from a first few of them."""
_LEAST = 0.004
"""Area of a wall over its region's."""
_FACING = 0.92
"""Least cosine between the normals of a triangle and of the wall that it is on."""
_CLOSE = 0.05
"""Distance of corners that tell a dimension, over that of corners that belong to a face."""
_LARGEST = 20.0
"""Radius of a wall over the size of its region; what is flatter is a plane."""
_PLAINER = 0.98
"""Area of a plane over that of the best cylinder where the plane is taken."""


@dataclass(frozen=True)
class Wall:
    """A wall: points (n, 3) of its corners, its area, and the line or circle that it is seen along z.

    Attributes:
        centre: of the circle; of a plane, a point on it.
        radius: 0 for a plane.
        normal: outward, of its middle.
        open_rad: largest angle about its axis that none of its triangles covers: a keyway, not a facet.
    """

    points: Array
    area: float
    centre: Array
    radius: float
    normal: Array
    open_rad: float = 0.0

    @cached_property
    def turn(self) -> tuple[float, float]:
        """Angle about its axis that it covers, and where the middle of that lies."""
        return covered_rad(self.points[:, :2], self.centre)

    @property
    def full(self) -> bool:
        """True for a whole cylinder."""
        return self.radius > 0 and self.turn[0] > FULL_RAD and self.open_rad < OPEN_RAD

    @property
    def outward(self) -> bool:
        """True if the body lies inside the circle."""
        return bool(self.normal[0] > 0)

    @property
    def off_mm(self) -> float:
        """Distance of its corners from the circle, root of the mean of squares."""
        return rms(self.off(self.points))

    def off(self, points: Array) -> Array:
        """Return the distance of points (..., 3) from the circle, outside positive."""
        return np.asarray(np.linalg.norm(points[..., :2] - self.centre, axis=-1) - self.radius)

    @property
    def span(self) -> tuple[float, float]:
        """Heights at which it begins and ends."""
        return float(self.points[:, 2].min()), float(self.points[:, 2].max())

    def about(self, centre: Array) -> Wall:
        """Return the wall as a cylinder about another axis."""
        radius = float(np.linalg.norm(self.points[:, :2] - centre, axis=1).mean())
        return replace(self, centre=centre, radius=radius)

    def cylinder(self) -> CylinderFace:
        """Return the wall as the face of a cylinder."""
        turn, middle = self.turn
        along = np.array([0.0, 0.0, 1.0])
        on = self.centre + self.radius * np.array([np.cos(middle), np.sin(middle)])
        return CylinderFace(
            np.array([*self.centre, 0.0]),
            along,
            self.radius,
            self.span,
            2 * np.pi if self.full else turn,
            self.outward,
            np.array([*on, sum(self.span) / 2]),
            self.off_mm,
        )

    def plane(self) -> PlaneFace:
        """Return the wall as a plane face."""
        middle = np.array([*self.centre, sum(self.span) / 2])
        off = rms((self.points[:, :2] - self.centre) @ self.normal)
        return PlaneFace(np.array([*self.normal, 0.0]), middle, self.area, off)


def whole_wall(skin: Skin, region: Int64) -> Wall | None:
    """Return the cylinder that a region of upright triangles is all round; None where it is none."""
    whole = _trimmed(skin, region)
    on = (np.abs(whole.off(skin.triangles(region))) < skin.near_mm).all(axis=1)
    own = skin.areas[region][on].sum() > _WHOLE * skin.areas[region].sum()
    return whole if whole.full and own else None


def walls(skin: Skin, region: Int64) -> Iterator[Wall]:
    """Yield the walls of a region of upright triangles, the largest first."""
    whole = whole_wall(skin, region)
    if whole is not None:
        yield whole
        return
    area, left = float(skin.areas[region].sum()), region
    draw = np.random.default_rng(0)
    for _ in range(_MOST):
        if len(left) < 2 or skin.areas[left].sum() < _LEAST * area:
            return
        wall, on_it = _largest(skin, left, draw)
        if wall is None:
            return
        if wall.full:
            wall, on_it = _in_one_piece(skin, left, on_it)
        if wall.area > _LEAST * area:
            yield wall
        left = left[~on_it]


def _trimmed(skin: Skin, region: Int64) -> Wall:
    """Return the cylinder of most area in a region, of the corners that lie on it closely."""
    corners, areas = skin.triangles(region), skin.areas[region]
    found, on = trimmed_circle(corners[:, :, :2].reshape(-1, 2), areas.repeat(3), _CLOSE * skin.near_mm)
    own = on.reshape(-1, 3).all(axis=1)
    out = (corners.mean(axis=1)[:, :2] - found.centre) * skin.normals[region, :2]
    sign = np.sign(float(out.sum(axis=1) @ areas))
    points = skin.corners(region[own] if own.any() else region)
    gap = uncovered_rad(corners[:, :, :2], found.centre)
    return Wall(points, float(areas.sum()), found.centre, found.radius, np.array([sign, 0.0]), gap)


def _largest(skin: Skin, left: Int64, draw: np.random.Generator) -> tuple[Wall | None, Mask]:
    """Return the wall with most area among circles and lines through corners drawn, and its triangles."""
    corners = skin.triangles(left)[:, :, :2]
    normals, areas = skin.normals[left, :2], skin.areas[left]
    best, best_area = np.zeros(len(left), bool), 0.0
    is_plane = False
    for plane, on in _tried(skin, left, corners, normals, areas, draw):
        area = float(areas[on].sum())
        if area > best_area * (
            _PLAINER if plane and not is_plane else 1 / _PLAINER if is_plane and not plane else 1
        ):
            best, best_area, is_plane = on, area, plane
    if best_area == 0:
        return None, best
    own = left[best]
    points = skin.corners(own)
    if is_plane:
        mean = (normals[best] * areas[best, None]).sum(axis=0)
        middle = points[:, :2].mean(axis=0)
        normal = np.linalg.svd(points[:, :2] - middle, full_matrices=False)[2][-1]
        return Wall(points, best_area, middle, 0.0, normal * np.sign(normal @ mean)), best
    return _trimmed(skin, own), best


def _tried(
    skin: Skin, left: Int64, corners: Array, normals: Array, areas: Array, draw: np.random.Generator
) -> Iterator[tuple[bool, Mask]]:
    """Yield triangles (m,) on lines through two and on circles through three neighbouring triangles."""
    from scipy.spatial import cKDTree

    middles = corners.mean(axis=1)
    size = float(np.ptp(middles, axis=0).max())
    tree = cKDTree(middles)
    seen = np.zeros(len(left), bool)
    for start in draw.choice(len(left), _TRIES, p=areas / areas.sum()):
        if seen[start]:
            continue
        line = _on_line(corners, normals, start, skin.near_mm)
        yield True, line
        reach = size * 10 ** draw.uniform(-2, -0.3)
        near = np.array(tree.query_ball_point(middles[start], reach))
        near = near[(normals[near] @ normals[start]) > 0]
        if len(near) > 300:
            near = draw.choice(near, 300, replace=False)
        found = circle(corners[near].reshape(-1, 2))
        on = line
        for _ in range(_GROWN):
            if not found.radius < _LARGEST * size:
                break
            before = on
            on = _on_circle(corners, normals, found.centre, found.radius, skin.near_mm)
            yield False, on
            if on.sum() < 2 or (on == before).all():
                break
            found = circle(corners[on].reshape(-1, 2))
        seen |= line if line.sum() > on.sum() else on


def _in_one_piece(skin: Skin, left: Int64, on_it: Mask) -> tuple[Wall, Mask]:
    """Return the largest part of a cylinder without a gap along it: journals on one axis are several."""
    heights = skin.triangles(left)[:, :, 2]
    low, high = heights.min(axis=1), heights.max(axis=1)
    own = np.flatnonzero(on_it)[np.argsort(low[on_it])]
    reached = np.maximum.accumulate(high[own])
    parts = np.split(own, np.flatnonzero(low[own][1:] > reached[:-1] + skin.near_mm) + 1)
    largest = max(parts, key=lambda part: float(skin.areas[left[part]].sum()))
    chosen = _mask(len(left), largest)
    return _trimmed(skin, left[chosen]), chosen


def _on_line(corners: Array, normals: Array, start: int, near: float) -> Mask:
    normal = normals[start] / max(float(np.linalg.norm(normals[start])), 1e-12)
    facing = np.flatnonzero(normals @ normal > _FACING)
    off = np.abs((corners[facing] - corners[start, 0]) @ normal).max(axis=1)
    return _mask(len(corners), facing[off < near])


def _on_circle(corners: Array, normals: Array, centre: Array, radius: float, near: float) -> Mask:
    first = np.abs(np.linalg.norm(corners[:, 0] - centre, axis=1) - radius)
    likely = np.flatnonzero(first < near)  # few: the other corners need a look only there
    out = corners[likely] - centre
    away = np.linalg.norm(out, axis=2)
    on = np.abs(away - radius).max(axis=1) < near
    facing = (out.mean(axis=1) * normals[likely]).sum(axis=1) / np.maximum(away.mean(axis=1), 1e-12)
    return _mask(len(corners), likely[on & (facing * np.sign(facing[on].sum()) > _FACING)])


def _mask(count: int, chosen: Int64) -> Mask:
    mask = np.zeros(count, bool)
    mask[chosen] = True
    return mask
