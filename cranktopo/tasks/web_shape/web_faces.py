"""The faces that bound a parametric web, as zero sets of distances smooth in place and parameters."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.design.free_dimensions import DimensionName, move_journals
from cranktopo.design.schema import Scene
from cranktopo.numerics.optimisers.gradient_search import central_difference, complex_step
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.numerics.tetrahedra.moved_mesh import MovedMesh
from cranktopo.numerics.tetrahedra.moving_faces import STEP, Contact, MovingFace, contact_of
from cranktopo.tasks.refit.family import Layout, flank_of, scene_at
from cranktopo.tasks.refit.model_fill import MovedFillet, moved_fillet
from cranktopo.tasks.web_shape.throw_faces import FilletFace, ThrowFace, off_fillet, sector_of, throw_faces
from cranktopo.throw.counterweight.tangent_circle import flank_directions
from cranktopo.throw.fitted import FittedFeature
from cranktopo.throw.profile import Flank

_SAMPLES = 24
"""Places per piece of the outline among which the search for the nearest begins."""
_NEWTON = 12
_OUTSIDE_MM = 1e-6
"""Height beyond the web's faces at which a point still counts as on them."""
_THICKNESS: DimensionName = "web_thickness"


@dataclass(frozen=True)
class _FeatureFace(MovingFace):
    """A face or a seam of a feature, whose first value has the place `first` among all."""

    scene: Scene
    layout: Layout
    part: FittedFeature
    number: int
    first: int
    seam: bool = False

    @override
    def contact(self, points_mm: Array, values: Array) -> Contact:
        return contact_of(partial(self._distance, values, self._web_z_mm(values)), points_mm)

    @override
    def gradients(self, points_mm: Array, values: Array) -> Array:
        own = range(self.first, self.first + len(self.part.names))
        ends = [0, 1] if self.part.follows_ends else []
        thickness = [k for k, name in enumerate(self.layout.names) if name == _THICKNESS]
        return central_difference(
            lambda moved: self._distance(moved, self._web_z_mm(moved), points_mm),
            values,
            STEP,
            [*own, *ends, *thickness],
        )

    def _web_z_mm(self, values: Array) -> tuple[float, float]:
        moves = _THICKNESS in self.layout.dimensions
        return (scene_at(self.scene, self.layout, values) if moves else self.scene).web_z_mm

    def _distance(self, values: Array, web_z_mm: tuple[float, float], points_mm: Array) -> Array:
        named = self.part.named(values[self.first : self.first + len(self.part.names)])
        x, y, z = points_mm
        at = np.abs(x), y, z
        seams, faces = self.part.seams_mm, self.part.faces_mm
        found = seams(named, at, web_z_mm) if self.seam else faces(named, values[:2], at, web_z_mm)
        distance = found[self.number]
        return np.asarray(np.broadcast_to(distance, x.shape))


@dataclass(frozen=True)
class _FilletedFlank(MovingFace):
    """Flank of a counterweight and the fillet it ends in, one smooth face; distances positive inside."""

    scene: Scene
    layout: Layout

    @override
    def contact(self, points_mm: Array, values: Array) -> Contact:
        return contact_of(partial(self._distance, self._fillet(values)), points_mm)

    @override
    def gradients(self, points_mm: Array, values: Array) -> Array:
        fillet, first = self._fillet(values), len(values) - len(self.layout.dimensions)
        by_flank = central_difference(
            lambda moved: sector_of(scene_at(self.scene, self.layout, moved)).inside_flank_mm(*points_mm[:2]),
            values,
            STEP,
            range(first, len(values)),
        )
        out = np.stack(fillet.circle.outward(*points_mm[:2]), axis=1)
        on_flank = self._on_flank(fillet, points_mm)
        return np.where(on_flank[:, None], by_flank, -out @ fillet.gradients)

    def _fillet(self, values: Array) -> MovedFillet:
        fillet = moved_fillet(self.scene, self.layout, values)
        assert fillet is not None
        return fillet

    def _distance(self, fillet: MovedFillet, at: Array) -> Array:
        flank = fillet.sector.inside_flank_mm(at[0], at[1])
        return np.where(self._on_flank(fillet, at), flank, fillet.circle.off_mm(at[0], at[1]))

    def _on_flank(self, fillet: MovedFillet, at: Array) -> NDArray[np.bool_]:
        """Tell whether points lie farther along the flank than the place where the fillet leaves it."""
        (sine, cosine), _ = flank_directions(fillet.sector.half_angle)
        return np.asarray(np.abs(at[0]) * sine + at[1] * cosine >= fillet.circle.reach_mm)


