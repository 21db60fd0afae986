"""Every support of a throw as algebra on its condensed matrices: no new solve."""

from __future__ import annotations

from collections.abc import Set
from typing import Literal

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.units import NMM_PER_NM
from cranktopo.tasks.fea.condense import RX, RY, RZ, UX, UY, UZ, Superelement

TorsionSupport = Literal["free", "held", "spring"]
BendingSupport = Literal["pinned", "clamped", "spring"]


_ALL = frozenset({UX, UY, UZ, RX, RY, RZ})
_TORSION: dict[TorsionSupport, frozenset[int]] = {
    "free": _ALL,
    "held": frozenset({RZ, UZ}),
    "spring": _ALL,
}
_BENDING: dict[BendingSupport, frozenset[int]] = {
    "pinned": frozenset({UZ, RX, RY, RZ}),
    "clamped": frozenset({UZ}),
    "spring": _ALL,
}
"""Motions that each support leaves to each section."""


def torsional_stiffness_Nm_per_rad(
    block: Superelement, support: TorsionSupport, spring_N_per_mm: float = 0.0
) -> float:
    """Torsional stiffness of the full throw: torque over relative rotation of its sections, T / (2 phi).

    Args:
        block: antisymmetric or whole block holding ux, ry, rz (and more).
        support: "free" to translate and tilt, "held" against both, "spring" radial springs.
    """
    twist = torque_ends(block) @ torsion_motion(block, support, spring_N_per_mm)
    return 1.0 / (block.copies * float(twist)) / NMM_PER_NM


def torque_ends(block: Superelement) -> Array:
    """A torque of 1 N mm on the section of the half throw, opposite ones on both of the whole, shape (m,).

    Times a motion it is the rotation of the section, or that of the far section relative to the near one.
    """
    near = 1.0 if block.copies == 2 else -1.0
    return np.array([{RZ: near, 6 + RZ: 1.0}.get(m, 0.0) for m in block.motions])


def bending_stiffness_N_per_mm(
    block: Superelement, support: BendingSupport, spring_N_per_mm: float = 0.0
) -> float:
    """Bending stiffness of the full throw: pin force over mean radial displacement of the pin material.

    Args:
        block: symmetric or whole block holding uy, uz, rx (and more).
        support: "pinned" section centre, "clamped" (no tilt either), or "spring" radial springs.
    """
    motion = bending_motion(block, block.load, support, spring_N_per_mm)
    return block.copies / (block.load_compliance + float(block.load @ motion))


def torsion_motion(
    block: Superelement, support: TorsionSupport, spring_N_per_mm: float = 0.0, force: Array | None = None
) -> Array:
    """Section motion under section forces, shape (m,), mm and rad.

    Args:
        force: on the section of the half throw, shape (m,), N and N mm; by default `torque_ends`.
    """
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
    """Section motion under section forces, shape (m,), mm and rad.

    Args:
        force: on the section of the half throw, shape (m,), N and N mm.
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
