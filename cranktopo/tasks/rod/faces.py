"""Faces of the rod that a search may move, as zero sets of distances, and the mesh that follows them.

Both bores stand still, and of the bolts' holes what is in the cap: pressures and bolts' masses act there.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.design.checks.rod import rod_of
from cranktopo.design.rod import EYES, Rod
from cranktopo.design.rod_body import fillet
from cranktopo.design.rod_split import in_split
from cranktopo.design.schema import Scene
from cranktopo.numerics.optimisers.gradient_search import central_difference
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.numerics.tetrahedra.moved_mesh import MovedMesh
from cranktopo.numerics.tetrahedra.moving_faces import STEP, Contact, MovingFace, contact_of
from cranktopo.tasks.rod.bolt_load import in_cap_hole
from cranktopo.tasks.rod.unit_loads import on_bore

_Distance = Callable[[Rod, float, Array], Array]
"""Of a rod of a length and points (3, n), mm; zero on the face."""
_BESIDE_MM = 1e-3
_FAR_MM = 1e3


@dataclass(frozen=True)
class RodFace(MovingFace):
    """A face of a rod whose dimensions of some names are parameters, mm."""

    rod: Rod
    length_mm: float
    names: tuple[str, ...]
    distance_mm: _Distance
    seam: bool = False

    @override
    def contact(self, points_mm: Array, values: Array) -> Contact:
        return contact_of(partial(self.distance_mm, self._rod(values), self.length_mm), points_mm)

    @override
    def gradients(self, points_mm: Array, values: Array) -> Array:
        def distance(values: Array) -> Array:
            return self.distance_mm(self._rod(values), self.length_mm, points_mm)

        return central_difference(distance, values, STEP)

    def _rod(self, values: Array) -> Rod:
        return self.rod.model_copy(update=dict(zip(self.names, map(float, values), strict=True)))


def moved_rod(mesh: TetMesh, scene: Scene, names: Sequence[str]) -> MovedMesh:
    """Return a mesh of a design's rod that follows dimensions of some names, mm.

    Raises:
        CranktopoError: part of the surface belongs to none of its faces.
    """
    rod, length = rod_of(scene)
    faces = [
        RodFace(rod, length, tuple(names), distance, seam) for distance, seam in _faces(rod, mesh.mirrored)
    ]
    values = np.array([getattr(rod, name) for name in names])
    return MovedMesh(mesh, faces, values, partial(_stands, scene, rod), "rod")


def _stands(scene: Scene, rod: Rod, points_mm: Array) -> NDArray[np.bool_]:
    corners = points_mm[:, :3].reshape(3, -1)
    found = [on_bore(scene, eye, corners) for eye in EYES]
    found += [in_cap_hole(rod, corners)] if rod.bolt_hole_mm else []
    return np.asarray(np.any([one.reshape(3, -1).all(axis=0) for one in found], axis=0))


def _faces(rod: Rod, mirrored: bool) -> Iterator[tuple[_Distance, bool]]:
    """Yield the distance from each face, and whether it is a seam of the one before."""
    plain: list[_Distance] = [lambda rod, length, at: at[2]]
    plain += [lambda rod, length, at: at[0]] if mirrored else []
    plain += [_off_small_end, _off_big_end, _above_small_end, _above_big_end, _above_shank, _off_flank]
    plain += _POCKETS[rod.shank]
    plain += [_off_boss_side, _off_boss_top, _off_boss_bottom]
    plain += [_off_bolt] if rod.bolt_hole_mm else []
    plain += [_off_oil_hole] if rod.oil_hole_mm else []
    yield from ((distance, False) for distance in plain)
    for small in (False, True) if rod.shank_fillet_mm else ():
        yield partial(_off_fillet, small), False
        yield partial(_beyond_edge, small), True
        yield partial(_beside_eye, small), True


def _off_small_end(rod: Rod, length: float, at: Array) -> Array:
    return np.asarray(np.hypot(at[0], at[1] - length) - rod.small_end_diameter_mm / 2)


def _off_big_end(rod: Rod, _: float, at: Array) -> Array:
    return np.asarray(np.hypot(at[0], at[1]) - rod.big_end_diameter_mm / 2)


def _above_small_end(rod: Rod, length: float, at: Array) -> Array:
    beyond = _off_small_end(rod, length, at) > _BESIDE_MM
    return np.asarray(at[2] - rod.small_end_width_mm / 2 + _FAR_MM * beyond)


def _above_big_end(rod: Rod, length: float, at: Array) -> Array:
    beyond = (_off_big_end(rod, length, at) > _BESIDE_MM) & (_off_boss(rod, at) > _BESIDE_MM)
    return np.asarray(at[2] - rod.big_end_width_mm / 2 + _FAR_MM * beyond)


def _above_shank(rod: Rod, length: float, at: Array) -> Array:
    """Without what lies within a higher or lower end; faces of one height are one face, triangles across."""
    small = _off_small_end(rod, length, at)
    big = np.minimum(_off_big_end(rod, length, at), _off_boss(rod, at))
    within = np.zeros(at[2].shape, dtype=bool)
    for distance, width in ((small, rod.small_end_width_mm), (big, rod.big_end_width_mm)):
        if abs(width - rod.shank_width_mm) > _BESIDE_MM:
            within |= distance < -_BESIDE_MM
    return np.asarray(at[2] - rod.shank_width_mm / 2 + _FAR_MM * within)


def _half_height(rod: Rod, length: float, y: Array) -> tuple[Array, float]:
    """Half the height of the shank without its fillets, and how much longer its edge is than the rod."""
    slope = (rod.shank_small_mm - rod.shank_big_mm) / 2 / length
    return rod.shank_big_mm / 2 + slope * y, math.hypot(1, slope)


def _off_flank(rod: Rod, length: float, at: Array) -> Array:
    half, stretch = _half_height(rod, length, at[1])
    return np.asarray((np.abs(at[0]) - half) / stretch)


def _off_flange(rod: Rod, length: float, at: Array) -> Array:
    half, stretch = _half_height(rod, length, at[1])
    return np.asarray((np.abs(at[0]) - half + rod.flange_mm) / stretch)


def _above_web(rod: Rod, _: float, at: Array) -> Array:
    return np.asarray(at[2] - rod.web_mm / 2)


def _off_web(rod: Rod, _: float, at: Array) -> Array:
    return np.asarray(np.abs(at[0]) - rod.web_mm / 2)


def _below_flange(rod: Rod, _: float, at: Array) -> Array:
    return np.asarray(at[2] - rod.shank_width_mm / 2 + rod.flange_mm)


def _off_boss(rod: Rod, at: Array) -> Array:
    """Distance from the box of the bosses in the plane of motion, negative inside."""
    u, v = in_split(rod, at[0], at[1])
    across = np.abs(u) - rod.boss_width_mm / 2
    return np.asarray(np.max([across, v - rod.boss_above_mm, -v - rod.boss_below_mm], axis=0))


def _off_boss_side(rod: Rod, _: float, at: Array) -> Array:
    return np.asarray(np.abs(in_split(rod, at[0], at[1])[0]) - rod.boss_width_mm / 2)


def _off_boss_top(rod: Rod, _: float, at: Array) -> Array:
    return np.asarray(in_split(rod, at[0], at[1])[1] - rod.boss_above_mm)


def _off_boss_bottom(rod: Rod, _: float, at: Array) -> Array:
    return np.asarray(in_split(rod, at[0], at[1])[1] + rod.boss_below_mm)


def _off_bolt(rod: Rod, _: float, at: Array) -> Array:
    u, _v = in_split(rod, at[0], at[1])
    return np.asarray(np.hypot(np.abs(u) - rod.bolt_distance_mm / 2, at[2]) - rod.bolt_hole_mm / 2)


def _off_oil_hole(rod: Rod, _: float, at: Array) -> Array:
    return np.asarray(np.hypot(at[0], at[2]) - rod.oil_hole_mm / 2)


_POCKETS: dict[str, list[_Distance]] = {
    "I": [_above_web, _off_flange],
    "H": [_off_web, _below_flange],
    "plain": [],
}
"""Faces of the pockets by the section of the shank."""


def _off_fillet(small: bool, rod: Rod, length: float, at: Array) -> Array:
    arc = fillet(rod, length, small)
    assert arc is not None
    return np.asarray(rod.shank_fillet_mm - np.hypot(np.abs(at[0]) - arc.x_mm, at[1] - arc.y_mm))


def _beyond_edge(small: bool, rod: Rod, length: float, at: Array) -> Array:
    """Distance along the shank from where a fillet leaves its edge."""
    arc = fillet(rod, length, small)
    assert arc is not None
    half, stretch = _half_height(rod, length, np.array(arc.edge_y_mm))
    slope = (rod.shank_small_mm - rod.shank_big_mm) / 2 / length
    return np.asarray((slope * (np.abs(at[0]) - half) + at[1] - arc.edge_y_mm) / stretch)


def _beside_eye(small: bool, rod: Rod, length: float, at: Array) -> Array:
    """Distance across the line from an eye's axis to where a fillet leaves the eye."""
    arc, axis = fillet(rod, length, small), length if small else 0.0
    assert arc is not None
    x, y = arc.x_mm, arc.y_mm - axis
    return np.asarray((np.abs(at[0]) * y - (at[1] - axis) * x) / math.hypot(x, y))
