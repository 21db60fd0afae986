"""Displacement fields under unit loads: load states and the stress of load cases are sums, no new solve."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.frames import Span
from cranktopo.base.notes import note
from cranktopo.base.side_by_side import side_by_side
from cranktopo.base.units import MPA_PER_GPA, NMM_PER_NM, angular_speed_rad_s
from cranktopo.design.halves import default_element_size_mm, require_equal_halves
from cranktopo.design.schema import Scene
from cranktopo.engine.bearings import required_bearing_spring_N_per_mm
from cranktopo.engine.load_case import LoadCase
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, assemble, mean_displacement, swing_force
from cranktopo.numerics.tetrahedra.rigid_motions import RX, RY
from cranktopo.numerics.tetrahedra.solver import RESIDUAL_LIMIT
from cranktopo.numerics.tetrahedra.stress import nodal_stress, von_mises
from cranktopo.numerics.tetrahedra.superelement import Superelement
from cranktopo.tasks.throw_fea.condense import (
    Lateral,
    bending_motion,
    condense,
    loaded_mm,
    torque_ends,
    torsion_motion,
)
from cranktopo.tasks.throw_fea.evaluation import mesh_target
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.throw_fea.turning_load import turning_load

FieldKind = Literal[
    "moment", "side_moment", "bending", "tangential", "swing", "torsion", "centrifugal", "shaft"
]
_KINDS: tuple[FieldKind, ...] = (
    "moment",
    "side_moment",
    "bending",
    "tangential",
    "swing",
    "torsion",
    "centrifugal",
)
_ODD = ("side_moment", "tangential", "swing", "torsion")
"""Loads that the mirror x -> -x turns around."""
AGAINST_TORQUE: tuple[FieldKind, ...] = ("tangential", "swing")
"""Loads that turn the throw about its axis, against torque at both sections."""
_FURTHER: tuple[FieldKind, ...] = (*AGAINST_TORQUE, "centrifugal")
"""Loads beside the radial one that are a condensation's further loads, in this order."""


@dataclass(frozen=True)
class UnitField:
    """Displacement of the half or whole throw, or of its half x >= 0, under one unit load of the full throw.

    Attributes:
        kind: "moment" 1 N mm about +x on the near section and its opposite on the far one (four-point
            bending); "side_moment" the same about +y; "bending" 1 N on the pin along -y; "tangential" 1 N on
            the pin along +x, against torque at both sections; "swing" 1 N mm about -z by the throw's own mass
            where an angular acceleration lets it push, against the same; "torsion" 1 N mm about +z on the
            near section and its opposite on the far one; "centrifugal" 1 rad2/s2 about the crank axis;
            "shaft" what neighbouring throws do to both sections, or a load with these held.
        sign_x, sign_z: +1 if the load is its own mirror image in x or the mid-pin plane, -1 if its opposite.
    """

    kind: FieldKind
    displacement_mm: Array
    sign_x: int
    sign_z: int


def unit_fields(
    model: Elasticity,
    scene: Scene,
    mirrored: bool,
    kinds: Collection[FieldKind],
    *,
    whole: bool = False,
    residual: float = RESIDUAL_LIMIT,
) -> tuple[UnitField, ...]:
    """Return the displacement fields of the load kinds that are asked for; the others cost no solve.

    In the order moment, side_moment, bending, tangential, swing, torsion, centrifugal.

    Raises:
        CranktopoError: a spring support without its stiffness, or a failed solve.
    """
    if whole:
        fields = _by_side(model, scene, mirrored, "whole", kinds, residual)
    else:
        symmetric, twist = side_by_side(
            lambda: _by_side(model, scene, mirrored, "symmetric", kinds, residual),
            lambda: _twisted(model, scene, mirrored, residual) if "torsion" in kinds else {},
        )
        fields = {**symmetric, **twist}
    return tuple(fields[kind] for kind in _KINDS if kind in fields)


