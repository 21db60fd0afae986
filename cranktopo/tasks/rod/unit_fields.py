"""Displacements of a quarter of the rod under unit loads: every state of the cycle is a sum of them.

Loads are pressures on both bores, the inertia of the rod's own mass, and the press fit of the bush. Each is
closed in itself, by even acceleration along the rod or by both eyes across it: supports carry nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.side_by_side import side_by_side
from cranktopo.base.units import KG_PER_TONNE, MM_PER_M, MPA_PER_GPA, density_tonne_per_mm3
from cranktopo.bodies.mesh.rod_mesh import mesh_rod
from cranktopo.design.checks.rod import rod_of
from cranktopo.design.material import Material
from cranktopo.design.rod import EYES, Eye, Rod
from cranktopo.design.rod_fitted import bolts_kg
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, assemble, mass_matrix
from cranktopo.numerics.tetrahedra.solver import get_ready
from cranktopo.numerics.tetrahedra.surface_loads import face_shares, faces_where, pressure_force
from cranktopo.tasks.rod.contact import Pressure, cosine, strips, touching

ALONG = ("small push", "small pull", "big push", "big pull", "small inertia", "big inertia", "press fit")
"""Loads that are the same on both sides of the rod: 1 N on the lower or upper half of the small end's bore
and on the upper or lower half of the big end's, by the cosine; the inertia where one end accelerates by
1 m/s2 toward the big end along the rod and the other does not; 1 MPa in the small end's bore."""
ACROSS = ("small whip", "big whip")
"""Loads that the mirror x -> -x turns around: the inertia where one end accelerates by 1 m/s2 across the rod
and the other does not, carried by both eyes."""
PRESSED: tuple[tuple[Eye, int], ...] = (("small", -1), ("small", 1), ("big", 1), ("big", -1))
"""Eyes and sides of the first loads of `ALONG`."""
Pressures = Mapping[tuple[Eye, int], Pressure]
"""Pressure on the sides of bores; by the cosine where none is given."""
QUARTERS = 4
_PLANE_MM = 1e-6
_ON_BORE = 1e-5
"""Distance of nodes on a bore from it, over its radius."""


@dataclass(frozen=True)
class RodFields:
    """Unit loads of a rod, solved on a quarter of it.

    Attributes:
        displacement_mm: of each load of `ALONG` and `ACROSS`, shape (loads, unknowns).
        inertia_kg: mass that the accelerations of small and big end move along the rod.
        residual: largest force that is left on a node, supports included, over all of its load.
        pressures: of the pins on the bores; by the cosine where none is given.
    """

    scene: Scene
    model: Elasticity
    displacement_mm: Array
    inertia_kg: tuple[float, float]
    residual: float
    pressures: Pressures

    @property
    def rod(self) -> Rod:
        """Return the table of the rod."""
        return rod_of(self.scene)[0]

    @property
    def length_mm(self) -> float:
        """Return the distance of both eyes."""
        return rod_of(self.scene)[1]

    @property
    def elastic(self) -> tuple[float, float]:
        """Return Young's modulus in MPa and Poisson's ratio."""
        return _elastic(self.scene)


def rod_material(scene: Scene) -> Material:
    """Return the material of the rod, that of the crankshaft where it has none of its own."""
    return rod_of(scene)[0].material or scene.material


def _elastic(scene: Scene) -> tuple[float, float]:
    material = rod_material(scene)
    return material.E_GPa * MPA_PER_GPA, material.poisson


def rod_model(scene: Scene, element_size_mm: float) -> Elasticity:
    """Return a quarter of a design's rod on elements.

    Raises:
        CranktopoError: no rod, impossible geometry, or no valid mesh.
    """
    get_ready()
    return assemble(mesh_rod(scene, element_size_mm), *_elastic(scene))


