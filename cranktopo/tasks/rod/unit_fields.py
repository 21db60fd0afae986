"""Displacements of the rod under unit loads, on a model of it: every state of the cycle is a sum of them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.side_by_side import side_by_side
from cranktopo.base.units import MPA_PER_GPA
from cranktopo.bodies.mesh.rod_mesh import mesh_rod
from cranktopo.design.checks.rod import rod_of
from cranktopo.design.rod import Rod
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, assemble
from cranktopo.numerics.tetrahedra.solver import get_ready
from cranktopo.tasks.rod.contact import touching
from cranktopo.tasks.rod.unit_loads import PRESSED, LoadGroup, Pressures, RodLoads, rod_material

_RESIDUAL_OF_STRIPS = 1e-4
"""Accepted where the pressure of a pin is sought; solves aim at a hundredth of it."""


@dataclass(frozen=True)
class RodFields:
    """Unit loads of a rod, solved on a model of it.

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


def _elastic(scene: Scene) -> tuple[float, float]:
    material = rod_material(scene)
    return material.E_GPa * MPA_PER_GPA, material.poisson


def rod_model(scene: Scene, element_size_mm: float) -> Elasticity:
    """Return a design's rod on elements: a quarter of one with a square split, else a half.

    Raises:
        CranktopoError: no rod, impossible geometry, or no valid mesh.
    """
    get_ready()
    return assemble(mesh_rod(scene, element_size_mm), *_elastic(scene))


def contact_pressures(scene: Scene, model: Elasticity) -> Pressures:
    """Return the pressures of rigid pins on both sides of both bores."""
    loads = RodLoads(scene, model, {})
    parts = [loads.strips(eye, side) for eye, side in PRESSED]
    every = np.hstack([group.forces for group, _ in parts])
    solve = model.equations.solver(parts[0][0].held, _RESIDUAL_OF_STRIPS)
    each = np.split(solve(every), len(PRESSED), axis=1)
    return {
        at: touching(group.forces, own, forces)
        for at, (group, forces), own in zip(PRESSED, parts, each, strict=True)
    }


def solve_rod(scene: Scene, model: Elasticity, pressures: Pressures) -> RodFields:
    """Return the unit loads of a design's rod on a model of it.

    Raises:
        CranktopoError: a failed solve.
    """
    loads = RodLoads(scene, model, pressures)
    solves = [partial(_solved, model, group) for group in loads.groups()]
    found = side_by_side(*solves) if len(solves) > 1 else [solves[0]()]
    fields = np.ascontiguousarray(np.hstack([moved for moved, _ in found]).T)
    return RodFields(scene, model, fields, loads.inertia_kg, max(left for _, left in found), pressures)


def _solved(model: Elasticity, group: LoadGroup) -> tuple[Array, float]:
    """Return displacements under loads (unknowns, k), and the largest force left where no mirror holds."""
    found = model.equations.solver(group.held)(group.forces)
    left = model.stiffness @ found - group.forces
    left[group.mirrors] = 0.0
    applied = np.linalg.norm(group.forces, axis=0)
    acting = applied > 0  # without bolts they have no preload
    return found, float((np.linalg.norm(left[:, acting], axis=0) / applied[acting]).max())