def _twisted(model: Elasticity, scene: Scene, mirrored: bool, residual: float) -> dict[FieldKind, UnitField]:
    lateral: Lateral = "odd" if mirrored else "none"
    return {"torsion": twisted(condense(model, scene, "antisymmetric", lateral, None, residual), scene)}


def twisted(block: Superelement, scene: Scene) -> UnitField:
    """Return the field of a unit torque from the antisymmetric condensation, or that of a whole throw."""
    spring, ends = support_spring(scene, scene.supports.torsion), torque_ends(block)
    near = ends if block.copies == 2 else -ends
    motion = torsion_motion(block, scene.supports.torsion, spring, near)
    return UnitField("torsion", _units(block) @ motion, -1, -1)


def _by_side(
    model: Elasticity,
    scene: Scene,
    mirrored: bool,
    span: Span,
    kinds: Collection[FieldKind],
    residual: float,
) -> dict[FieldKind, UnitField]:
    laterals: tuple[Lateral, ...] = ("even", "odd") if mirrored else ("none",)
    found: dict[FieldKind, UnitField] = {}
    for lateral in laterals:
        parity = {"none": _KINDS, "odd": _ODD, "even": set(_KINDS) - set(_ODD)}[lateral]
        elsewhere = {"torsion"} if span == "symmetric" else set()
        solved = [kind for kind in _KINDS if kind in kinds and kind in parity and kind not in elsewhere]
        if solved:
            found |= _loaded(model, scene, span, lateral, solved, residual)
    return found


def _loaded(
    model: Elasticity, scene: Scene, span: Span, lateral: Lateral, kinds: list[FieldKind], residual: float
) -> dict[FieldKind, UnitField]:
    """Fields of some loads from one condensation, which holds the radial load already."""
    extra_loads: list[FieldKind] = [kind for kind in _FURTHER if kind in kinds]
    forces = [unit_force(model, scene, kind, span, lateral) for kind in extra_loads]
    block = condense(model, scene, span, lateral, np.column_stack(forces) if forces else None, residual)
    found = loaded(block, scene, [kind for kind in kinds if kind != "torsion"])
    if "torsion" in kinds:
        found["torsion"] = twisted(block, scene)
    return found


def loaded(block: Superelement, scene: Scene, kinds: Collection[FieldKind]) -> dict[FieldKind, UnitField]:
    """Return fields of some loads from a symmetric condensation, or that of a whole throw.

    Those of `tangential`, `swing` and `centrifugal` are the block's further loads, in this order.
    """
    extra_loads: list[FieldKind] = [kind for kind in _FURTHER if kind in kinds]
    turns: dict[FieldKind, int] = {"moment": RX, "side_moment": RY}
    cases: dict[FieldKind, tuple[Array, Array]] = {
        kind: (
            np.zeros(len(block.displacement)),
            np.array([{turn: 1.0, 6 + turn: -1.0}.get(m, 0.0) for m in block.motions]),
        )
        for kind, turn in turns.items()
    }
    if "bending" in kinds:
        field = block.displacement[:, len(block.motions)]
        cases["bending"] = (field / (block.copies * block.parts), block.load / block.copies)
    start = block.displacement.shape[1] - len(extra_loads)
    for column, kind in enumerate(extra_loads):
        cases[kind] = (block.displacement[:, start + column], block.extra_loads[:, column])
    spring = support_spring(scene, scene.supports.bending)
    found: dict[FieldKind, UnitField] = {}
    for kind in kinds:
        fixed, force = cases[kind]
        sideways = kind in AGAINST_TORQUE
        # Held, the half takes its half of the torque; a whole throw that may turn takes equal ones.
        turning = not sideways or block.copies == 1
        motion = bending_motion(block, force, scene.supports.bending, spring, turning=turning)
        found[kind] = UnitField(kind, fixed + _units(block) @ motion, -1 if kind in _ODD else 1, 1)
    return found