@dataclass(frozen=True)
class _OutlineFace(MovingFace):
    """The outline, swept along the crank axis; distances positive inside."""

    layout: Layout

    @override
    def contact(self, points_mm: Array, values: Array) -> Contact:
        (piece, u), normal = self._foot(points_mm, values)
        at = np.stack([np.abs(points_mm[0]), points_mm[1]], axis=1)
        distance = ((_point(flank_of(self.layout, values), piece, u, 0) - at) * normal).sum(axis=1)
        side = np.where(points_mm[0] < 0, -1.0, 1.0)
        return Contact(distance, np.stack([-side * normal[:, 0], -normal[:, 1], np.zeros(len(at))], axis=1))

    @override
    def gradients(self, points_mm: Array, values: Array) -> Array:
        (piece, u), normal = self._foot(points_mm, values)
        stations, rest = np.split(values, [self.layout.stations])
        moved = complex_step(lambda own: _point(flank_of(self.layout, own), piece, u, 0), stations)
        return np.hstack([(moved * normal[:, :, None]).sum(axis=1), np.zeros((len(u), len(rest)))])

    def _foot(self, points_mm: Array, values: Array) -> tuple[tuple[NDArray[np.intp], Array], Array]:
        """Return the nearest piece of the right half, the place on it, and the outward normal, (n, 2)."""
        flank = flank_of(self.layout, values)
        foot = _nearest(flank, np.stack([np.abs(points_mm[0]), points_mm[1]], axis=1))
        tangent = _point(flank, *foot, 1)
        across = np.stack([tangent[:, 1], -tangent[:, 0]], axis=1)
        return foot, across / np.linalg.norm(tangent, axis=1)[:, None]


def web_faces(scene: Scene, layout: Layout, *, mirrored: bool) -> list[MovingFace]:
    """Return all faces of the web of a layout: those of the throw, its outline, those of its features.

    With free dimensions of the journals theirs and those of their fillets as well; of a mirrored model the
    plane x = 0.
    """
    moving, weight = move_journals(layout.dimensions), scene.web.counterweight
    throw = [ThrowFace(scene, layout, distance) for distance in throw_faces(scene, mirrored, moving)]
    fillets = [
        FilletFace(scene, layout, partial(off_fillet, k), k)
        for k, (journal, _) in enumerate(scene.throw.journals)
        if (moving and journal.fillet_mm) or journal.recess_mm  # the rest lies beyond the web
    ]
    flanks = [_FilletedFlank(scene, layout)] if weight is not None and weight.fillet_mm else []
    return [*throw, *fillets, *flanks, _OutlineFace(layout), *_feature_faces(scene, layout)]


def moved_web(mesh: TetMesh, scene: Scene, layout: Layout, values: Array) -> MovedMesh:
    """Return a mesh of a throw that follows its web; journals and their fillets stand still.

    With free dimensions of the throw their faces are followed too.

    Raises:
        CranktopoError: part of the web's surface belongs to none of its faces.
    """
    low, high = (-np.inf, np.inf) if move_journals(layout.dimensions) else scene.web_z_mm

    def beyond(points_mm: Array) -> NDArray[np.bool_]:
        z = points_mm[2, :3]
        return np.asarray((z.min(axis=0) < low - _OUTSIDE_MM) | (z.max(axis=0) > high + _OUTSIDE_MM))

    faces = web_faces(scene, layout, mirrored=mesh.mirrored)
    return MovedMesh(mesh, faces, values, beyond, "web")


def _feature_faces(scene: Scene, layout: Layout) -> Iterator[MovingFace]:
    first = layout.stations
    one = (np.ones(1),) * 3
    for part in layout.parts:
        named = part.named(np.ones(len(part.names)))
        count = len(part.faces_mm(named, np.array([-1.0, 9.0]), one, scene.web_z_mm))
        for number in range(count):
            yield _FeatureFace(scene, layout, part, number, first)
        for number in range(len(part.seams_mm(named, one, scene.web_z_mm))):
            yield _FeatureFace(scene, layout, part, number, first, seam=True)
        first += len(part.names)


def _nearest(flank: Flank, at: Array) -> tuple[NDArray[np.intp], Array]:
    """Return piece of the flank and place on it, 0 to 1, nearest to points (n, 2)."""
    from scipy.spatial import cKDTree

    u = (np.arange(_SAMPLES) + 0.5) / _SAMPLES
    _, found = cKDTree(flank.at(u).reshape(-1, 2)).query(at)
    piece, place = found // _SAMPLES, u[found % _SAMPLES]
    for _ in range(_NEWTON):
        gap = _point(flank, piece, place, 0) - at
        first, second = _point(flank, piece, place, 1), _point(flank, piece, place, 2)
        bend = (first * first).sum(axis=1)
        curvature = np.maximum(bend + (gap * second).sum(axis=1), bend / 2)
        place = np.clip(place - (gap * first).sum(axis=1) / curvature, 0.0, 1.0)
    return piece, place


def _point(flank: Flank, piece: NDArray[np.intp], u: Array, order: int) -> Array:
    """Return points at u of chosen pieces, (n, 2), or their derivatives of an order by u."""
    length = flank.lengths_mm[piece][:, None]
    start, end = flank.points_mm[piece], flank.points_mm[piece + 1]
    leave, arrive = flank.slopes[piece] * length, flank.slopes[piece + 1] * length
    cubic = (start, leave, 3 * (end - start) - 2 * leave - arrive, leave + arrive - 2 * (end - start))
    t = u[:, None]
    if order == 0:
        return np.asarray(cubic[0] + t * (cubic[1] + t * (cubic[2] + t * cubic[3])))
    if order == 1:
        return np.asarray(cubic[1] + t * (2 * cubic[2] + 3 * t * cubic[3]))
    return np.asarray(2 * cubic[2] + 6 * t * cubic[3])
