"""Stresses of unit loads on the surface of any body, and the way back from them to displacements and nodes.

A part says how it is meshed, held and loaded, and which planes its model is cut at. All states of a load are
sums of these stresses, and every quantity that is read off them has its derivatives by one adjoint.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.numerics.tetrahedra.elasticity import Elasticity
from cranktopo.numerics.tetrahedra.stress import (
    NodalStress,
    Surface,
    SurfaceStress,
    joined,
    nodal_stress,
    outer_surface,
    surface_stress,
)
from cranktopo.numerics.tetrahedra.stress_adjoint import stress_adjoint


@dataclass(frozen=True, eq=False)
class UnitStress:
    """A body under unit loads.

    Attributes:
        displacement_mm: of each load, shape (fields, unknowns).
        elastic: Young's modulus in MPa and Poisson's ratio.
        planes: of symmetry or where the model ends, (axis, mm): nothing is judged there.
        at_once: fields whose stresses are held in all elements at a time; 0 is all of them, which are kept.
    """

    model: Elasticity
    displacement_mm: Array
    elastic: tuple[float, float]
    planes: tuple[tuple[int, float], ...]
    at_once: int = 0

    @cached_property
    def surface(self) -> Surface:
        """The outer surface, without the planes."""
        return outer_surface(self.model, self.model.mesh.dofs.element_dofs, self.planes)

    @cached_property
    def stress(self) -> SurfaceStress:
        """Stresses of each field on the surface."""
        return joined([surface_stress(self.model, self.surface, nodal) for _, nodal in self._parts()])

    def adjoint(self, by_stress: tuple[Array, Array]) -> tuple[Array, Array]:
        """Return derivatives of a quantity by displacements, (fields, unknowns), and by nodes, (3, nodes).

        Args:
            by_stress: its derivatives by the stresses on the surface and by their derivatives into the depth,
                each (fields, surface nodes, 6). Displacements are held in the second result.
        """
        by_fields, by_nodes = np.zeros_like(self.displacement_mm), np.zeros(self.model.nodes_mm.shape)
        for which, nodal in self._parts():
            by_fields[which], slopes = stress_adjoint(
                self.model,
                self.surface,
                nodal,
                self.displacement_mm[which],
                (by_stress[0][which], by_stress[1][which]),
                self.elastic,
            )
            by_nodes += slopes
        return by_fields, by_nodes

    def _parts(self) -> Iterator[tuple[slice, NodalStress]]:
        """Yield some fields at a time with their stresses at all nodes."""
        if not self.at_once:
            yield slice(None), self._whole
            return
        for first in range(0, len(self.displacement_mm), self.at_once):
            which = slice(first, first + self.at_once)
            yield which, nodal_stress(self.model, self.displacement_mm[which], *self.elastic)

    @cached_property
    def _whole(self) -> NodalStress:
        return nodal_stress(self.model, self.displacement_mm, *self.elastic)
