"""Throws over the motions of their sections, what their meshes miss, and the stiffness of a shaft of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.frames import Span, about_z_deg
from cranktopo.base.notes import Pace
from cranktopo.base.units import MPA_PER_GPA
from cranktopo.bodies.mesh.solid_mesh import MeshedThrow
from cranktopo.design.crank_throws import carried
from cranktopo.design.schema import Scene
from cranktopo.engine.bearings import bearing_tilt_spring_Nmm_per_rad
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, assemble
from cranktopo.numerics.tetrahedra.superelement import Superelement
from cranktopo.tasks.shaft.assembly import (
    Bearings,
    ShaftStiffness,
    shaft_matrix,
    shaft_stiffness,
    throw_blocks,
    throw_matrix,
)
from cranktopo.tasks.shaft.loaded_throw import LoadedBlock, ThrowBody, throw_body
from cranktopo.tasks.throw_fea.discretisation_error import discretisation_errors
from cranktopo.tasks.throw_fea.error_bound import TORSION_VOLUME_FACTOR, bound_percent
from cranktopo.tasks.throw_fea.targets import Target


@dataclass(frozen=True)
class CondensedThrow:
    """A throw over the motions of its sections, (12, 12), and what the mesh misses of its energy.

    Attributes:
        loaded: its symmetries with the unit loads, where they were asked for.
    """

    matrix: Array
    surplus: Array
    straight: Array
    volume_error: float
    loaded: tuple[LoadedBlock, ...] = ()


def condensed_throws(
    throws: Sequence[Target], meshed: Mapping[str, MeshedThrow], *, loaded: bool = False
) -> list[CondensedThrow]:
    """Condense the throws, equal ones once; `meshed` has the mesh of each by its name."""
    return once_each(throws, lambda throw: _condensed(meshed[throw.name], throw.scene, loaded))


_Found = TypeVar("_Found")


def once_each(throws: Sequence[Target], found_of: Callable[[Target], _Found]) -> list[_Found]:
    """Return what is found of every throw; of equal ones it is found once."""
    different = list(dict.fromkeys(throws))
    pace, found = Pace("throws", len(different)), dict[str, _Found]()
    for throw in different:
        pace.begin(throw.name)
        found[throw.name] = found_of(throw)
    return [found[throw.name] for throw in throws]


def _condensed(meshed: MeshedThrow, scene: Scene, loaded: bool) -> CondensedThrow:
    if loaded:
        return of_body(throw_body(meshed, scene), scene)
    model = assemble(meshed.mesh, scene.material.E_GPa * MPA_PER_GPA, scene.material.poisson)
    blocks = throw_blocks(model, scene, meshed.mesh.mirrored, whole=meshed.whole)
    return _with_errors(meshed, model, blocks, scene)


def matrix_of(body: ThrowBody) -> Array:
    """Return the matrix of a throw that is condensed already, without what its mesh misses."""
    return throw_matrix([(part.span, part.block) for part in body.blocks])


def of_body(body: ThrowBody, scene: Scene) -> CondensedThrow:
    """Return a throw that is meshed and condensed already."""
    blocks = [(part.span, part.block) for part in body.blocks]
    return replace(_with_errors(body.meshed, body.model, blocks, scene), loaded=body.blocks)


def _with_errors(
    meshed: MeshedThrow, model: Elasticity, blocks: Sequence[tuple[Span, Superelement]], scene: Scene
) -> CondensedThrow:
    missed = discretisation_errors(model, meshed, [block for _, block in blocks], scene)
    return CondensedThrow(
        throw_matrix(blocks),
        throw_matrix(blocks, [m.surplus for m in missed]),
        throw_matrix(blocks, [m.straight for m in missed]),
        missed[0].volume_error,
    )


def stiffness_and_error(
    throws: Sequence[CondensedThrow], scene: Scene, bearings: Bearings, spring_N_per_mm: float
) -> tuple[ShaftStiffness, float]:
    """Stiffnesses of the shaft, and the bound of their relative error by what the meshes miss, %."""

    def stiffness(matrices: Sequence[Array]) -> ShaftStiffness:
        return stiffness_of(matrices, scene, bearings, spring_N_per_mm)

    found = stiffness([throw.matrix for throw in throws])
    surplus, straight = (
        _softer(found, stiffness([throw.matrix - missed for throw, missed in zip(throws, kind, strict=True)]))
        for kind in ([throw.surplus for throw in throws], [throw.straight for throw in throws])
    )
    left = max(throw.volume_error for throw in throws)
    return found, max(
        bound_percent(surplus[name], straight[name], left, TORSION_VOLUME_FACTOR) for name in surplus
    )


def stiffness_of(
    matrices: Sequence[Array], scene: Scene, bearings: Bearings, spring_N_per_mm: float = 0.0
) -> ShaftStiffness:
    """Return the stiffness of a shaft of throws of these matrices."""
    turned_deg = tuple(map(about_z_deg, scene.shaft_angles_deg))
    shaft = shaft_matrix(np.array(matrices), turned_deg)
    tilt = bearing_tilt_spring_Nmm_per_rad(scene)
    return shaft_stiffness(shaft, bearings, spring_N_per_mm, carried(scene), tilt)


def _softer(stiffness: ShaftStiffness, joint_free: ShaftStiffness) -> dict[str, float]:
    """Share of each twist that energy which a mesh misses would add."""
    softer = joint_free.by_name()
    return {name: value / softer[name] - 1 for name, value in stiffness.by_name().items()}
