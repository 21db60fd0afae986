"""Unit loads of the rod on elements: pressures on both bores, inertia of its mass, press fit, preload.

The model is a quarter, x >= 0 and z >= 0, or the half z >= 0 of a rod with an oblique split. Each load is
closed in itself, by even acceleration along the rod and by both eyes across it: supports carry nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Index
from cranktopo.base.units import MM_PER_M, density_tonne_per_mm3
from cranktopo.design.checks.rod import rod_of
from cranktopo.design.material import Material
from cranktopo.design.rod import EYES, Eye
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, mass_matrix
from cranktopo.numerics.tetrahedra.node_gradients import integral_slopes
from cranktopo.numerics.tetrahedra.rigid_motions import RZ, UX, UY, body_motions, held_by_mirror, plane_nodes
from cranktopo.numerics.tetrahedra.surface_loads import faces_where, pressure_force
from cranktopo.tasks.rod.bolt_load import bolt_masses, preload_tractions
from cranktopo.tasks.rod.contact import Pressure, cosine, strips

ALONG = (
    "small push",
    "small pull",
    "big push",
    "big pull",
    "small inertia",
    "big inertia",
    "press fit",
    "preload",
)
"""Loads that the mirror x -> -x keeps where it is one: 1 N on the lower or upper half of the small end's bore
and on the upper or lower half of the big end's, by the cosine; the inertia where one end accelerates by
1 m/s2 toward the big end along the rod and the other does not; 1 MPa in the small end's bore; 1 N in each
bolt of the cap."""
ACROSS = ("small whip", "big whip")
"""Loads that the mirror x -> -x turns around: the inertia where one end accelerates by 1 m/s2 across the rod
and the other does not, carried by both eyes."""
PRELOAD = np.array([name == "preload" for name in (*ALONG, *ACROSS)])
"""The preload among all loads."""
SHAPING = np.array([name in ALONG for name in (*ALONG, *ACROSS)]) & ~PRELOAD
"""Those of all loads that change the diameters of bores: these are finished with the bolts tightened."""
PRESSED: tuple[tuple[Eye, int], ...] = (("small", -1), ("small", 1), ("big", 1), ("big", -1))
"""Eyes and sides of the first loads of `ALONG`."""
Pressures = Mapping[tuple[Eye, int], Pressure]
"""Pressure on the sides of bores; by the cosine where none is given."""
Motion = Literal["along", "across", "whole"]
"""Motions of a quarter under loads of `ALONG` and of `ACROSS`, and of a half under either."""
_IN_PLANE = (UX, UY, RZ)
"""Motions of the whole body that do work of the resultants below."""
_RESULTANTS: dict[Motion, list[int]] = {"along": [1], "across": [0, 2], "whole": [0, 1, 2]}
"""Forces along x and y and moment about the pins' direction that loads of a motion may have."""
_ACCELERATED = {
    "small inertia": (0.0, 1.0),
    "big inertia": (1.0, -1.0),
    "small whip": (0.0, 1.0),
    "big whip": (1.0, -1.0),
}
"""Loads by the acceleration at the axis of the big end, and its growth to that of the small end, m/s2."""
_PLANE_MM = 1e-6
_ON_BORE = 1e-5
"""Distance of nodes on a bore from it, over its radius."""


def rod_material(scene: Scene) -> Material:
    """Return the material of the rod, that of the crankshaft where it has none of its own."""
    return rod_of(scene)[0].material or scene.material


def is_quarter(model: Elasticity) -> bool:
    """Tell whether a model is a quarter of the rod, x >= 0; else it is a half."""
    return bool(model.nodes_mm[0].min() > -_PLANE_MM)


def copies(model: Elasticity) -> int:
    """Return the number of such bodies in the rod."""
    return 4 if is_quarter(model) else 2


@dataclass(frozen=True)
class LoadGroup:
    """Closed loads of a motion.

    Attributes:
        forces: shape (unknowns, k).
        mirrors, supports: unknowns that mirror planes hold, and those of the supports.
        carriers: what the loads are closed by, (unknowns, c).
        carried: how much of each carrier every load has, (c, k).
    """

    motion: Motion
    forces: Array
    mirrors: Index
    supports: Index
    carriers: Array
    carried: Array

    @property
    def held(self) -> Index:
        """Unknowns that are held."""
        return np.union1d(self.mirrors, self.supports)


