"""Neighbouring throws joined at their mid-journal sections: the whole shaft from condensed matrices."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.frames import Span
from cranktopo.base.result import Result
from cranktopo.base.units import NMM_PER_NM
from cranktopo.design.schema import Scene
from cranktopo.numerics.section_shapes import WARPS, warps_turned
from cranktopo.numerics.tetrahedra.elasticity import Elasticity
from cranktopo.numerics.tetrahedra.rigid_motions import RX, RY, RZ, UX, UY
from cranktopo.numerics.tetrahedra.superelement import Superelement
from cranktopo.tasks.throw_fea.condense import Lateral, condense

Bearings = Literal["free", "rigid", "spring"]
ShaftBearings = Literal["free", "rigid", "spring", "clearance", "film"]
"""Those of a shaft over the cycle: with play or oil films its stiffness end to end is that in rigid ones."""

MIRROR = np.diag([1.0, 1.0, -1.0, -1.0, -1.0, 1.0])
"""Motion of the far section in the mirror z -> pitch - z of a motion of the near one."""
SPLITS: dict[Span, Array] = {
    "symmetric": np.hstack([np.eye(6), MIRROR]) / 2,
    "antisymmetric": np.hstack([np.eye(6), -MIRROR]) / 2,
    "whole": np.eye(12),
}
"""Motions of both sections that the motions of a block are, (motions of the block, 12)."""
_WARP_MIRROR = np.diag([1.0, 1.0, -1.0, -1.0, -1.0, -1.0])
WARP_SPLITS: dict[Span, Array] = {
    "symmetric": np.hstack([np.eye(WARPS), _WARP_MIRROR]) / 2,
    "antisymmetric": np.hstack([np.eye(WARPS), -_WARP_MIRROR]) / 2,
    "whole": np.eye(2 * WARPS),
}
"""The same of the warps of the sections, (warps of the block, 2 `WARPS`)."""
SECTIONS = 12 + 2 * WARPS
"""Unknowns of both sections of a throw: the motions of the near and the far one, then their warps."""
_LENGTH_MM = 50.0
"""Scales rotations to displacements where a rank is decided."""


def linear_bearings(bearings: ShaftBearings) -> Bearings:
    """Return bearings of that kind without play and oil, in which a torque bends no shaft."""
    return "rigid" if bearings == "clearance" or bearings == "film" else bearings


class ShaftStiffness(Result):
    """Torsion of a whole shaft under equal and opposite end torques.

    Attributes:
        end_to_end_Nm_per_rad: torque over relative rotation of the end sections.
        throws_Nm_per_rad: the same for the two sections of each throw in the assembled shaft.
    """

    end_to_end_Nm_per_rad: float
    throws_Nm_per_rad: tuple[float, ...]

    def by_name(self) -> dict[str, float]:
        """Return every stiffness, N m/rad, by what it is of."""
        throws = {f"throw {number}": k for number, k in enumerate(self.throws_Nm_per_rad, start=1)}
        return {"end to end": self.end_to_end_Nm_per_rad, **throws}


def throw_blocks(
    model: Elasticity, scene: Scene, mirrored: bool, *, whole: bool = False
) -> list[tuple[Span, Superelement]]:
    """Return the half throw condensed over all six motions of its section, symmetric and antisymmetric.

    Args:
        mirrored: the model is the half x >= 0 of it.
        whole: the model is the whole throw, condensed over the motions of both sections.

    Raises:
        CranktopoError: a failed solve.
    """
    found = symmetries(mirrored, whole)
    return [(span, condense(model, scene, span, lateral)) for span, lateral in found]


def symmetries(mirrored: bool, whole: bool) -> list[tuple[Span, Lateral]]:
    """Return the symmetries in which a model is condensed, of the arguments of `throw_blocks`."""
    laterals: tuple[Lateral, ...] = ("even", "odd") if mirrored else ("none",)
    spans: tuple[Span, ...] = ("whole",) if whole else ("symmetric", "antisymmetric")
    return [(span, lateral) for span in spans for lateral in laterals]


def throw_matrix(blocks: Sequence[tuple[Span, Superelement]], forms: Sequence[Array] | None = None) -> Array:
    """Stiffness of the full throw over the six motions of its near and then its far section, (12, 12).

    Each section moves in its own axes, parallel to those of the throw; units mm, rad, N, N mm.

    Args:
        blocks: of `throw_blocks`.
        forms: another form of each block, over its motions first.
    """
    total = np.zeros((12, 12))
    for (span, block), form in zip(blocks, forms or [b.stiffness for _, b in blocks], strict=True):
        count = len(block.motions)
        split = SPLITS[span][list(block.motions)]
        total += block.copies * split.T @ form[:count, :count] @ split
    return total


def shaft_matrix(throws: Array, angles_deg: Sequence[float]) -> Array:
    """Stiffness of a shaft of throws turned about z, right-handed, over its unknowns (`own_unknowns`).

    Args:
        throws: matrices of the throws over their motions, (n, 12, 12), or `SECTIONS`; or one of all of them.
    """
    count, own = len(angles_deg), throws.shape[-1]
    shaft = np.zeros((own // 2 * (count + 1),) * 2)
    every = np.broadcast_to(throws, (count, own, own))
    for index, angle in enumerate(angles_deg):
        turn, at = turned(angle, own), own_unknowns(index, count, own)
        shaft[np.ix_(at, at)] += turn @ every[index] @ turn.T
    return shaft


def own_unknowns(index: int, throws: int, own: int) -> NDArray[np.intp]:
    """Return where so many unknowns of a throw are in a shaft: motions of all sections, then all warps."""
    first, warps = 6 * index, own // 2 - 6
    after = 6 * (throws + 1) + warps * index
    return np.r_[first : first + 12, after : after + 2 * warps]


def shaft_stiffness(
    shaft: Array,
    bearings: Bearings,
    spring_N_per_mm: float = 0.0,
    carried: Sequence[int] | None = None,
    tilt_Nmm_per_rad: float = 0.0,
) -> ShaftStiffness:
    """Torsional stiffness of a shaft on bearings.

    Args:
        bearings: "rigid" fixes each section's centre radially, "spring" supports it, "free" does not; every
            bearing lets the section turn and move axially.
        carried: sections that sit in a bearing; all by default.
        tilt_Nmm_per_rad: stiffness by which bearings, but free ones, resist the tilt of their journals.
    """
    sections = shaft.shape[0] // 6
    stiffness = shaft.copy()
    borne = range(sections) if carried is None else carried
    radial = [6 * s + m for s in borne for m in (UX, UY)]
    if bearings != "free":
        tilting = [6 * s + m for s in borne for m in (RX, RY)]
        stiffness[tilting, tilting] += tilt_Nmm_per_rad
    if bearings == "spring":
        stiffness[radial, radial] += spring_N_per_mm
    held = set(radial) if bearings == "rigid" else set()
    kept = [i for i in range(shaft.shape[0]) if i not in held]
    torque = np.zeros(shaft.shape[0])
    torque[RZ], torque[6 * (sections - 1) + RZ] = -1.0, 1.0
    twist = np.zeros(shaft.shape[0])
    twist[kept] = _solve_singular(stiffness[np.ix_(kept, kept)], torque[kept], kept)
    steps = np.diff(twist[RZ::6])
    per_throw = tuple(float(1.0 / step / NMM_PER_NM) for step in steps)
    end_to_end = float(1.0 / steps.sum() / NMM_PER_NM)
    return ShaftStiffness(end_to_end_Nm_per_rad=end_to_end, throws_Nm_per_rad=per_throw)


def turned(angle_deg: float, unknowns: int = 12) -> Array:
    """Return the right-handed rotation about z of the motions of a throw, or of all its `SECTIONS`."""
    angle = math.radians(angle_deg)
    rotation = np.array(
        [[math.cos(angle), -math.sin(angle), 0.0], [math.sin(angle), math.cos(angle), 0.0], [0.0, 0.0, 1.0]]
    )
    found = np.eye(unknowns)
    found[:12, :12] = np.kron(np.eye(4), rotation)
    if unknowns > 12:
        found[12:, 12:] = np.kron(np.eye(2), warps_turned(angle))
    return found


def _solve_singular(matrix: Array, force: Array, kept: list[int]) -> Array:
    """Least-norm motion under balanced forces; rigid motions of the whole shaft are free."""
    scale = np.array([1.0 if i % 6 < RX else 1.0 / _LENGTH_MM for i in kept])
    scaled = matrix * np.outer(scale, scale)
    return np.asarray(scale * (np.linalg.pinv(scaled, rcond=1e-9, hermitian=True) @ (scale * force)))
