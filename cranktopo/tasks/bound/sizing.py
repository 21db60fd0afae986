"""Cells of variable stiffness under constraints: the densities whose displacements prove most.

The modulus is linear in the density, so the problem is convex. Each step solves it with compliances linear in
the reciprocals of the densities, which has a closed form but for one weight per constraint (convex
linearisation; C. Fleury, V. Braibant, IJNME 23, 1986; one constraint on the mass: optimality criteria).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.goal.constraint import Constraint
from cranktopo.tasks.bound.certificate import LinearUnderestimator

MINIMUM_DENSITY = 1e-3
"""Least density while the displacements are sought, so that cells can come back."""
_MOVE = 0.3
_LARGEST_WEIGHT = 1e3


def next_densities(
    underestimator: LinearUnderestimator,
    cases: int,
    density: Array,
    goal: Array,
    constraints: Sequence[Constraint],
    weights: Array,
) -> tuple[Array, Array]:
    """Return the densities after one step and the weights of the constraints.

    Args:
        underestimator: of the displacements of the web with these densities.
        cases: number of load cases, whose compliances come first among the quantities.
        goal: weights of the quantities in what is minimised.
        weights: to begin with.
    """
    low, high = np.maximum(density - _MOVE, MINIMUM_DENSITY), np.minimum(density + _MOVE, 1.0)
    gains, amounts = -underestimator.rows[:cases] * density**2, underestimator.rows[cases:]
    base = underestimator.base.copy()
    base[:cases] += 2 * np.tensordot(underestimator.rows[:cases], density, 3)
    signs = np.array([c.sign for c in constraints])
    limits = np.array([c.bound for c in constraints])
    at = np.array([underestimator.names.index(c.quantity) for c in constraints], int)

    def densities(y: Array) -> tuple[Array, Array]:
        normal = goal.copy()
        np.add.at(normal, at, y * signs)
        above, below = np.tensordot(normal[:cases], gains, 1), np.tensordot(normal[cases:], amounts, 1)
        ratio = np.where(below > 0, above / np.where(below > 0, below, 1.0), 1.0)
        found = np.where((above <= 0) & (below <= 0), density, np.sqrt(np.maximum(ratio, 0.0)))
        return np.clip(underestimator.webs.made(found, above, below), low, high), normal

    def loss(y: Array) -> tuple[float, Array]:
        found, normal = densities(y)
        told = base + np.concatenate([np.tensordot(gains, 1 / found, 3), np.tensordot(amounts, found, 3)])
        excess = signs * (told[at] - limits)
        return -float(normal @ told - y @ (signs * limits)), -excess

    if len(constraints):
        from scipy.optimize import minimize

        box = [(0.0, _LARGEST_WEIGHT)] * len(constraints)
        weights = minimize(loss, weights, jac=True, method="L-BFGS-B", bounds=box).x
    return densities(weights)[0], weights
