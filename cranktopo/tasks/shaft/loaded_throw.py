"""A throw condensed to its two mid-journal sections with the forces on its crankpin and of its rotation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.frames import Span
from cranktopo.base.units import density_tonne_per_mm3
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, centrifugal_force, mean_displacement
from cranktopo.tasks.fea.condense import RX, UY, Lateral, Superelement, condense, loaded_mm
from cranktopo.tasks.shaft.assembly import SPLITS, symmetries, throw_matrix

_PIN = ("radial", "tangential")


@dataclass(frozen=True)
class LoadedThrow:
    """Stiffness of a full throw over the six motions of its near and then its far section, and its loads.

    Attributes:
        stiffness: (12, 12), mm, rad, N, N mm, each section in axes parallel to those of the throw.
        loads: section forces that do the same work as a unit load, (12,): "radial" 1 N on the pin along -y,
            "tangential" 1 N along +x, "radial aside" and "tangential aside" half of it on the near half of
            the pin and its opposite on the far one, "centrifugal" of 1 rad/s.
        aside_mm: distance between the middles of the halves of the pin, as the mesh has them.
    """

    stiffness: Array
    loads: dict[str, Array]
    aside_mm: float


@dataclass(frozen=True)
class LoadedBlock:
    """The throw condensed in one symmetry of the model, with the unit loads that have it.

    Attributes:
        names: of the further loads of the block, in their order.
    """

    span: Span
    block: Superelement
    names: tuple[str, ...]

    def section_forces(self) -> dict[str, Array]:
        """Return what the unit loads of the full throw do on both its sections, (12,) each."""
        split = SPLITS[self.span][list(self.block.motions)]
        per_model = split.T @ self.block.extra_loads / self.block.parts
        models = self.block.copies * self.block.parts
        return {
            name: per_model[:, column] * (models if name == "centrifugal" else 1)
            for column, name in enumerate(self.names)
        }


def loaded_blocks(
    model: Elasticity, scene: Scene, mirrored: bool, *, whole: bool = False
) -> list[LoadedBlock]:
    """Return the throw condensed as by `throw_blocks`, with the unit loads of each symmetry.

    Raises:
        CranktopoError: a failed solve.
    """
    return [_condensed(model, scene, span, lateral) for span, lateral in symmetries(mirrored, whole)]


def _condensed(model: Elasticity, scene: Scene, span: Span, lateral: Lateral) -> LoadedBlock:
    forces = _unit_loads(model, scene, span, lateral)
    block = condense(model, scene, span, lateral, np.column_stack(list(forces.values())))
    return LoadedBlock(span, block, tuple(forces))


def loaded_throw(blocks: Sequence[LoadedBlock], scene: Scene) -> LoadedThrow:
    """Return stiffness and loads of the full throw from its condensed symmetries."""
    loads: dict[str, Array] = {}
    for part in blocks:
        for name, forces in part.section_forces().items():
            loads[name] = loads.get(name, np.zeros(12)) + forces
    aside = loads["radial aside"]
    moment = aside[RX] + aside[6 + RX] - scene.pitch_mm * aside[6 + UY]
    return LoadedThrow(throw_matrix([(part.span, part.block) for part in blocks]), loads, -2 * float(moment))


def _unit_loads(model: Elasticity, scene: Scene, span: Span, lateral: Lateral) -> dict[str, Array]:
    """Nodal forces on the model of the unit loads that have its symmetry."""
    wanted = {"even": ("radial",), "odd": ("tangential",), "none": _PIN}[lateral]
    low, high = loaded_mm(scene, whole=True)
    found: dict[str, Array] = {}
    for name in wanted:
        axis, sign = (1, -1.0) if name == "radial" else (0, 1.0)
        near = sign * mean_displacement(model, axis, low, (low + high) / 2)
        far = sign * mean_displacement(model, axis, (low + high) / 2, high) if span == "whole" else near
        if span != "antisymmetric":
            found[name] = (near + far) / 2
        if span != "symmetric":
            found[f"{name} aside"] = (near - far) / 2 if span == "whole" else near
    if span != "antisymmetric" and lateral != "odd":
        found["centrifugal"] = centrifugal_force(model, density_tonne_per_mm3(scene.material.density_kg_m3))
    return found
