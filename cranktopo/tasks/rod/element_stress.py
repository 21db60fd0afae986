"""Stresses of the rod by finite elements over the cycle: the worst point of each place, and its safeties."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Index
from cranktopo.design.rod_body import RodMass, fillet, rod_mass
from cranktopo.design.rod_fitted import bush_kg
from cranktopo.design.rod_split import in_split
from cranktopo.engine.rod_forces import RodMotion
from cranktopo.numerics.tetrahedra.sharp_edges import from_sharp_edges_mm
from cranktopo.numerics.tetrahedra.stress import Surface
from cranktopo.numerics.tetrahedra.unit_stress import UnitStress
from cranktopo.tasks.fatigue.criteria import criterion
from cranktopo.tasks.fatigue.criterion import LocalStress
from cranktopo.tasks.fatigue.superposition import SIGNED, TENSOR
from cranktopo.tasks.rod.bolt_load import near_bolts, preload_N
from cranktopo.tasks.rod.eye import bush_pressure_MPa
from cranktopo.tasks.rod.unit_fields import RodFields
from cranktopo.tasks.rod.unit_loads import ACROSS, ALONG, is_quarter, rod_material

PLACES = ("small end", "eye to shank", "mid-shank", "shank to big end", "big end", "cap")
_AT_ONCE = 3
"""Fields whose stresses are held in all elements at a time."""
_FROM_BOLTS = 1.5
"""Distance from seats and threads of bolts over that from edges; nearer, stresses depend on the mesh."""
_STEP_DEG = 1.0
"""Crank angle between the states that are judged: half of it off its peak, a pressure is 1e-4 lower."""
_BEYOND = 1 + 1e-6
"""Points of an eye's outer face over its radius."""


@dataclass(frozen=True)
class WorstPoint:
    """A point of the surface: its stress over the cycle, and its safety.

    Attributes:
        high_MPa, low_MPa: von Mises stress with the sign of the first invariant.
        amplitude_MPa, mean_MPa, gradient_per_mm: of the tensors between the ends of the swing.
    """

    point_mm: tuple[float, float, float]
    high_MPa: float
    low_MPa: float
    amplitude_MPa: float
    mean_MPa: float
    gradient_per_mm: float
    fatigue_safety: float

    @property
    def largest_MPa(self) -> float:
        """Return the largest von Mises stress."""
        return max(abs(self.high_MPa), abs(self.low_MPa))


def cycle_states(fields: RodFields, motions: Sequence[RodMotion]) -> Array:
    """Return the factors of the unit loads in every state of a rod's cycles, (states, loads)."""
    mass = rod_mass(fields.rod, fields.length_mm, fields.scene.material)
    return cycle_loads(fields, mass, motions, bush_pressure_MPa(fields.rod, rod_material(fields.scene)))


def image_cycles(loads: Array) -> tuple[Array, Array]:
    """Return the states (..., loads) of the nodes, and of their images x < 0 or in the rod turned around."""
    across = np.array([name in ACROSS for name in (*ALONG, *ACROSS)])
    return loads, loads * np.where(across, -1.0, 1.0)


def cycle_loads(
    fields: RodFields, mass: RodMass, motions: Sequence[RodMotion], bush_pressure_MPa: float
) -> Array:
    """Return the factors of the unit loads in every state, (states, loads), speed by speed.

    The big end's bore carries what the small end's does less the inertia between both; bush and shells
    are beyond the bores.
    """
    return np.concatenate([_loads(fields, mass, one, bush_pressure_MPa) for one in motions])


def _loads(fields: RodFields, mass: RodMass, motion: RodMotion, bush_pressure_MPa: float) -> Array:
    small = motion.small_end_push_N(mass, fields.length_mm) - bush_kg(fields.rod) * motion.small_along_m_s2
    by_small, by_big = fields.inertia_kg
    big = small - by_small * motion.small_along_m_s2 - by_big * motion.big_along_m_s2
    factors = {
        "small push": np.maximum(small, 0.0),
        "small pull": np.maximum(-small, 0.0),
        "big push": np.maximum(big, 0.0),
        "big pull": np.maximum(-big, 0.0),
        "small inertia": motion.small_along_m_s2,
        "big inertia": motion.big_along_m_s2,
        "press fit": np.full_like(small, bush_pressure_MPa),
        "preload": np.full_like(small, preload_N(fields.rod)),
        "small whip": motion.small_m_s2,
        "big whip": motion.big_m_s2,
    }
    every = max(round(_STEP_DEG / float(motion.angle_deg[1] - motion.angle_deg[0])), 1)
    return np.stack([factors[name] for name in (*ALONG, *ACROSS)], axis=1)[::every]


