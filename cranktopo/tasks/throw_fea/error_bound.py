"""Bounds of the discretisation error: of one stiffness, and of the difference between two.

Their factors are calibrated on throws drawn at random and checked on others (docs/pages/accuracy.md).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.numerics.tetrahedra.hierarchical_error import DiscretisationError
from cranktopo.numerics.tetrahedra.superelement import Superelement
from cranktopo.tasks.throw_fea.condense import (
    BendingSupport,
    TorsionSupport,
    bending_motion,
    torque_ends,
    torsion_motion,
)

_SURPLUS_FACTOR = 2.2
"""Bound over the cubic surplus.

The error is 1.4 to 1.6 times the surplus with fillets and up to 2 times at sharp rings: each function answers
alone, and what lies beyond cubic displacements is left out (`python -m tests.benchmarks.error_bounds`).
"""
_STRAIGHT_FACTOR = 1.5
"""Bound over the energy that straightened elements add to first order."""
TORSION_VOLUME_FACTOR, BENDING_VOLUME_FACTOR = 6.0, 24.0
"""Relative change of a stiffness over that of the volume, at most, where nothing else is known of the shape.

The edges of curved elements are parabolas, and off the surface most in fillets, where the material works
hardest.
"""
_CHANGE_FACTOR = 3.0
"""Bound over the change from a mesh 1.5 times coarser, where the surface itself is remeshed each time.

Three is what P. J. Roache takes for two grids (Perspective: a method for uniform reporting of grid refinement
studies, J. Fluids Eng. 116, 1994).
"""

_DIFFERENCE_SPREAD, _DIFFERENCE_UNEQUAL = 0.15, 1.0
"""Bound of the error of a difference over the mean of two bounds, and over the difference between these."""


def torsion_bound_percent(
    block: Superelement, missed: DiscretisationError, support: TorsionSupport, spring_N_per_mm: float = 0.0
) -> float:
    """Return the bound of the torsional stiffness's relative error by an antisymmetric block, %."""
    forms = (missed.surplus, missed.straight)
    surplus, straight = torsion_shares(block, forms, support, spring_N_per_mm)
    return bound_percent(surplus, straight, missed.volume_error, TORSION_VOLUME_FACTOR)


def bending_bound_percent(
    block: Superelement, missed: DiscretisationError, support: BendingSupport, spring_N_per_mm: float = 0.0
) -> float:
    """Return the bound of the bending stiffness's relative error by a symmetric block, %."""
    forms = (missed.surplus, missed.straight)
    surplus, straight = bending_shares(block, forms, support, spring_N_per_mm)
    return bound_percent(surplus, straight, missed.volume_error, BENDING_VOLUME_FACTOR)


def torsion_shares(
    block: Superelement, forms: Sequence[Array], support: TorsionSupport, spring_N_per_mm: float = 0.0
) -> list[float]:
    """Return the shares of the twist under a torque that energies over the fields of a block would add."""
    motion, count = torsion_motion(block, support, spring_N_per_mm), len(block.motions)
    twist = float(torque_ends(block) @ motion)
    return [float(motion @ form[:count, :count] @ motion) / twist for form in forms]


def bending_shares(
    block: Superelement, forms: Sequence[Array], support: BendingSupport, spring_N_per_mm: float = 0.0
) -> list[float]:
    """Return the shares of the mean pin displacement that energies over the fields of a block would add."""
    motion = bending_motion(block, block.load, support, spring_N_per_mm)
    displacement = block.load_compliance + float(block.load @ motion)
    amplitudes = np.append(motion, 1.0 / block.parts)
    return [float(amplitudes @ form @ amplitudes) / displacement for form in forms]


def bound_percent(surplus: float, straight: float, volume_error: float, volume_factor: float) -> float:
    """Return the bound of a stiffness's relative error, %.

    Args:
        surplus: share of the displacement under load that cubic displacements would add.
        straight: share of it that straightened elements miss.
    """
    shape = _STRAIGHT_FACTOR * abs(straight) + volume_factor * abs(volume_error)
    return 100 * (_SURPLUS_FACTOR * surplus + shape)


def change_bound_percent(coarse: Mapping[str, float | None], fine: Mapping[str, float | None]) -> float:
    """Return the bound of the relative error by what a mesh 1.5 times coarser gives, %.

    The largest over all of them: two unstructured meshes may happen to agree in one support; hardly in all.
    """
    pairs = [(coarse[name], value) for name, value in fine.items()]
    return _CHANGE_FACTOR * max(100 * abs(high / low - 1) for high, low in pairs if high and low)


def difference_bound_percent(one: float, other: float, *, triangles: bool = False) -> float:
    """Return the bound of the error of the relative difference between two stiffnesses, %.

    Finite elements are too stiff, so both errors go the same way, and on meshes made by the same rules they
    are nearly equal where the bounds are.

    Args:
        triangles: one of the bodies is a surface of triangles, which meshes replace each in its own way.
    """
    larger = max(one, other)
    if triangles:
        return larger
    return min(larger, _DIFFERENCE_SPREAD * (one + other) / 2 + _DIFFERENCE_UNEQUAL * abs(one - other))
