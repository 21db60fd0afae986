"""A goal and its limits as numbers that a search can use: one objective, relative limits, their slopes."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.goal.constraint import Constraint, with_error
from cranktopo.design.goal.quantities import quantity_named


@dataclass(frozen=True)
class SearchGoal:
    """What a search minimises, and what it keeps.

    Attributes:
        quantity: the quantity of the goal.
        sign: 1 minimises it, -1 maximises it.
        scale: its value for the original web, which makes the objective one.
        shift: by how much a model overrates a quantity that may be 0.
    """

    quantity: str
    sign: float
    scale: float
    limits: tuple[Constraint, ...]
    shift: float = 0.0

    def objective(self, values: Mapping[str, float]) -> float:
        """The goal, smaller is better; 1 or -1 for the original web."""
        return self.sign * (values[self.quantity] - self.shift) / self.scale

    def objective_gradient(self, gradients: Mapping[str, Array]) -> Array:
        """Its gradient, (parameters,)."""
        return self.sign * gradients[self.quantity] / self.scale

    def violations(self, values: Mapping[str, float]) -> Array:
        """How far each limit is missed over its size, kept where <= 0."""
        return np.array([limit.violation(values[limit.quantity]) for limit in self.limits])

    def violation_gradients(self, gradients: Mapping[str, Array], parameters: int) -> Array:
        """Their gradients (limits, parameters)."""
        rows = [limit.factor * gradients[limit.quantity] for limit in self.limits]
        return np.array(rows).reshape(len(rows), parameters)

    def sensitivity_by_cell(self, by_cell: Mapping[str, Array], limits: Array) -> Array:
        """What the goal gains by emptying each cell, with the limits paid for at their prices.

        Args:
            by_cell: gradients of the quantities by the fill.
            limits: prices, change of the goal per relative change of each limit.
        """
        result = self.sign * by_cell[self.quantity] / self.scale
        for price, limit in zip(limits, self.limits, strict=True):
            result = result + price * limit.factor * by_cell[limit.quantity]
        return np.asarray(result)

    @property
    def quantities(self) -> tuple[str, ...]:
        """Every quantity that it speaks of."""
        return (self.quantity, *(limit.quantity for limit in self.limits))

    def corrected(self, errors: Mapping[str, float]) -> SearchGoal:
        """The same for a model that overrates some quantities by known errors, as `model_error` has them."""
        found = replace(self, limits=tuple(limit.corrected(errors) for limit in self.limits))
        if self.quantity not in errors:
            return found
        if quantity_named(self.quantity).signed:
            return replace(found, shift=self.shift + errors[self.quantity])
        return replace(found, scale=with_error(self.quantity, self.scale, errors[self.quantity]))

    def reserved(self, share: float, quantities: Collection[str] | None = None) -> SearchGoal:
        """The same with limits, or those of some quantities, that are tighter by a share of their sizes."""
        moved = tuple(
            limit.tightened(share) if quantities is None or limit.quantity in quantities else limit
            for limit in self.limits
        )
        return replace(self, limits=moved)