@dataclass(frozen=True)
class Bore:
    """A bore of the model: its faces, and pressures on them as nodal forces."""

    model: Elasticity
    y_mm: float
    radius_mm: float

    @cached_property
    def faces(self) -> Any:
        """Return the basis of the faces on the bore."""
        return faces_where(self.model, partial(_on_cylinder, self.y_mm, self.radius_mm))

    def _force(self, pressure: Callable[[Array, Array], Array]) -> Array:
        """Nodal forces of a pressure over x and y from the axis, both over the radius."""
        x, y, _ = np.asarray(self.faces.global_coordinates())
        found = pressure(x / self.radius_mm, (y - self.y_mm) / self.radius_mm)
        return pressure_force(self.model, self.faces, found)

    def pressed(self, side: int, pressure: Pressure) -> Array:
        """Return a pressure on the half of the bore toward +y or -y, as its side is."""
        return self._force(lambda x, y: pressure(np.arctan2(x, side * y)))

    def unit(self, side: int, pressure: Pressure) -> Array:
        """Return 1 N on the rod along +y or -y by such a pressure."""
        force = self.pressed(side, pressure)
        return np.asarray(force / abs(force[1::3].sum()) / copies(self.model))

    def across(self) -> Array:
        """Return 1 N on the rod along x, by the cosine over all of the bore."""
        force = self._force(lambda x, _: x)
        return np.asarray(force / force[::3].sum() / copies(self.model))

    def even(self) -> Array:
        """Return 1 MPa all around."""
        return self._force(lambda x, _: np.ones_like(x))


def bore_of(scene: Scene, model: Elasticity, eye: Eye) -> Bore:
    """Return the bore of small or big end on a model of the rod."""
    return Bore(model, *_bore_mm(scene, eye))


def _bore_mm(scene: Scene, eye: Eye) -> tuple[float, float]:
    """Place of a bore's axis along the rod, and its radius."""
    rod, length = rod_of(scene)
    return (length, rod.small_end_bore_mm / 2) if eye == "small" else (0.0, rod.big_end_bore_mm / 2)


def on_bore(scene: Scene, eye: Eye, points_mm: Array) -> NDArray[np.bool_]:
    """Tell which points (3, n) lie on the bore of an eye."""
    return _on_cylinder(*_bore_mm(scene, eye), points_mm)


def _on_cylinder(y_mm: float, radius_mm: float, points: Array) -> NDArray[np.bool_]:
    away = np.hypot(points[0], points[1] - y_mm) / radius_mm - 1
    return np.asarray(np.abs(away) < _ON_BORE)