def unit_force(model: Elasticity, scene: Scene, kind: FieldKind, span: Span, lateral: Lateral) -> Array:
    """Return nodal forces on the model of a unit tangential, swing or centrifugal load of the full throw.

    Models like it make up the throw, and share the force on the pin.
    """
    if kind == "centrifugal":
        return turning_load(model, scene, span, lateral)
    models = (1 if span == "whole" else 2) * (1 if lateral == "none" else 2)
    if kind == "swing":
        return swing_force(model) / models
    return mean_displacement(model, 0, *loaded_mm(scene, span == "whole")) / models


def _units(block: Superelement) -> Array:
    return block.displacement[:, : len(block.motions)]


def support_spring(scene: Scene, support: Literal["free", "held", "pinned", "clamped", "spring"]) -> float:
    """Return the stiffness of the bearing spring of a support, N/mm; 0 for others."""
    return required_bearing_spring_N_per_mm(scene) if support == "spring" else 0.0


_NEIGHBOURS = 4
_HAIR_MM = 1e-6
UNIT_LOADS: dict[FieldKind, Callable[[LoadCase], float]] = {
    "bending": lambda case: case.radial_N,
    "tangential": lambda case: case.tangential_N,
    "torsion": lambda case: case.torque_Nm * NMM_PER_NM,
    "centrifugal": lambda case: angular_speed_rad_s(case.speed_rpm) ** 2,
}
"""Number of unit loads of each field in a load case."""


@dataclass(frozen=True)
class CaseStress:
    """Von Mises stress of load cases at the nodes of a half throw.

    Attributes:
        von_mises_MPa: shape (cases, n).
        mirrored: the nodes are those of the half x >= 0.
    """

    cases: tuple[LoadCase, ...]
    points_mm: Array
    von_mises_MPa: Array
    mirrored: bool
    element_size_mm: float

    def at(self, points_mm: Array) -> Array:
        """Return the stress at points of the surface, MPa, shape (cases, points).

        Mean of the nearest four nodes by the inverse of their distance: a node gives its own value.
        """
        from scipy.spatial import cKDTree

        where = np.array(points_mm, dtype=np.float64)
        if self.mirrored:
            where[:, 0] = np.abs(where[:, 0])
        distance, near = cKDTree(self.points_mm).query(where, k=_NEIGHBOURS)
        weight = 1 / np.maximum(distance, _HAIR_MM)
        weight /= weight.sum(axis=1, keepdims=True)
        return np.einsum("cpk,pk->cp", self.von_mises_MPa[:, near], weight)


def case_stress(
    target: Target,
    cases: Sequence[LoadCase],
    element_size_mm: float | None = None,
) -> CaseStress:
    """Return the von Mises stress of a target under load cases, one condensation per symmetry that they need.

    At sharp re-entrant edges it has no limit, and in fillets it needs the finer mesh of
    `stress_model.solve_stresses`: the largest value depends on the mesh, all but the neighbourhood of such
    edges does not.

    Raises:
        CranktopoError: impossible geometry or a failed solve.
    """
    require_equal_halves(target.scene)
    size = element_size_mm or default_element_size_mm(target.scene)
    note(f"{target.name}: stresses, element size {size:.3g} mm")
    meshed = mesh_target(target, size)
    youngs, poisson = target.scene.material.E_GPa * MPA_PER_GPA, target.scene.material.poisson
    model = assemble(meshed.mesh, youngs, poisson)
    kinds = [kind for kind, factor in UNIT_LOADS.items() if any(factor(case) for case in cases)]
    fields = unit_fields(model, target.scene, meshed.mesh.mirrored, kinds)
    share = np.array([[UNIT_LOADS[kind](case) for kind in (f.kind for f in fields)] for case in cases])
    found = nodal_stress(model, share @ np.stack([f.displacement_mm for f in fields]), youngs, poisson)
    stress = von_mises(found.nodal_MPa)
    return CaseStress(tuple(cases), model.nodes_mm.T, stress, meshed.mesh.mirrored, size)
