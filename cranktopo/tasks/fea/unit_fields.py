"""Displacement fields of the half or whole throw under unit loads: load states are sums, no new solve."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Literal

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.frames import Span
from cranktopo.base.side_by_side import side_by_side
from cranktopo.base.units import density_tonne_per_mm3
from cranktopo.design.schema import Scene
from cranktopo.engine.bearings import required_bearing_spring_N_per_mm
from cranktopo.engine.load_case import LoadKind
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, centrifugal_force, mean_displacement
from cranktopo.tasks.fea.condense import RX, Lateral, Superelement, condense, loaded_mm
from cranktopo.tasks.fea.support_stiffness import bending_motion, torque_ends, torsion_motion

FieldKind = LoadKind | Literal["moment"]
_PARITY: dict[FieldKind, Lateral] = {
    "moment": "even",
    "bending": "even",
    "tangential": "odd",
    "torsion": "odd",
    "centrifugal": "even",
}
"""Of the loads in the mirror x -> -x."""
_TAKEN: dict[Span, tuple[FieldKind, ...]] = {
    "symmetric": ("moment", "bending", "tangential", "centrifugal"),
    "whole": ("bending", "tangential", "torsion", "centrifugal"),
}
"""The loads that one condensation holds; no moment is asked of a whole throw."""


@dataclass(frozen=True)
class UnitField:
    """Displacement of the half or whole throw, or of its half x >= 0, under one unit load of the full throw.

    Attributes:
        kind: "moment" 1 N mm about +x on the near section and its opposite on the far one (four-point
            bending); "bending" 1 N on the pin along -y; "tangential" 1 N on the pin along +x, against torque
            at both sections; "torsion" 1 N mm about +z on the near section and its opposite on the far one;
            "centrifugal" 1 rad2/s2 about the crank axis.
        sign_x: +1 if the load is its own mirror image in x, -1 if its opposite.
        sign_z: the same for the mirror at the mid-pin plane; a whole throw is not mirrored there.
    """

    kind: FieldKind
    displacement_mm: Array
    sign_x: int
    sign_z: int


def unit_fields(
    model: Elasticity, scene: Scene, mirrored: bool, kinds: Collection[FieldKind], *, whole: bool = False
) -> tuple[UnitField, ...]:
    """Displacement fields of the load kinds that are asked for; the others cost no solve.

    Args:
        mirrored: the model is the half x >= 0.
        whole: the model is the whole throw, of which no moment is asked.

    Returns:
        The fields in the order moment, bending, tangential, torsion, centrifugal.

    Raises:
        CranktopoError: a spring support without its stiffness, or a failed solve.
    """
    if whole:
        fields = _by_side(model, scene, mirrored, "whole", kinds)
    else:
        symmetric, twist = side_by_side(
            lambda: _by_side(model, scene, mirrored, "symmetric", kinds),
            lambda: _twisted(model, scene, mirrored) if "torsion" in kinds else {},
        )
        fields = {**symmetric, **twist}
    order: tuple[FieldKind, ...] = ("moment", "bending", "tangential", "torsion", "centrifugal")
    return tuple(fields[kind] for kind in order if kind in fields)


def _twisted(model: Elasticity, scene: Scene, mirrored: bool) -> dict[FieldKind, UnitField]:
    return {"torsion": twisted(condense(model, scene, "antisymmetric", "odd" if mirrored else "none"), scene)}


def twisted(block: Superelement, scene: Scene) -> UnitField:
    """Field of a unit torque from the antisymmetric condensation, or that of a whole throw."""
    spring, ends = support_spring(scene, scene.supports.torsion), torque_ends(block)
    near = ends if block.copies == 2 else -ends
    motion = torsion_motion(block, scene.supports.torsion, spring, near)
    return UnitField("torsion", _units(block) @ motion, -1, -1)


def _by_side(
    model: Elasticity, scene: Scene, mirrored: bool, span: Span, kinds: Collection[FieldKind]
) -> dict[FieldKind, UnitField]:
    """Fields of the loads that a span takes: one condensation per lateral parity has all of them."""
    laterals: tuple[Lateral, ...] = ("even", "odd") if mirrored else ("none",)
    found: dict[FieldKind, UnitField] = {}
    for lateral in laterals:
        wanted = [kind for kind in _TAKEN[span] if kind in kinds and lateral in ("none", _PARITY[kind])]
        if wanted:
            found |= _loaded(model, scene, span, lateral, wanted)
    return found


def _loaded(
    model: Elasticity, scene: Scene, span: Span, lateral: Lateral, kinds: list[FieldKind]
) -> dict[FieldKind, UnitField]:
    """Fields of some loads from one condensation, which holds the radial load already."""
    further: list[FieldKind] = [kind for kind in kinds if kind in ("tangential", "centrifugal")]
    forces = [_force(model, scene, kind, span, lateral) for kind in further]
    block = condense(model, scene, span, lateral, np.column_stack(forces) if forces else None)
    found = loaded(block, scene, [kind for kind in kinds if kind != "torsion"])
    if "torsion" in kinds:
        found["torsion"] = twisted(block, scene)
    return found


def loaded(block: Superelement, scene: Scene, kinds: Collection[FieldKind]) -> dict[FieldKind, UnitField]:
    """Fields of some loads from a symmetric condensation, or that of a whole throw.

    Args:
        kinds: those of `tangential` and `centrifugal` are the block's further loads, in this order.
    """
    further: list[FieldKind] = [kind for kind in kinds if kind in ("tangential", "centrifugal")]
    turn = np.array([1.0 if m == RX else 0.0 for m in block.motions])
    cases: dict[FieldKind, tuple[Array, Array]] = {"moment": (np.zeros(len(block.displacement)), turn)}
    if "bending" in kinds:
        field = block.displacement[:, len(block.motions)]
        cases["bending"] = (field / (block.copies * block.parts), block.load / block.copies)
    start = block.displacement.shape[1] - len(further)
    for column, kind in enumerate(further):
        cases[kind] = (block.displacement[:, start + column], block.extra_loads[:, column])
    spring = support_spring(scene, scene.supports.bending)
    found: dict[FieldKind, UnitField] = {}
    for kind in kinds:
        fixed, force = cases[kind]
        sideways = kind == "tangential"
        # Held, the half takes its half of the torque; a whole throw that may turn takes equal ones.
        turning = not sideways or block.copies == 1
        motion = bending_motion(block, force, scene.supports.bending, spring, turning=turning)
        found[kind] = UnitField(kind, fixed + _units(block) @ motion, -1 if sideways else 1, 1)
    return found


def _force(model: Elasticity, scene: Scene, kind: FieldKind, span: Span, lateral: Lateral) -> Array:
    """Nodal forces on the model of a unit load of the full throw, which models like it make up."""
    if kind == "centrifugal":
        return centrifugal_force(model, density_tonne_per_mm3(scene.material.density_kg_m3))
    models = (1 if span == "whole" else 2) * (1 if lateral == "none" else 2)
    return mean_displacement(model, 0, *loaded_mm(scene, span == "whole")) / models


def _units(block: Superelement) -> Array:
    return block.displacement[:, : len(block.motions)]


def support_spring(scene: Scene, support: Literal["free", "held", "pinned", "clamped", "spring"]) -> float:
    """Stiffness of the bearing spring of a support, N/mm; 0 for others."""
    return required_bearing_spring_N_per_mm(scene) if support == "spring" else 0.0
