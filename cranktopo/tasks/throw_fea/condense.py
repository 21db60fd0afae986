"""The half throw condensed to the rigid motions of its mid-journal section, the whole one to those of both.

The mid-pin plane carries u_z = 0 for symmetric and u_x = u_y = 0 for antisymmetric motion. With the mirror
x = 0 each of the two splits again into motions even and odd in x.
A throw whose halves differ has no such plane: it is condensed whole, to six more motions of its far section.
The load is a radial force on the full pin, symmetric in z and even in x: its mean displacement is that of
-u_y over the pin's material.
"""

from __future__ import annotations

import math
from collections.abc import Set
from typing import Literal

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.frames import Span
from cranktopo.base.units import NMM_PER_NM
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, mean_displacement
from cranktopo.numerics.tetrahedra.rigid_motions import (
    RX,
    RY,
    RZ,
    UX,
    UY,
    UZ,
    held_by_mirror,
    plane_nodes,
)
from cranktopo.numerics.tetrahedra.solver import RESIDUAL_LIMIT
from cranktopo.numerics.tetrahedra.superelement import HeldBody, Superelement, superelement

Lateral = Literal["even", "odd", "none"]

_EVEN, _ODD = (UY, UZ, RX), (UX, RY, RZ)


def condense(
    model: Elasticity,
    scene: Scene,
    span: Span,
    lateral: Lateral,
    extra_loads: Array | None = None,
    residual: float = RESIDUAL_LIMIT,
) -> Superelement:
    """Condense the half or whole throw to the motions of its rigid sections.

    Args:
        extra_loads: nodal forces of loads on the model besides the pin's, of the same symmetry, shape
            (unknowns, k).

    Raises:
        CranktopoError: the solve failed, or a plane of the model is missing.
    """
    motions = {"even": _EVEN, "odd": _ODD, "none": tuple(range(6))}[lateral]
    body = _held_body(model, scene, span, lateral)
    loaded = span != "antisymmetric" and lateral != "odd"
    mean = -mean_displacement(model, 1, *loaded_mm(scene, span == "whole")) if loaded else None
    return superelement(model, body, motions, mean, extra_loads, residual)


def loaded_mm(scene: Scene, whole: bool) -> tuple[float, float]:
    """Return the heights between which the crankpin carries its load in the half or the whole throw."""
    start = scene.web_z_mm[1]
    return (start, scene.pitch_mm - halves(scene)[1].web_z_mm[1]) if whole else (start, math.inf)


def _held_body(model: Elasticity, scene: Scene, span: Span, lateral: Lateral) -> HeldBody:
    nodes_mm, whole = model.nodes_mm, span == "whole"
    sections = [plane_nodes(nodes_mm, 2, z) for z in ((0.0, scene.pitch_mm) if whole else (0.0,))]
    held = [(3 * section[:, None] + np.arange(3)).ravel() for section in sections]
    if not whole:
        held.append(held_by_mirror(nodes_mm, 2, scene.pitch_mm / 2, even=span == "symmetric"))
    if lateral != "none":
        held.append(held_by_mirror(nodes_mm, 0, 0.0, even=lateral == "even"))
    parts = 1 if lateral == "none" else 2
    return HeldBody(sections, np.unique(np.concatenate(held)), scene.pitch_mm, parts)


TorsionSupport = Literal["free", "held", "spring"]
BendingSupport = Literal["pinned", "clamped", "spring"]


_ALL = frozenset({UX, UY, UZ, RX, RY, RZ})
_TORSION: dict[TorsionSupport, frozenset[int]] = {"free": _ALL, "held": frozenset({RZ, UZ}), "spring": _ALL}
_BENDING: dict[BendingSupport, frozenset[int]] = {
    "pinned": frozenset({UZ, RX, RY, RZ}),
    "clamped": frozenset({UZ}),
    "spring": _ALL,
}
"""Motions that each support leaves to each section."""


def torsional_stiffness_Nm_per_rad(
    block: Superelement, support: TorsionSupport, spring_N_per_mm: float = 0.0
) -> float:
    """Return the torsional stiffness of the full throw: torque over relative rotation, T / (2 phi).

    Args:
        block: antisymmetric or whole block holding ux, ry, rz (and more).
    """
    twist = torque_ends(block) @ torsion_motion(block, support, spring_N_per_mm)
    return 1.0 / (block.copies * float(twist)) / NMM_PER_NM


def torque_ends(block: Superelement) -> Array:
    """Return a torque of 1 N mm on the section of the half throw, opposite ones on both of the whole, (m,).

    Times a motion it is the rotation of the section, or that of the far section relative to the near one.
    """
    near = 1.0 if block.copies == 2 else -1.0
    return np.array([{RZ: near, 6 + RZ: 1.0}.get(m, 0.0) for m in block.motions])


def bending_stiffness_N_per_mm(
    block: Superelement, support: BendingSupport, spring_N_per_mm: float = 0.0
) -> float:
    """Return the bending stiffness of the full throw: pin force over mean radial pin displacement.

    Args:
        block: symmetric or whole block holding uy, uz, rx (and more).
    """
    motion = bending_motion(block, block.load, support, spring_N_per_mm)
    return block.copies / (block.load_compliance + float(block.load @ motion))


def torsion_motion(
    block: Superelement, support: TorsionSupport, spring_N_per_mm: float = 0.0, force: Array | None = None
) -> Array:
    """Return the section motion under section forces, shape (m,), mm and rad."""
    force = torque_ends(block) if force is None else force
    return _response(block, _TORSION[support], _springs(support, spring_N_per_mm), force)


def bending_motion(
    block: Superelement,
    force: Array,
    support: BendingSupport,
    spring_N_per_mm: float = 0.0,
    *,
    turning: bool = True,
) -> Array:
    """Return the section motion under section forces, shape (m,), mm and rad.

    Args:
        turning: whether the section may turn about the crank axis; a tangential force needs a torque there.
    """
    released = _BENDING[support] - (frozenset() if turning else {RZ})
    return _response(block, released, _springs(support, spring_N_per_mm), force)


def _springs(support: str, spring_N_per_mm: float) -> dict[int, float]:
    return {UX: spring_N_per_mm, UY: spring_N_per_mm} if support == "spring" else {}


def _response(block: Superelement, released: Set[int], springs: dict[int, float], force: Array) -> Array:
    """Section motion under a section force, held motions at zero; rigid motions of the whole stay at zero."""
    kinds = [m % 6 for m in block.motions]
    index = [i for i, m in enumerate(kinds) if m in released]
    stiffness = block.stiffness + np.diag([springs.get(m, 0.0) for m in kinds])
    length = np.array([1.0 if m < RX else 1.0 / 50.0 for m in kinds])[index]
    scaled = stiffness[np.ix_(index, index)] * np.outer(length, length)
    motion = np.zeros(len(block.motions))
    motion[index] = length * (np.linalg.pinv(scaled, rcond=1e-7, hermitian=True) @ (length * force[index]))
    return motion
