"""The inequality that every web of an envelope obeys, and the weights that make it say most.

For any displacements the quantities of a web are not below q(rho) = base + rows . rho, and equal to it for
sums over cells. With a weight y >= 0 for each constraint s (q - limit) <= 0, the goal of every web that keeps
them is not below

    D(y) = least over rho of  n . q(rho) - y . (s limit),      n = goal + sum of y s,

whatever y is. D is concave in y, its slope s (q - limit) at the best densities. All quantities are over those
of the original web.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.goal.constraint import Constraint
from cranktopo.tasks.bound.energies import ROUNDING, Energies
from cranktopo.tasks.bound.webs import AdmissibleDensities

_CUTS = 60
_ENOUGH = 1e-4
"""Share of the bound by which better weights could still raise it when their search ends."""
_LARGEST_WEIGHT = 1e4


@dataclass(frozen=True)
class LinearUnderestimator:
    """Lower bounds of the quantities, linear in the densities.

    Attributes:
        names: load cases, then sums over cells.
        base: (quantities,).
        rows: (quantities, nx, ny, nw).
        sizes: (quantities,) largest sizes of the terms, for the rounding.
    """

    names: tuple[str, ...]
    base: Array
    rows: Array
    sizes: Array
    webs: AdmissibleDensities

    def minimum(self, weights: Array) -> tuple[float, Array]:
        """Not above the least weighted sum of the quantities over all webs, and the quantities there."""
        gains = -np.tensordot(weights, self.rows, 1)
        most, density = self.webs.best(gains)
        value = float(weights @ self.base) - most - ROUNDING * float(np.abs(weights) @ self.sizes)
        return value, self.base + np.tensordot(self.rows, density, 3)


def underestimator_of(
    webs: AdmissibleDensities,
    cases: Sequence[str],
    proven: Energies,
    original: Mapping[str, float],
    works: Mapping[str, float],
) -> LinearUnderestimator:
    """What displacements prove, every quantity over that of the original web.

    Args:
        works: compliances of the original web by load case, N mm.
    """
    cells = np.array([works[case] for case in cases])
    sums = tuple(webs.amounts)
    scale = np.concatenate([cells, [original[name] or 1.0 for name in sums]])
    base = np.concatenate([proven.constant, [webs.fixed_amounts[name] for name in sums]])
    rows = np.concatenate([-proven.gains, np.stack([webs.amounts[name] for name in sums])])
    rows = rows / scale[:, None, None, None]
    sizes = np.abs(base / scale) + np.abs(rows).sum(axis=(1, 2, 3))
    return LinearUnderestimator((*cases, *sums), base / scale, rows, sizes, webs)


@dataclass(frozen=True)
class Certificate:
    """A value that no web with these constraints can go below.

    Attributes:
        value: of the goal, over the original's; infinite where no web keeps all constraints.
        weights: of the constraints, (constraints,): by how much the goal's bound falls with each.
    """

    value: float
    weights: Array


def certificate_at(
    underestimator: LinearUnderestimator, goal: Array, constraints: Sequence[Constraint], weights: Array
) -> tuple[Certificate, Array]:
    """What the inequality says with given weights, and its slope by them.

    Args:
        goal: weights of the quantities in what is minimised.
    """
    signs = np.array([c.sign for c in constraints])
    limits = np.array([c.bound for c in constraints])
    at = np.array([underestimator.names.index(c.quantity) for c in constraints], int)
    normal = goal.copy()
    np.add.at(normal, at, weights * signs)
    value, quantities = underestimator.minimum(normal)
    price = weights * signs * limits
    found = value - float(price.sum()) - ROUNDING * float(np.abs(price).sum())
    return Certificate(found, weights), signs * (quantities[at] - limits)


def best_certificate(
    underestimator: LinearUnderestimator, goal: Array, constraints: Sequence[Constraint], first: Array
) -> Certificate:
    """The largest lower bound of the goal over the weights, by cutting planes (Kelley, 1960).

    Args:
        first: weights to begin with.
    """
    from scipy.optimize import linprog

    certificate, slope = certificate_at(underestimator, goal, constraints, first)
    if not constraints:
        return certificate
    count, values, slopes, points = len(constraints), [certificate.value], [slope], [first]
    box = np.maximum(10 * first, 10.0)
    for _ in range(_CUTS):
        cuts = np.array(slopes)
        offsets = np.array(values) - np.einsum("kc,kc->k", cuts, np.array(points))
        found = linprog(
            np.append(np.zeros(count), -1.0),
            A_ub=np.hstack([-cuts, np.ones((len(cuts), 1))]),
            b_ub=offsets,
            bounds=[*((0.0, high) for high in box), (None, None)],
        )
        if not found.success or -found.fun - certificate.value <= _ENOUGH * max(1.0, abs(certificate.value)):
            if not found.success or not _widened(box, found.x[:-1], certificate.weights):
                return certificate
            continue
        weights = np.maximum(found.x[:-1], 0.0)
        tried, slope = certificate_at(underestimator, goal, constraints, weights)
        values, slopes, points = [*values, tried.value], [*slopes, slope], [*points, weights]
        if tried.value > certificate.value:
            certificate = tried
            if excluded(underestimator, constraints, weights):
                return Certificate(np.inf, weights)
        _widened(box, weights, certificate.weights)
    return certificate


def excluded(underestimator: LinearUnderestimator, constraints: Sequence[Constraint], weights: Array) -> bool:
    """Whether the constraints alone, with these weights, exclude every web."""
    total = weights.sum()
    if total <= 0:
        return False
    return (
        certificate_at(underestimator, np.zeros(len(underestimator.names)), constraints, weights / total)[
            0
        ].value
        > 0
    )


def _widened(box: Array, *points: Array) -> bool:
    """Whether the box of weights was too narrow for the best ones and has been widened."""
    hit = (np.max(points, axis=0) >= 0.999 * box) & (box < _LARGEST_WEIGHT)
    box[hit] *= 10
    return bool(hit.any())
