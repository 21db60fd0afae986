"""Undercuts: voids that a die, a mould or a mill cannot leave, by rays or voxels through any surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from manifold3d import Manifold
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.frames import X, Y, Z
from cranktopo.bodies.prisms import (
    envelope_holes,
    feature_holes,
    journal_ends,
    kept_solid,
    web_bores,
    web_region,
)
from cranktopo.design.halves import usual_scale
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of, solid_of

_NEGLIGIBLE_SHARE = 1e-4
"""Undercuts below this share of the web are grazing slivers that the triangles themselves do not resolve."""
_BEYOND_MM = 1.0
_TOUCH_MM = 1e-3
_RAYS_MM = 1.0
"""Distance of rays through a half throw of usual size; others in proportion."""


@dataclass(frozen=True)
class Undercuts:
    """Undercuts of the web's process: `caught` of the rays through the web have void before solid.

    The deepest is the longest such void along one ray and side, with a point inside it; `by` names the die,
    mould or mill.
    """

    rays: int
    caught: int
    deepest_mm: float
    volume_mm3: float
    web_mm3: float
    by: str = "a die that parts in x = 0"
    deepest_at_mm: tuple[float, float, float] | None = None

    @property
    def negligible(self) -> bool:
        """True if the process leaves the web as it is."""
        return self.volume_mm3 <= _NEGLIGIBLE_SHARE * self.web_mm3


@dataclass(frozen=True)
class Withdrawal:
    """The way in which a die, a mould or a mill leaves the web.

    Attributes:
        axis: along which it is left; None for a mill, which comes from both faces and both sides.
        parting_mm: plane that a die parts in; None for a mould, whose halves part anywhere.
    """

    text: str
    axis: int | None
    parting_mm: float | None

    @property
    def axes(self) -> tuple[int, ...]:
        """Axes along which it is left."""
        return (X, Z) if self.axis is None else (self.axis,)


LATERAL_DIE = Withdrawal("a die that parts in x = 0", X, 0.0)


def withdrawal_of(scene: Scene) -> Withdrawal:
    """Return how the web is made; one that may be free is measured by a die that parts in x = 0."""
    settings = scene.optimise
    if settings.process == "milled":
        return Withdrawal("a mill from both faces and both sides", None, None)
    lateral = settings.parting == "lateral"
    if settings.process == "cast":
        return Withdrawal(f"a mould that opens along {'x' if lateral else 'z'}", X if lateral else Z, None)
    if settings.process == "free" or lateral:
        return LATERAL_DIE
    return Withdrawal("a die that parts in mid-web", Z, sum(scene.web_z_mm) / 2)


_Voids = tuple[int, Array, float, tuple[float, float, float]]
"""Rays that met the web, lengths of void (n, 2) that each half is held back by, area of a ray, a point in the
longest void."""


def undercuts(web: SurfaceMesh, scene: Scene, step_mm: float, way: Withdrawal | None = None) -> Undercuts:
    """Return what the scene's process, or another way, would leave behind; drilled holes are filled."""
    way = way or withdrawal_of(scene)
    body = solid_of(web, "web")
    filled = body + web_bores(scene) + envelope_holes(scene) + (feature_holes(scene) ^ kept_solid(scene))
    voids = _beyond_mills if way.axis is None else _held_back
    met, lengths, area, at_mm = voids(body, filled, web, scene, way, step_mm)
    caught = int((lengths > _TOUCH_MM).any(axis=1).sum())
    volume, deepest = float(lengths.sum() * area), float(lengths.max(initial=0.0))
    return Undercuts(met, caught, deepest, volume, web.volume_mm3, way.text, at_mm if caught else None)


def half_throw_undercuts(half_throw: SurfaceMesh, scene: Scene) -> Undercuts:
    """Return what the scene's process cannot leave of the web of a half throw, from any source."""
    body = solid_of(half_throw, "half throw")
    return undercuts(mesh_of(web_region(body, scene)), scene, _RAYS_MM / usual_scale(scene))