def contact_pressures(scene: Scene, model: Elasticity) -> Pressures:
    """Return the pressures of rigid pins on both sides of both bores."""
    loads = _Loads(scene, model, {})
    parts = [loads.strips(eye, side) for eye, side in PRESSED]
    moved = _solved(model, np.hstack([part for part, _ in parts]), loads.held_along())[0]
    each = np.split(moved, len(PRESSED), axis=1)
    return {
        at: touching(part, own, forces) for at, (part, forces), own in zip(PRESSED, parts, each, strict=True)
    }


def solve_rod(scene: Scene, model: Elasticity, pressures: Pressures) -> RodFields:
    """Return the unit loads of a design's rod on a model of its quarter.

    Raises:
        CranktopoError: a failed solve.
    """
    loads = _Loads(scene, model, pressures)
    along, across = loads.along(), loads.across()
    (first, left), (second, more) = side_by_side(
        lambda: _solved(model, along, loads.held_along()), lambda: _solved(model, across, loads.held_across())
    )
    fields = np.ascontiguousarray(np.hstack([first, second]).T)
    return RodFields(scene, model, fields, loads.inertia_kg, max(left, more), pressures)


def _solved(
    model: Elasticity, loads: Array, held: tuple[NDArray[np.intp], NDArray[np.intp]]
) -> tuple[Array, float]:
    """Return displacements under loads (unknowns, k), and the largest force left where no mirror holds.

    Args:
        held: unknowns that the mirror planes hold, and those of the supports.
    """
    mirrors, supports = held
    found = model.equations.solver(np.union1d(mirrors, supports))(loads)
    left = model.stiffness @ found - loads
    left[mirrors] = 0.0
    return found, float((np.linalg.norm(left, axis=0) / np.linalg.norm(loads, axis=0)).max())


@dataclass(frozen=True)
class Bore:
    """A bore of the quarter: its faces, and pressures on them as nodal forces."""

    model: Elasticity
    y_mm: float
    radius_mm: float

    @cached_property
    def faces(self) -> Any:
        """Return the basis of the faces on the bore."""

        def on_bore(points: Array) -> NDArray[np.bool_]:
            away = np.hypot(points[0], points[1] - self.y_mm) / self.radius_mm - 1
            return np.asarray(np.abs(away) < _ON_BORE)

        return faces_where(self.model, on_bore)

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
        return np.asarray(force / abs(force[1::3].sum()) / QUARTERS)

    def across(self) -> Array:
        """Return 1 N on the rod along x, by the cosine over all of the bore."""
        force = self._force(lambda x, _: x)
        return np.asarray(force / force[::3].sum() / QUARTERS)

    def even(self) -> Array:
        """Return 1 MPa all around."""
        return self._force(lambda x, _: np.ones_like(x))


def bore_of(scene: Scene, model: Elasticity, eye: Eye) -> Bore:
    """Return the bore of small or big end on a model of the quarter."""
    rod, length = rod_of(scene)
    if eye == "small":
        return Bore(model, length, rod.small_end_bore_mm / 2)
    return Bore(model, 0.0, rod.big_end_bore_mm / 2)