class RodLoads:
    """Unit loads of a design's rod as nodal forces on a model of it."""

    def __init__(self, scene: Scene, model: Elasticity, pressures: Pressures) -> None:
        """Find the bores and the mass of the nodes, tonne."""
        rod, self._length = rod_of(scene)
        self._model = model
        self._bores = {eye: bore_of(scene, model, eye) for eye in EYES}
        self._pressures = pressures
        self._density = density_tonne_per_mm3(rod_material(scene).density_kg_m3)
        self._mass = mass_matrix(model, self._density)
        self._bolts = bolt_masses(rod, model) / copies(model)
        self._preload = preload_tractions(rod, model)
        self._share = model.nodes_mm[1] / self._length

    def _inertia(self, acceleration_m_s2: Array, axis: int) -> Array:
        """Nodal forces of what accelerates along -y or +x at the nodes."""
        force = np.zeros(self._model.nodes_mm.shape)
        moved = acceleration_m_s2 * MM_PER_M
        force[axis] = self._mass @ moved + self._bolts * moved
        return (force if axis == 1 else -force).T.ravel()

    def _of_both_ends(self, axis: int) -> list[Array]:
        """Inertia where the small end alone accelerates, and where the big end does."""
        return [self._inertia(share, axis) for share in (self._share, 1 - self._share)]

    @property
    def inertia_kg(self) -> tuple[float, float]:
        """Mass of the whole rod that each end's acceleration moves."""
        small, big = (float(force[1::3].sum()) * copies(self._model) for force in self._of_both_ends(1))
        return small, big

    def gradients(self, group: LoadGroup, adjoint: Array) -> Array:
        """Return the derivative of sum(adjoint * forces) by the nodes, (3, nodes), while bores stand still.

        Of every load of `ALONG`, `ACROSS` or both, as the group has them; adjoint (unknowns, k).
        """
        names = {"along": ALONG, "across": ACROSS, "whole": (*ALONG, *ACROSS)}[group.motion]
        rows, moments = _RESULTANTS[group.motion], np.zeros_like(self._model.nodes_mm)
        rigid = self._rigid(rows)
        needed = np.linalg.solve(self._sums(group.carriers)[rows].T, group.carriers.T @ adjoint)
        free = adjoint - rigid @ needed
        if 2 in rows:
            turned = group.forces @ needed[rows.index(2)]
            moments[0], moments[1] = -turned[1::3], turned[::3]
        even, linear = np.zeros_like(self._share), np.zeros_like(self._share)
        carried = group.carried[0] if group.motion != "across" else np.zeros(len(names))
        for column, (name, share) in enumerate(zip(names, carried, strict=True)):
            along, across = free[1::3, column], free[::3, column]
            even -= share * along
            if name in _ACCELERATED:
                field = along if name in ALONG else -across
                start, growth = _ACCELERATED[name]
                even += start * field
                linear += growth / self._length * field
            if name == "preload":
                moments += sum(size * one.slopes(free[:, column]) for size, one in self._preload)
        by_place = np.stack([0 * linear, linear, 0 * linear])
        factor = self._density * MM_PER_M
        return np.asarray(factor * integral_slopes(self._model, even, by_place) + moments)

    def _rigid(self, rows: Sequence[int]) -> Array:
        """Motions of the whole body whose works are the resultants of `_sums`, (unknowns, rows)."""
        return body_motions(self._model.nodes_mm)[:, [_IN_PLANE[row] for row in rows]]

    def groups(self) -> list[LoadGroup]:
        """Loads of `ALONG` and `ACROSS` in this order, in one group of a half and in two of a quarter."""
        pressed = [
            self._bores[eye].unit(side, self._pressures.get((eye, side), cosine)) for eye, side in PRESSED
        ]
        ends, fit = self._of_both_ends(1), self._bores["small"].even()
        preload = sum((size * one.forces() for size, one in self._preload), np.zeros_like(fit))
        along = np.column_stack([*pressed, *ends, fit, preload])
        across = np.column_stack(self._of_both_ends(0))
        even, eyes = self._inertia(np.ones_like(self._share), 1)[:, None], self._across()
        if is_quarter(self._model):
            return [self._group("along", along, even), self._group("across", across, eyes)]
        return [self._group("whole", np.hstack([along, across]), np.hstack([even, eyes]))]

    def strips(self, eye: Eye, side: int) -> tuple[LoadGroup, Array]:
        """Pressures on strips of a side, each carried by the other eye; their forces along and across."""
        quarter = is_quarter(self._model)
        bore, other = self._bores[eye], self._bores["big" if eye == "small" else "small"]
        loads = np.column_stack([bore.pressed(side, pressure) for pressure in strips(alike=quarter)])
        carrier = other.unit(-side, cosine)[:, None]
        forces = np.stack([side * loads[1::3].sum(axis=0), (not quarter) * loads[::3].sum(axis=0)])
        if quarter:
            return self._group("along", loads, carrier), forces
        return self._group("whole", loads, np.hstack([carrier, self._across()])), forces

    def _across(self) -> Array:
        """1 N across the rod on either eye, (unknowns, 2)."""
        return np.column_stack([bore.across() for bore in self._bores.values()])

    def _group(self, motion: Motion, loads: Array, carriers: Array) -> LoadGroup:
        """Loads of a motion, closed by others."""
        rows = _RESULTANTS[motion]
        carried = np.asarray(
            np.linalg.solve(self._sums(carriers)[rows], self._sums(loads)[rows]), dtype=np.float64
        )
        closed = np.asarray(loads - carriers @ carried)
        return LoadGroup(motion, closed, *self._held(motion), carriers, carried)

    def _sums(self, forces: Array) -> Array:
        """Forces along x and y and moment about the pins' direction of nodal forces, (3, k)."""
        x, y = forces[::3], forces[1::3]
        at_x, at_y, _ = self._model.nodes_mm[:, :, None]
        return np.stack([x.sum(axis=0), y.sum(axis=0), (at_x * y - at_y * x).sum(axis=0)])

    def _held(self, motion: Motion) -> tuple[Index, Index]:
        """Unknowns that the mirrors hold in a motion, and those of its supports at the ends of the rod."""
        nodes_mm, quarter = self._model.nodes_mm, is_quarter(self._model)
        middle = plane_nodes(nodes_mm, 0, 0.0) if quarter else np.arange(nodes_mm.shape[1])
        y = nodes_mm[1, middle]
        ends = 3 * middle[[int(y.argmin()), int(y.argmax())]]
        mirrors = [held_by_mirror(nodes_mm, 2, 0.0, even=True)]
        if motion != "whole":
            mirrors.append(held_by_mirror(nodes_mm, 0, 0.0, even=motion == "along"))
        supports = {"along": ends[:1] + 1, "across": ends, "whole": np.append(ends, ends[0] + 1)}[motion]
        return np.unique(np.concatenate(mirrors)), supports
