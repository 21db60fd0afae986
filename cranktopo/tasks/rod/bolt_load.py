"""The cap's bolts on elements of the rod: mass, and preload below heads and in threads or below nuts.

Rod and cap are one body: that holds as long as the split stays closed, see `split_stress`. Bolts have no
stiffness here, so the body carries all of a load of which they would take a share.
"""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.units import KG_PER_TONNE
from cranktopo.design.rod import Rod, RodBolt
from cranktopo.design.rod_fitted import bolts_kg
from cranktopo.design.rod_split import in_rod, in_split
from cranktopo.numerics.tetrahedra.elasticity import Elasticity
from cranktopo.numerics.tetrahedra.even_traction import EvenTraction, Share, Where, even_traction
from cranktopo.numerics.tetrahedra.surface_loads import face_shares, faces_where
from cranktopo.tasks.bolts.joint import mean_preload_N

_ON_MM = 1e-5
"""Distance of nodes from a face that they lie on; from a hole over its size."""
_RIM = 0.2
"""Width of the rim in which a load falls to zero, over that of the seat or the length of the thread."""


def preload_N(rod: Rod) -> float:
    """Return the mean preload of each of the two bolts; 0 without bolts."""
    return mean_preload_N(rod.bolt) if rod.bolt else 0.0


def preload_tractions(rod: Rod, model: Elasticity) -> list[tuple[float, EvenTraction]]:
    """Return what 1 N in each bolt puts on a model of the rod, each with its size, N; none without bolts.

    Even below the head and below a nut; as even shear on the hole along an engaged thread.
    """
    bolt = rod.bolt
    if bolt is None:
        return []
    toward_rod = np.array([*np.ravel(in_rod(rod, np.zeros(1), np.ones(1))), 0.0])
    found = []
    for side in (1,) if model.nodes_mm[0].min() > -_ON_MM else (-1, 1):
        for size, (faces, share) in ((0.5, _below_head(rod, bolt)), (-0.5, _held(rod, bolt))):
            beside = partial(_on_side, rod, side, faces)
            found.append((size, even_traction(model, toward_rod, beside, share)))
    return found


def bolt_masses(rod: Rod, model: Elasticity) -> Array:
    """Return the mass of the rod's bolts on the nodes of a model of it, (nodes,), tonne.

    The cap's holes have all of it: with their heads below the cap, bolts have their centre of mass there.
    """
    if rod.bolt is None:
        return np.zeros(model.nodes_mm.shape[1])
    cap = faces_where(model, partial(in_cap_hole, rod))
    return face_shares(model, cap) * bolts_kg(rod) / KG_PER_TONNE


def in_cap_hole(rod: Rod, points_mm: Array) -> NDArray[np.bool_]:
    """Tell which points (3, n) lie on the holes of the bolts in the cap."""
    u, v = in_split(rod, points_mm[0], points_mm[1])
    away = np.hypot(np.abs(u) - rod.bolt_distance_mm / 2, points_mm[2]) / (rod.bolt_hole_mm / 2) - 1
    return np.asarray((v <= 0) & (np.abs(away) < _ON_MM))


def near_bolts(rod: Rod, points_mm: Array, distance_mm: float) -> NDArray[np.bool_]:
    """Tell which points (3, n) lie at a head, nut or engaged thread, or nearer to one than a distance."""
    bolt = rod.bolt
    if bolt is None:
        return np.zeros(points_mm.shape[1], dtype=bool)
    away, v = _from_axis(rod, points_mm)
    at_seat, at_hole = (away <= size / 2 + distance_mm for size in (bolt.head_mm, bolt.hole_mm))
    held = at_seat if bolt.held_in == "nut" else at_hole
    below = at_seat & (v <= distance_mm - rod.boss_below_mm)
    return np.asarray(below | (held & (v >= bolt.grip_mm - rod.boss_below_mm - distance_mm)))


def at_split(rod: Rod, points_mm: Array, distance_mm: float) -> NDArray[np.bool_]:
    """Tell which points (3, n) of the surface are nearer to the faces of the split than a distance."""
    u, v = in_split(rod, points_mm[0], points_mm[1])
    outer = max(rod.big_end_diameter_mm, rod.boss_width_mm) / 2
    return np.asarray((np.abs(v) <= distance_mm) & (np.abs(u) <= outer + distance_mm))


def split_stress(rod: Rod, stress_MPa: Array) -> Array:
    """Return the normal stress across the split of stresses (..., 6); pressure is negative."""
    x, y = np.ravel(in_rod(rod, np.zeros(1), np.ones(1)))
    return np.asarray(x**2 * stress_MPa[..., 0] + y**2 * stress_MPa[..., 1] + 2 * x * y * stress_MPa[..., 3])


def _below_head(rod: Rod, bolt: RodBolt) -> tuple[Where, Share]:
    """Faces that a head lies on, and the part of them below it."""
    return partial(_at_height, rod, -rod.boss_below_mm), partial(_in_seat, rod, bolt)


def _held(rod: Rod, bolt: RodBolt) -> tuple[Where, Share]:
    """Faces that hold a bolt's other end, and the part of them below the nut or along the engaged thread."""
    if bolt.held_in == "nut":
        return partial(_at_height, rod, rod.boss_above_mm), partial(_in_seat, rod, bolt)
    return partial(_on_hole, rod, bolt), partial(_engaged, rod, bolt)


def _on_side(rod: Rod, side: int, faces: Where, points: Array) -> NDArray[np.bool_]:
    return np.asarray(faces(points) & (side * in_split(rod, points[0], points[1])[0] > 0))


def _at_height(rod: Rod, v_mm: float, points: Array) -> NDArray[np.bool_]:
    return np.asarray(np.abs(_from_axis(rod, points)[1] - v_mm) < _ON_MM)


def _on_hole(rod: Rod, bolt: RodBolt, points: Array) -> NDArray[np.bool_]:
    return np.asarray(np.abs(_from_axis(rod, points)[0] - bolt.hole_mm / 2) < _ON_MM * bolt.hole_mm)


def _in_seat(rod: Rod, bolt: RodBolt, points: Array) -> Array:
    """Share of the pressure of a head or nut, falling to zero about its rim."""
    within = bolt.head_mm / 2 - _from_axis(rod, points)[0]
    return _ramp(within / (_RIM * (bolt.head_mm - bolt.hole_mm) / 2))


def _engaged(rod: Rod, bolt: RodBolt, points: Array) -> Array:
    """Share of the shear of an engaged thread, falling to zero about its ends."""
    along = _from_axis(rod, points)[1] - (bolt.grip_mm - rod.boss_below_mm)
    return _ramp(np.minimum(along, bolt.engaged_mm - along) / (_RIM * bolt.engaged_mm))


def _ramp(inside: Array) -> Array:
    return np.clip(inside + 0.5, 0.0, 1.0)


def _from_axis(rod: Rod, points: Array) -> tuple[Array, Array]:
    """Distance of points (3, ...) from the axis of their side's bolt, and place along it from the split."""
    u, v = in_split(rod, points[0], points[1])
    return np.hypot(np.abs(u) - rod.bolt_distance_mm / 2, points[2]), v