def _held_back(
    body: Manifold, filled: Manifold, web: SurfaceMesh, scene: Scene, way: Withdrawal, step_mm: float
) -> _Voids:
    axis = X if way.axis is None else way.axis
    if axis == Z:
        body, filled = (solid + journal_ends(scene) for solid in (body, filled))
    low, high = web.vertices_mm.min(axis=0), web.vertices_mm.max(axis=0)
    first, second = (other for other in (X, Y, Z) if other != axis)
    rows, columns = (_centres(low[other], high[other], step_mm) for other in (first, second))
    area = float(rows[1] - rows[0]) * float(columns[1] - columns[0])
    start, end = np.zeros(3), np.zeros(3)
    beyond = _BEYOND_MM if axis == X else 3 * _BEYOND_MM  # past the ends of journals and bores
    start[axis], end[axis] = low[axis] - beyond, high[axis] + beyond
    met, lengths, longest, at_mm = 0, [], 0.0, np.zeros(3)
    for row in rows.tolist():
        for column in columns.tolist():
            start[[first, second]] = end[[first, second]] = row, column
            cuts = _cuts(body, start, end, axis)
            if not len(cuts):  # it misses the web
                lengths.append([0.0, 0.0])
                continue
            met += 1
            found = _voids_mm(cuts, _cuts(filled, start, end, axis), way.parting_mm)
            lengths.append([float(np.abs(np.diff(side)).sum()) for side in found])
            if max(lengths[-1]) > longest:
                longest, at_mm = max(lengths[-1]), start.copy()
                at_mm[axis] = _middle_of_longest(np.concatenate(found))
    return met, np.array(lengths).reshape(-1, 2), area, _point(at_mm)


def _beyond_mills(
    body: Manifold, filled: Manifold, web: SurfaceMesh, scene: Scene, way: Withdrawal, step_mm: float
) -> _Voids:
    """Return the same of voxels that no straight line from a face or a side reaches, by lines along x."""
    low, high = web.vertices_mm.min(axis=0), web.vertices_mm.max(axis=0)
    x, y, z = (_centres(low[axis], high[axis], step_mm) for axis in (X, Y, Z))
    solid, whole = (_voxels(part, x, y, z) for part in (body, filled))
    faces = [np.hypot(x[:, None], y[None, :] - centre) < j.radius_mm for j, centre in scene.throw.journals]
    blocked = np.concatenate([faces[0][:, :, None], solid, faces[1][:, :, None]], axis=2)
    reached = np.zeros_like(blocked)
    for axis in (X, Z):
        for way_in in (slice(None), slice(None, None, -1)):
            moved = np.moveaxis(blocked, axis, 0)[way_in]
            found = ~np.logical_or.accumulate(moved, axis=0)
            reached |= np.moveaxis(found[way_in], 0, axis)
    left = ~whole & ~reached[:, :, 1:-1]
    lengths = left.sum(axis=X) * float(x[1] - x[0])
    row, column = np.unravel_index(lengths.argmax(), lengths.shape)
    at_mm = np.array([x[left[:, row, column].argmax()], y[row], z[column]])
    area = float((y[1] - y[0]) * (z[1] - z[0]))
    return int(solid.any(axis=X).sum()), lengths.reshape(-1, 1), area, _point(at_mm)


def _voxels(body: Manifold, x: Array, y: Array, z: Array) -> NDArray[np.bool_]:
    from skimage.draw import polygon2mask

    inside = np.zeros((len(x), len(y), len(z)), dtype=bool)
    origin, step = np.array([x[0], y[0]]), np.array([x[1] - x[0], y[1] - y[0]])
    for layer, height in enumerate(z.tolist()):
        for contour in body.slice(height).to_polygons():
            inside[:, :, layer] ^= polygon2mask(inside.shape[:2], (contour - origin) / step)
    return inside


def _centres(low: float, high: float, step: float) -> Array:
    """Middles of at least two equal steps between two ends; off the round numbers that faces lie on."""
    count = max(2, round((high - low) / step))
    return np.asarray(low + (high - low) / count * (np.arange(count) + 0.5), dtype=np.float64)


def _cuts(body: Manifold, start: Array, end: Array, axis: int) -> Array:
    return np.array([hit.position[axis] for hit in body.ray_cast(tuple(start), tuple(end))])


def _voids_mm(cuts: Array, within: Array, parting_mm: float | None) -> tuple[Array, Array]:
    """Voids (n, 2) on both sides of the parting plane, or between the outermost solids and none.

    The web with its holes filled is entered and left at `within`: holes count as solid only within the web.
    """
    if parting_mm is not None:
        cuts, within = cuts - parting_mm, within - parting_mm
        return _beyond_mm(cuts, within) + parting_mm, parting_mm - _beyond_mm(-cuts[::-1], -within[::-1])
    return _beyond_mm(cuts - cuts[0], within - cuts[0]) + cuts[0], np.zeros((0, 2))


def _beyond_mm(cuts: Array, within: Array) -> Array:
    """Voids (n, 2) between 0 and the outermost solid."""
    if len(cuts) % 2 or len(within) % 2:  # grazes an edge
        return np.zeros((0, 2))
    outermost = float(cuts.max(initial=0.0))
    return np.concatenate([[0.0], within.clip(min=0.0, max=outermost), [outermost]]).reshape(-1, 2)


def _middle_of_longest(voids: Array) -> float:
    return float(voids[np.abs(np.diff(voids)).argmax()].mean())


def _point(at_mm: Array) -> tuple[float, float, float]:
    x, y, z = map(float, at_mm)
    return x, y, z
