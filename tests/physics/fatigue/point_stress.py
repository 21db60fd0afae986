"""Stresses at quadrature points, by scikit-fem's own interpolation: nothing is brought to nodes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from skfem import Basis, ElementTetP2

from cranktopo.numerics.tetrahedra.elasticity import Elasticity
from cranktopo.numerics.tetrahedra.stress import hooke

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PointStress:
    """Stresses at the quadrature points.

    Attributes:
        points_mm: shape (3, elements, points).
        volume_mm3: quadrature weight of each point, shape (elements, points).
        stress_MPa: shape (fields, elements, points, 6), components xx, yy, zz, xy, yz, zx.
    """

    points_mm: Array
    volume_mm3: Array
    stress_MPa: Array


def point_stress(model: Elasticity, displacement_mm: Array, youngs_MPa: float, poisson: float) -> PointStress:
    """Stresses of displacement fields, shape (fields, unknowns), at four points of every element."""
    basis = Basis(model.mesh, ElementTetP2(), intorder=2)
    fields = displacement_mm.reshape(len(displacement_mm), -1, 3)
    slope = np.stack(
        [np.stack([np.asarray(basis.interpolate(u[:, i]).grad) for i in range(3)]) for u in fields]
    )
    strain = (slope + slope.swapaxes(1, 2)) / 2
    components = np.moveaxis(strain[:, (0, 1, 2, 0, 1, 2), (0, 1, 2, 1, 2, 0)], 1, -1)
    points = np.asarray(basis.global_coordinates())
    return PointStress(points, np.asarray(basis.dx), hooke(components, youngs_MPa, poisson))
