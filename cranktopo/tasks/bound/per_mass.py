"""Stiffness per mass over all masses: lines below the compliance as a function of the mass, and the corner
where their product is least.

With displacements v and a slope t, every web obeys compliance + t * mass >= D(t). Some such lines enclose all
pairs of mass and compliance in a convex polygon. The product is concave along each line, so that its least
value in the polygon is at a corner.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.goal.constraint import Constraint
from cranktopo.tasks.bound.certificate import Certificate, LinearUnderestimator, best_certificate

_LINES = 13
_SPAN = 3.0
_ROUNDING = 1e-12


@dataclass(frozen=True)
class SupportingLine:
    """Every web has compliance + slope * mass >= offset.

    Attributes:
        weights: of the constraints that prove it.
    """

    slope: float
    offset: float
    weights: Array


def supporting_lines(
    underestimator: LinearUnderestimator,
    goal: Array,
    mass: Array,
    constraints: Sequence[Constraint],
    first: Array,
    slope: float,
) -> list[SupportingLine]:
    """Return lines below the pairs of mass and compliance of every web that keeps the constraints.

    Args:
        goal, mass: weights of the quantities that make the compliance and the mass.
        constraints: without those of the mass, which `minimum_product` takes.
        first: weights of the constraints to begin with.
        slope: of the compliance over the mass where the least product is expected, made positive.
    """
    lines, weights = [], first
    for t in (0.0, *(slope * np.geomspace(1 / _SPAN, _SPAN, _LINES))):
        certificate = best_certificate(underestimator, goal + t * mass, constraints, weights)
        weights = weights if np.isinf(certificate.value) else certificate.weights
        lines.append(SupportingLine(float(t), certificate.value, weights))
    return lines


def minimum_product(lines: Sequence[SupportingLine], low: float, high: float) -> tuple[Certificate, float]:
    """Return a lower bound of compliance times mass between two masses, and the slope that suits its corner.

    A convex curve through the corner on which no other product is smaller has that slope.
    """
    slopes, offsets = np.array([line.slope for line in lines]), np.array([line.offset for line in lines])
    if low > high or np.isinf(offsets).any():
        return Certificate(np.inf, lines[0].weights), 0.0
    first, second = np.triu_indices(len(slopes), 1)
    apart = slopes[first] != slopes[second]
    first, second = first[apart], second[apart]
    corners = (offsets[first] - offsets[second]) / (slopes[first] - slopes[second])
    masses = np.array([low, high, *corners[(corners > low) & (corners < high)]])
    above = offsets[:, None] - slopes[:, None] * masses
    products = masses * np.max(above, axis=0)
    worst = int(np.argmin(products))
    slope = float(above[:, worst].max() / masses[worst])
    line = lines[int(np.argmax(above[:, worst]))]
    return Certificate(float(products[worst]) * (1 - _ROUNDING), line.weights), slope


def mass_range(
    underestimator: LinearUnderestimator, mass: Array, constraints: Sequence[Constraint]
) -> tuple[float, float]:
    """Return the least and greatest mass of the webs, within the constraints of the mass."""
    low, high = underestimator.minimum(mass)[0], -underestimator.minimum(-mass)[0]
    limits = [c for c in constraints if c.quantity == "mass"]
    return (
        max([low, *(c.bound for c in limits if c.sign < 0)]),
        min([high, *(c.bound for c in limits if c.sign > 0)]),
    )
