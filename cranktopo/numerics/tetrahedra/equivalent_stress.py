"""Equivalent and principal stresses of stresses given by their six components."""

from __future__ import annotations

import numpy as np

from cranktopo.base.arrays import Array

DEVIATOR = np.zeros((6, 6))
DEVIATOR[:3, :3] = 1.5 * np.eye(3) - 0.5
DEVIATOR[3:, 3:] = 3 * np.eye(3)
"""Quadratic form of the squared von Mises stress in the six components."""


def von_mises(stress: Array) -> Array:
    """Von Mises stress; last axis holds the six components."""
    squared: Array = np.einsum("...i,ij,...j->...", stress, DEVIATOR, stress)
    return np.sqrt(np.maximum(squared, 0.0))


def principal_stresses(stress: Array) -> Array:
    """Principal stresses, falling, in the last axis; that of the argument holds the six components."""
    tensor = stress[..., [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(*stress.shape[:-1], 3, 3)
    return np.asarray(np.linalg.eigvalsh(tensor)[..., ::-1], dtype=np.float64)
