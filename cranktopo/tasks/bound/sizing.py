"""Cells of variable stiffness under ceilings: the densities whose displacements prove most.

The modulus is linear in the density, so the problem is convex. Each step solves it with compliances linear in
the reciprocals of the densities, which has a closed form but for one weight per ceiling (convex
linearisation; C. Fleury, V. Braibant, IJNME 23, 1986; one ceiling on the mass: optimality criteria).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.tasks.bound.proof import Plane
from cranktopo.tasks.bound.requirements import Ceiling

LEAST = 1e-3
"""Least density while the displacements are sought, so that cells can come back."""
_MOVE = 0.3
_LARGEST_WEIGHT = 1e3


def next_densities(
    plane: Plane, cases: int, density: Array, goal: Array, ceilings: Sequence[Ceiling], weights: Array
) -> tuple[Array, Array]:
    """The densities after one step and the weights of the ceilings.

    Args:
        plane: of the displacements of the web with these densities.
        cases: number of load cases, whose compliances come first among the quantities.
        goal: weights of the quantities in what is minimised.
        weights: to begin with.
    """
    low, high = np.maximum(density - _MOVE, LEAST), np.minimum(density + _MOVE, 1.0)
    gains, amounts = -plane.rows[:cases] * density**2, plane.rows[cases:]
    base = plane.base.copy()
    base[:cases] += 2 * np.tensordot(plane.rows[:cases], density, 3)
    signs = np.array([c.sign for c in ceilings])
    limits = np.array([c.limit for c in ceilings])
    at = np.array([plane.names.index(c.quantity) for c in ceilings], int)

    def densities(y: Array) -> tuple[Array, Array]:
        normal = goal.copy()
        np.add.at(normal, at, y * signs)
        above, below = np.tensordot(normal[:cases], gains, 1), np.tensordot(normal[cases:], amounts, 1)
        ratio = np.where(below > 0, above / np.where(below > 0, below, 1.0), 1.0)
        found = np.where((above <= 0) & (below <= 0), density, np.sqrt(np.maximum(ratio, 0.0)))
        return np.clip(plane.webs.made(found, above, below), low, high), normal

    def loss(y: Array) -> tuple[float, Array]:
        found, normal = densities(y)
        told = base + np.concatenate([np.tensordot(gains, 1 / found, 3), np.tensordot(amounts, found, 3)])
        excess = signs * (told[at] - limits)
        return -float(normal @ told - y @ (signs * limits)), -excess

    if len(ceilings):
        from scipy.optimize import minimize

        box = [(0.0, _LARGEST_WEIGHT)] * len(ceilings)
        weights = minimize(loss, weights, jac=True, method="L-BFGS-B", bounds=box).x
    return densities(weights)[0], weights