@dataclass(frozen=True)
class ElementStress:
    """The cycle on the surface of a model of the rod; arrays (2, n).

    The first row is that of the nodes; the second is that of their images x < 0 of a quarter, or of the nodes
    of a half in the rod mounted the other way round.

    Attributes:
        unit: stresses of the unit loads.
        high_MPa, low_MPa: signed von Mises stress.
        swing: stress that fatigue is judged by, of either row.
        edge_distance_mm: distance from sharp inner edges and bolts from which nodes are judged.
    """

    fields: RodFields
    unit: UnitStress
    high_MPa: Array
    low_MPa: Array
    swing: tuple[LocalStress, LocalStress]
    fatigue_safety: Array
    edge_distance_mm: float

    @property
    def largest_MPa(self) -> Array:
        """Return the largest von Mises stress of every node."""
        return np.maximum(np.abs(self.high_MPa), np.abs(self.low_MPa))

    @property
    def surface(self) -> Surface:
        """Return the surface of the model."""
        return self.unit.surface

    @cached_property
    def judged(self) -> NDArray[np.bool_]:
        """Nodes (n,) far enough from sharp edges and from the seats and threads of bolts."""
        away = _FROM_BOLTS * self.edge_distance_mm
        at_bolts = near_bolts(self.fields.rod, self.surface.points_mm, away)
        return np.asarray(~self._at_sharp & ~at_bolts)

    @cached_property
    def _at_sharp(self) -> NDArray[np.bool_]:
        """Nodes (n,) near sharp inner edges, where the mesh decides the stress."""
        return from_sharp_edges_mm(self.surface) < self.edge_distance_mm

    def worst(self) -> Iterator[tuple[str, WorstPoint, WorstPoint]]:
        """Yield each place with its point of largest stress and its point of least fatigue safety."""
        place = place_of(self.fields, self.surface.points_mm)
        for number, name in enumerate(PLACES):
            here = self.judged & (place == number)
            if here.any():
                yield name, self._point(-self.largest_MPa, here), self._point(self.fatigue_safety, here)

    def at_sharp_edges(self) -> WorstPoint | None:
        """Return the point of largest stress near sharp inner edges; None where there is none."""
        return self._point(-self.largest_MPa, self._at_sharp) if self._at_sharp.any() else None

    def _point(self, values: Array, among: NDArray[np.bool_]) -> WorstPoint:
        row, node = np.unravel_index(int(np.where(among, values, np.inf).argmin()), values.shape)
        x, y, z = (float(c) for c in self.surface.points_mm[:, node])
        extremes, swing = (self.high_MPa[row], self.low_MPa[row]), self.swing[row]
        found = (
            *extremes,
            swing.amplitude_MPa,
            swing.mean_MPa,
            swing.gradient_per_mm,
            self.fatigue_safety[row],
        )
        image = row and is_quarter(self.fields.model)
        return WorstPoint((-x if image else x, y, z), *(float(values[node]) for values in found))


def element_stress(fields: RodFields, loads: Array, method: str, edge_distance_mm: float) -> ElementStress:
    """Return the stresses of a rod over the states of its cycle, and their safety by a fatigue method."""
    found, cycles = unit_stress(fields), image_cycles(loads)
    signed = [one.local for one in SIGNED.ranges(found.stress, cycles)]
    first, second = (one.local for one in TENSOR.ranges(found.stress, cycles))
    return ElementStress(
        fields,
        found,
        np.stack([one.mean_MPa + one.amplitude_MPa for one in signed]),
        np.stack([one.mean_MPa - one.amplitude_MPa for one in signed]),
        (first, second),
        np.stack([criterion(method).point_safety(fields.scene, one).safety for one in (first, second)]),
        edge_distance_mm,
    )


def unit_stress(fields: RodFields) -> UnitStress:
    """Return the stresses of the unit loads on the surface of the model."""
    planes = ((0, 0.0), (2, 0.0)) if is_quarter(fields.model) else ((2, 0.0),)
    return UnitStress(fields.model, fields.displacement_mm, fields.elastic, planes, _AT_ONCE)


def place_of(fields: RodFields, points_mm: Array) -> Index:
    """Return for points (3, n) of the rod which of `PLACES` they belong to."""
    rod, length = fields.rod, fields.length_mm
    x, y, _ = points_mm
    u, v = in_split(rod, x, y)
    arcs = [fillet(rod, length, small) for small in (True, False)]
    top = arcs[0].edge_y_mm if arcs[0] else length - (rod.small_end_diameter_mm + rod.shank_small_mm) / 2
    bottom = arcs[1].edge_y_mm if arcs[1] else (rod.big_end_diameter_mm + rod.shank_big_mm) / 2
    in_small = np.hypot(x, y - length) <= _BEYOND * rod.small_end_diameter_mm / 2
    in_boss = (np.abs(u) <= _BEYOND * rod.boss_width_mm / 2) & (v <= _BEYOND * rod.boss_above_mm)
    in_big = in_boss | (np.hypot(x, y) <= _BEYOND * rod.big_end_diameter_mm / 2)
    along = np.select([y >= top, y > bottom], [1, 2], 3)
    return np.asarray(np.select([in_small, in_big & (v < 0), in_big], [0, 5, 4], along), dtype=np.intp)
