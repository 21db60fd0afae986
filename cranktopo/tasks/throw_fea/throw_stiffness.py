"""Stiffness of a meshed throw for every support, by two condensations or one, with bounds of its error."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TypeVar

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.side_by_side import side_by_side
from cranktopo.base.units import MPA_PER_GPA
from cranktopo.bodies.mesh.solid_mesh import MeshedThrow
from cranktopo.design.schema import Scene
from cranktopo.engine.bearings import bearing_spring_N_per_mm
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, Order, assemble
from cranktopo.numerics.tetrahedra.superelement import Superelement
from cranktopo.tasks.throw_fea.condense import (
    BendingSupport,
    TorsionSupport,
    bending_stiffness_N_per_mm,
    condense,
    torsional_stiffness_Nm_per_rad,
)
from cranktopo.tasks.throw_fea.discretisation_error import discretisation_errors, volume_error
from cranktopo.tasks.throw_fea.error_bound import bending_bound_percent, torsion_bound_percent

_VOLUME_TOLERANCE = 0.02
"""Mesh against solid: sound meshes of 15 mm elements are within 1 %, of the default size within 0.01 %."""

_TORSION: tuple[TorsionSupport, ...] = ("free", "held", "spring")
_BENDING: tuple[BendingSupport, ...] = ("pinned", "clamped", "spring")

_ByName = dict[str, float | None]
Support = TypeVar("Support", bound=str)


@dataclass(frozen=True)
class Stiffness:
    """Stiffnesses of the full throw on one mesh; spring values are None without a bearing spring.

    Attributes:
        torsion: N m/rad by support "free", "held", "spring".
        bending: N/mm by support "pinned", "clamped", "spring".
        torsion_error_percent, bending_error_percent: bound of the error on this mesh, by support; empty with
            linear elements.
    """

    torsion: dict[str, float | None]
    bending: dict[str, float | None]
    nodes: int
    element_size_mm: float
    mesh_seconds: float
    solve_seconds: float
    torsion_error_percent: Mapping[str, float | None] = field(default_factory=dict)
    bending_error_percent: Mapping[str, float | None] = field(default_factory=dict)


def condensed_stiffness(
    meshed: MeshedThrow, scene: Scene, element_size_mm: float, mesh_seconds: float, order: Order = 2
) -> Stiffness:
    """Return the stiffnesses of a meshed throw for every support, by two condensations or one.

    Raises:
        CranktopoError: a mesh that does not fill the solid, or a failed solve.
    """
    start = time.perf_counter()
    youngs, poisson = scene.material.E_GPa * MPA_PER_GPA, scene.material.poisson
    model = assemble(meshed.mesh, youngs, poisson, order)
    _check_volume(meshed, volume_error(model, meshed))
    twist, bend = _blocks(model, meshed, scene)
    torsion = _by_support(partial(torsional_stiffness_Nm_per_rad, twist), _TORSION, scene)
    bending = _by_support(partial(bending_stiffness_N_per_mm, bend), _BENDING, scene)
    nodes = model.nodes_mm.shape[1]
    errors: tuple[_ByName, _ByName] = ({}, {})
    if order == 2:
        twisted, bent = discretisation_errors(model, meshed, (twist, bend), scene)
        errors = (
            _by_support(partial(torsion_bound_percent, twist, twisted), _TORSION, scene),
            _by_support(partial(bending_bound_percent, bend, bent), _BENDING, scene),
        )
    seconds = time.perf_counter() - start
    return Stiffness(torsion, bending, nodes, element_size_mm, mesh_seconds, seconds, *errors)


def _blocks(model: Elasticity, meshed: MeshedThrow, scene: Scene) -> tuple[Superelement, Superelement]:
    mirrored = meshed.mesh.mirrored
    if meshed.whole and not mirrored:
        both = condense(model, scene, "whole", "none")
        return both, both
    return side_by_side(
        lambda: condense(model, scene, meshed.span("antisymmetric"), "odd" if mirrored else "none"),
        lambda: condense(model, scene, meshed.span("symmetric"), "even" if mirrored else "none"),
    )


def _by_support(
    found: Callable[[Support, float], float], supports: Sequence[Support], scene: Scene
) -> _ByName:
    """Return what is found for each support and the bearing's spring; None for springs that nobody knows."""
    spring = bearing_spring_N_per_mm(scene)
    return {
        name: None if name == "spring" and not spring else found(name, spring or 0.0) for name in supports
    }


def _check_volume(meshed: MeshedThrow, error: float) -> None:
    volume = meshed.body.volume_mm3
    if abs(error) > _VOLUME_TOLERANCE:
        raise CranktopoError(
            f"mesh: holds {(1 + error) * volume:.1f} mm3, the body {volume:.1f} mm3.",
            hint="Choose another element size.",
            code=ExitCode.SOLVER,
        )
