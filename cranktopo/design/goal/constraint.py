"""A limit in the numbers of one model, and what a model that errs makes of it.

The error of a model is nearly the same for designs that are close to each other: as a factor, but for a
quantity that may be 0, such as an unbalance, as a difference.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

from cranktopo.design.goal.quantities import quantity_named

LimitSense = Literal["<=", ">="]
TOLERANCE = 5e-3
"""Violation, over the scale, with which a limit is still satisfied."""
ACTIVE = 1e-2
"""Share of its scale within which a limit decides the design."""
_MINIMUM_OFF_CENTRE = 0.01
"""Share of the largest unbalance that mass and inertia allow, by which small ones are measured."""
_MINIMUM_BALANCE_FACTOR = 10.0
"""Percent of the oscillating mass by which small balance factors are measured."""


@dataclass(frozen=True)
class Constraint:
    """A limit on a quantity: sign * (value - bound) / scale <= 0, in the quantity's unit in the model.

    `original` is the scale of a bound of zero, `minimum_scale` that of a limit on what may be 0.
    """

    quantity: str
    sense: LimitSense
    bound: float
    original: float = field(default=1.0, compare=False)
    minimum_scale: float = field(default=0.0, compare=False)

    @property
    def sign(self) -> float:
        """1 for an upper limit, -1 for a lower one."""
        return 1.0 if self.sense == "<=" else -1.0

    @property
    def scale(self) -> float:
        """Size by which a violation is measured."""
        return scale_of(self.bound, self.original, self.minimum_scale)

    @property
    def factor(self) -> float:
        """Sign over scale: derivative of the violation by the quantity."""
        return self.sign / self.scale

    def violation(self, value: float) -> float:
        """Return the share of its scale by which a value breaks the limit; negative where there is room."""
        return self.factor * (value - self.bound)

    def satisfied(self, value: float, tolerance: float = TOLERANCE) -> bool:
        """Tell whether a value keeps the limit, but for a share of its scale."""
        return self.violation(value) <= tolerance

    def active(self, value: float) -> bool:
        """Tell whether a value is at the limit or beyond it."""
        return self.violation(value) >= -ACTIVE

    def at(self, bound: float) -> Constraint:
        """Return the limit at another bound."""
        return replace(self, bound=bound)

    def corrected(self, errors: Mapping[str, float]) -> Constraint:
        """Return the limit for a model that errs."""
        if self.quantity not in errors:
            return self
        return self.at(with_error(self.quantity, self.bound, errors[self.quantity]))

    def tightened(self, share: float) -> Constraint:
        """Return the limit moved by a share of its scale."""
        return self.at(self.bound - share / self.factor)


def scale_of(value: float, original: float, minimum: float) -> float:
    """Return what a violation is measured by: the value, or the original's where that is 0."""
    return max(abs(value) or abs(original), minimum) or 1.0


def minimum_scale(quantity: str, original: Mapping[str, float]) -> float:
    """Return the minimum scale of a limit or a goal, for a quantity that may be 0; 0 for others.

    The unbalance of a body is at most the root of its mass times its inertia: its centre of mass is no
    farther out than its radius of gyration. Without mass and inertia of the original there is no minimum.
    """
    if quantity == "balance_factor":
        return _MINIMUM_BALANCE_FACTOR
    if not quantity_named(quantity).signed or not {"mass", "inertia"} <= original.keys():
        return 0.0
    return _MINIMUM_OFF_CENTRE * math.sqrt(original["mass"] * original["inertia"])


def model_error(quantity: str, in_model: float, better: float) -> float:
    """Return by how much a model overrates a quantity with a known better value: factor, or difference."""
    return in_model - better if quantity_named(quantity).signed else in_model / better


def with_error(quantity: str, value: float, error: float) -> float:
    """Return a better model's value as the model that errs has it."""
    return value + error if quantity_named(quantity).signed else value * error


def without_error(quantity: str, value: float, error: float) -> float:
    """Return a value of the model that errs as the better one has it."""
    return value - error if quantity_named(quantity).signed else value / error


def bound_in_model(quantity: str, required: float, in_model: float, better: float) -> float:
    """Return the bound in a model at which the better one of the same design has what is required."""
    return with_error(quantity, required, model_error(quantity, in_model, better))
