"""The walls that an optimisation shaped, and what a workshop measures on them: draft, members and gaps.

Web faces, envelope walls, bores, drillings, and holes and solids of features that no optimiser changes are
given, not shaped: the flanks of a counterweight say.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from manifold3d import Manifold
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.frames import Z
from cranktopo.bodies.prisms import drillings, feature_holes, kept_solid
from cranktopo.bodies.undercuts import Withdrawal, withdrawal_of
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of
from cranktopo.tasks.extraction.cutter import distances_mm, refined_corners_mm

_ON_MM = 0.02
_MOST_POINTS = 5_000
_BALL_STEPS = 40
_FEWER_POINTS = 16
_TINY_MM = 1e-6
_FACING = math.cos(math.radians(140.0))
"""Walls face each other within 40 deg: a knife edge counts as a thin member, a corner of 90 deg does not."""
_ALONG = math.sin(math.radians(1.0))
_KEPT_SHARE = 0.9
_PARTING_CELLS = 1.5
_LEAST_SHARE = 0.01
"""A least value is the one that all but this share of the shaped walls' area keeps: single triangles and the
rounding of an edge do not decide."""


@dataclass(frozen=True)
class Walls:
    """Points (n, 3) evenly spread over walls, unit normals out of the solid, areas that each stands for."""

    points_mm: Array
    normals: Array
    areas_mm2: Array

    def where(self, chosen: NDArray[np.bool_] | slice) -> Walls:
        """Return some of the points."""
        return Walls(self.points_mm[chosen], self.normals[chosen], self.areas_mm2[chosen])


def measures_walls(scene: Scene) -> bool:
    """Tell whether a process, member or gap limits the shape, so that it is worth measuring."""
    lengths = scene.optimise.min_member_mm, scene.optimise.min_gap_mm
    return _is_manufactured(scene) or any(lengths)


def _is_manufactured(scene: Scene) -> bool:
    return scene.effects.manufacturing_constraint == "on"


def walls_of(mesh: SurfaceMesh, spacing_mm: float) -> Walls:
    """Return all walls of a surface, by triangles with edges of at most a length."""
    corners = refined_corners_mm(mesh, spacing_mm)
    doubled = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(doubled, axis=1)
    sound = size > 1e-9
    return Walls(corners.mean(axis=1)[sound], doubled[sound] / size[sound, None], size[sound] / 2)


def _shaped(walls: Walls, envelope: Manifold, scene: Scene) -> Walls:
    """Return the walls between the web's faces that no envelope, bore, hole, journal or kept solid bounds."""
    start, end = scene.web_z_mm
    x, y, z = walls.points_mm.T
    inside = (z > start + _ON_MM) & (z < end - _ON_MM)
    for journal, centre in scene.throw.journals:
        radius = np.hypot(x, y - centre)
        for journal_radius in (journal.bore_radius_mm, journal.radius_mm):
            inside &= ~((np.abs(radius - journal_radius) < _ON_MM) & (np.abs(walls.normals[:, Z]) < 0.01))
    found = walls.where(inside)
    found = found.where(slice(None, None, max(1, len(found.areas_mm2) // _MOST_POINTS)))
    for given in (envelope, drillings(scene) + feature_holes(scene), kept_solid(scene)):
        if not given.is_empty():
            found = found.where(distances_mm(found.points_mm, mesh_of(given)) > _ON_MM)
    return found


def drafts_deg(walls: Walls, way: Withdrawal) -> Array:
    """Return angle between each wall and the way it is left; negative where a die half would be held, deg."""
    along = walls.normals[:, way.axis or 0]
    if way.parting_mm is None:
        outward = np.abs(along)
    else:
        outward = np.sign(walls.points_mm[:, way.axis or 0] - way.parting_mm) * along
    return np.asarray(np.degrees(np.arcsin(np.clip(outward, -1.0, 1.0))))


def from_parting_mm(walls: Walls, way: Withdrawal) -> Array:
    """Return the distance of each wall from where the halves part, (n,), mm.

    A mould parts where walls of both its halves meet in one edge; infinite where none do, as for a mill. What
    is less than 1 deg off its way belongs to neither half and makes no edge.
    """
    if way.axis is None:
        return np.full(len(walls.areas_mm2), np.inf)
    if way.parting_mm is not None:
        return np.asarray(np.abs(walls.points_mm[:, way.axis] - way.parting_mm))
    along, found = walls.normals[:, way.axis], np.full(len(walls.areas_mm2), np.inf)
    for side in (1.0, -1.0):
        own, other = side * along > 0, -side * along > _ALONG
        found[own] = _to_one_edge_mm(walls.where(own), walls.where(other))
    return found


def _to_one_edge_mm(walls: Walls, others: Walls) -> Array:
    """Return distance to the nearest of other walls; infinite where that lies on another side of a member."""
    from scipy.spatial import KDTree

    if not len(others.areas_mm2):
        return np.full(len(walls.areas_mm2), np.inf)
    distance, nearest = KDTree(others.points_mm).query(walls.points_mm)
    beside = np.einsum("ij,ij->i", walls.normals, others.normals[nearest]) > 0
    return np.asarray(np.where(beside, distance, np.inf))


def least(values: Array, areas_mm2: Array, share: float = _LEAST_SHARE) -> float:
    """Return the value that all but a share of the area keeps; infinite without any area."""
    if not len(values):
        return math.inf
    order = np.argsort(values)
    covered = np.cumsum(areas_mm2[order])
    return float(values[order][np.searchsorted(covered, share * covered[-1])])


@dataclass(frozen=True)
class LeastWalls:
    """The minimum draft, member and gap of walls; None where there is none."""

    least_draft_deg: float | None
    least_member_mm: float | None
    least_gap_mm: float | None


def measure(half_throw: SurfaceMesh, envelope: Manifold, scene: Scene, cell_mm: float) -> LeastWalls:
    """Return what the shaped walls measure.

    Draft is that of a die's or a mould's halves and leaves out the walls nearest to where they part, whose
    edge is rounded; of a mill or of a free web there is none.
    """
    body = walls_of(half_throw, cell_mm)
    walls = _shaped(body, envelope, scene)
    way = withdrawal_of(scene)
    drafted = walls.where(from_parting_mm(walls, way) > _PARTING_CELLS * cell_mm)
    leaves = _is_manufactured(scene) and way.axis is not None
    draft = least(drafts_deg(drafted, way), drafted.areas_mm2) if leaves else math.inf
    member = least(members_mm(walls, body), walls.areas_mm2)
    gap = least(gaps_mm(walls, body), walls.areas_mm2)
    return LeastWalls(*(value if math.isfinite(value) else None for value in (draft, member, gap)))


def members_mm(walls: Walls, body: Walls) -> Array:
    """Return the thickness behind each wall, mm: the diameter of the ball that fits inside, else infinite.

    Source: J. Ma, S. W. Bae, S. Choi, 3D medial axis point approximation using nearest neighbors and the
    normal field, The Visual Computer 28, 2012.
    """
    return _balls_mm(walls, -1.0, body)


def gaps_mm(walls: Walls, body: Walls) -> Array:
    """Return the width of the gap in front of each wall, in the same way, mm."""
    return _balls_mm(walls, 1.0, body)


def _balls_mm(walls: Walls, side: float, body: Walls) -> Array:
    """Return diameters of the largest empty balls that touch the walls from outside (1) or inside (-1)."""
    largest = float(np.ptp(body.points_mm, axis=0).max())
    radius, opposite = np.full((2, len(walls.points_mm)), [[largest], [np.inf]])
    # Among few points first: of a large ball's centre far too many points are about as near.
    for points in (body.where(slice(None, None, _FEWER_POINTS)), body):
        _shrink(radius, opposite, walls, side, points)
    # Neighbours on a curved wall shorten the last ball a little, a corner shortens it much.
    return np.where(radius >= _KEPT_SHARE * opposite, 2 * opposite, np.inf)


def _shrink(radius: Array, opposite: Array, walls: Walls, side: float, body: Walls) -> None:
    """Shrink balls in place until they hold no point of a body.

    Args:
        opposite: radius with which each ball last touched a wall that faces its own.
    """
    from scipy.spatial import KDTree

    tree, going = KDTree(body.points_mm), np.arange(len(radius))
    for _ in range(_BALL_STEPS):
        at, way = walls.points_mm[going], side * walls.normals[going]
        distance, nearest = tree.query(at + way * radius[going, None], workers=-1)
        hit = body.points_mm[nearest] - at
        depth, square = np.einsum("ij,ij->i", hit, way), np.einsum("ij,ij->i", hit, hit)
        shorter = np.divide(square, 2 * depth, out=np.full(len(going), np.inf), where=depth > _TINY_MM)
        moved = (distance < radius[going] - _TINY_MM) & (shorter < radius[going] - _TINY_MM)
        going, shorter, nearest = going[moved], shorter[moved], nearest[moved]
        if not len(going):
            break
        radius[going] = shorter
        facing = np.einsum("ij,ij->i", walls.normals[going], body.normals[nearest]) < _FACING
        opposite[going[facing]] = shorter[facing]