class _Loads:
    """Unit loads of a design's rod as nodal forces on a quarter of it."""

    def __init__(self, scene: Scene, model: Elasticity, pressures: Pressures) -> None:
        """Find the bores and the mass of the nodes, tonne."""
        rod, self._length = rod_of(scene)
        self._model = model
        self._bores = {eye: bore_of(scene, model, eye) for eye in EYES}
        self._pressures = pressures
        self._mass = mass_matrix(model, density_tonne_per_mm3(rod_material(scene).density_kg_m3))
        self._bolts = _bolt_masses(model, rod)
        self._share = model.nodes_mm[1] / self._length

    def _inertia(self, acceleration_m_s2: Array, axis: int) -> Array:
        """Nodal forces of what accelerates along -y or +x at the nodes."""
        force = np.zeros(self._model.nodes_mm.shape)
        moved = acceleration_m_s2 * MM_PER_M
        force[axis] = self._mass @ moved + self._bolts * moved
        return (force if axis == 1 else -force).T.ravel()

    @property
    def inertia_kg(self) -> tuple[float, float]:
        """Mass of the whole rod that each end's acceleration moves."""
        small, big = (self._inertia(s, 1)[1::3].sum() for s in (self._share, 1 - self._share))
        return float(QUARTERS * small), float(QUARTERS * big)

    def along(self) -> Array:
        """Loads of `ALONG`, (unknowns, k), each closed by even acceleration."""
        loads = np.column_stack(
            [
                *(
                    self._bores[eye].unit(side, self._pressures.get((eye, side), cosine))
                    for eye, side in PRESSED
                ),
                self._inertia(self._share, 1),
                self._inertia(1 - self._share, 1),
                self._bores["small"].even(),
            ]
        )
        even = self._inertia(np.ones_like(self._share), 1)
        return np.asarray(loads - np.outer(even, loads[1::3].sum(axis=0) / even[1::3].sum()))

    def strips(self, eye: Eye, side: int) -> tuple[Array, Array]:
        """Pressures on strips of a side, (unknowns, strips), each carried by the other eye; their forces."""
        bore, other = self._bores[eye], self._bores["big" if eye == "small" else "small"]
        loads = np.column_stack([bore.pressed(side, pressure) for pressure in strips()])
        forces = side * loads[1::3].sum(axis=0)
        return loads + np.outer(other.unit(-side, cosine), QUARTERS * forces), forces

    def across(self) -> Array:
        """Loads of `ACROSS`, (unknowns, 2), each carried by both eyes."""
        eyes = np.column_stack([bore.across() for bore in self._bores.values()])
        loads = np.column_stack([self._inertia(s, 0) for s in (self._share, 1 - self._share)])
        carried = np.linalg.solve(self._sums(eyes), self._sums(loads))
        return np.asarray(loads - eyes @ carried)

    def _sums(self, forces: Array) -> Array:
        """Force along x and moment about the pins' direction of nodal forces, (2, k)."""
        x, y = forces[::3], forces[1::3]
        at_x, at_y, _ = self._model.nodes_mm[:, :, None]
        return np.stack([x.sum(axis=0), (at_x * y - at_y * x).sum(axis=0)])

    def _mirrors(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Nodes on the mirror planes x = 0 and z = 0."""
        on = np.abs(self._model.nodes_mm) < _PLANE_MM
        return np.flatnonzero(on[0]), np.flatnonzero(on[2])

    def held_along(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Unknowns that the mirrors hold, and one along the rod."""
        middle, across = self._mirrors()
        return np.union1d(3 * middle, 3 * across + 2), 3 * middle[:1] + 1

    def held_across(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Unknowns that the mirrors hold, and two across the rod at its ends."""
        middle, across = self._mirrors()
        y = self._model.nodes_mm[1, middle]
        ends = middle[[int(y.argmin()), int(y.argmax())]]
        return np.union1d(np.concatenate([3 * middle + 1, 3 * middle + 2]), 3 * across + 2), 3 * ends


def _bolt_masses(model: Elasticity, rod: Rod) -> Array:
    """Mass of the bolts on the nodes of their holes, (nodes,), tonne, of the quarter.

    It is given to the cap alone: with their heads below it, bolts have their centre of mass there.
    """
    if rod.bolt is None:
        return np.zeros(model.nodes_mm.shape[1])
    radius, middle = rod.bolt_hole_mm / 2, rod.bolt_distance_mm / 2

    def in_hole(points: Array) -> NDArray[np.bool_]:
        away = np.hypot(points[0] - middle, points[2]) / radius - 1
        return np.asarray((points[1] <= 0) & (np.abs(away) < _ON_BORE))

    return face_shares(model, faces_where(model, in_hole)) * bolts_kg(rod) / KG_PER_TONNE / QUARTERS
