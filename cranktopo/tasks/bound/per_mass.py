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
from cranktopo.tasks.bound.proof import Plane, Proof, best_proof
from cranktopo.tasks.bound.requirements import Ceiling

_LINES = 13
_SPAN = 3.0
_ROUNDING = 1e-12


@dataclass(frozen=True)
class Line:
    """Every web has compliance + slope * mass >= offset.

    Attributes:
        weights: of the ceilings that prove it.
    """

    slope: float
    offset: float
    weights: Array


def lines_of(
    plane: Plane, goal: Array, mass: Array, ceilings: Sequence[Ceiling], first: Array, slope: float
) -> list[Line]:
    """Lines below the pairs of mass and compliance of every web that keeps the ceilings.

    Args:
        goal, mass: weights of the quantities that make the compliance and the mass.
        ceilings: without those of the mass, which `least_product` takes.
        first: weights of the ceilings to begin with.
        slope: of the compliance over the mass where the least product is expected, made positive.
    """
    lines, weights = [], first
    for t in (0.0, *(slope * np.geomspace(1 / _SPAN, _SPAN, _LINES))):
        proof = best_proof(plane, goal + t * mass, ceilings, weights)
        weights = weights if np.isinf(proof.value) else proof.weights
        lines.append(Line(float(t), proof.value, weights))
    return lines


def least_product(lines: Sequence[Line], low: float, high: float) -> tuple[Proof, float]:
    """A lower bound of compliance times mass between two masses, and the slope that suits its corner.

    A convex curve through the corner on which no other product is smaller has that slope.
    """
    slopes, offsets = np.array([line.slope for line in lines]), np.array([line.offset for line in lines])
    if low > high or np.isinf(offsets).any():
        return Proof(np.inf, lines[0].weights), 0.0
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
    return Proof(float(products[worst]) * (1 - _ROUNDING), line.weights), slope


def mass_range(plane: Plane, mass: Array, ceilings: Sequence[Ceiling]) -> tuple[float, float]:
    """Least and greatest mass of the webs, within the ceilings of the mass."""
    low, high = plane.least(mass)[0], -plane.least(-mass)[0]
    limits = [c for c in ceilings if c.quantity == "mass"]
    return (
        max([low, *(c.limit for c in limits if c.sign < 0)]),
        min([high, *(c.limit for c in limits if c.sign > 0)]),
    )
