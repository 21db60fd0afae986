"""What a fatigue method sees of a point of the surface."""

from __future__ import annotations

from dataclasses import dataclass

from cranktopo.base.arrays import Array


@dataclass(frozen=True)
class LocalStress:
    """Cyclic stress at points of a surface.

    Attributes:
        amplitude_MPa: half the range of the signed equivalent stress, shape (n,).
        mean_MPa: its mean, shape (n,).
        gradient_per_mm: related stress gradient into the depth, shape (n,).
    """

    amplitude_MPa: Array
    mean_MPa: Array
    gradient_per_mm: Array
