"""Values of a model that errs beside those of a better one, and the size by which a limit is measured.

The error of a model is nearly the same for designs that are close to each other: as a factor, but for a
quantity that may be 0, such as an unbalance, as a difference.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from cranktopo.design.goal.quantities import quantity_named

_LEAST_OFF_CENTRE = 0.01
"""Share of the largest unbalance that mass and inertia allow, by which small ones are measured."""


def model_error(quantity: str, in_model: float, better: float) -> float:
    """By how much a model overrates a quantity whose better value is known: a factor, or a difference."""
    return in_model - better if quantity_named(quantity).signed else in_model / better


def with_error(quantity: str, value: float, error: float) -> float:
    """A better model's value as the model that errs has it."""
    return value + error if quantity_named(quantity).signed else value * error


def without_error(quantity: str, value: float, error: float) -> float:
    """A value of the model that errs as the better one has it."""
    return value - error if quantity_named(quantity).signed else value / error


def moved_bound(quantity: str, required: float, in_model: float, better: float) -> float:
    """Bound of a limit in a model at which the better one reaches what is required.

    Args:
        required: in the better model.
        in_model, better: values of the same design.
    """
    return with_error(quantity, required, model_error(quantity, in_model, better))


def least_size(quantity: str, original: Mapping[str, float]) -> float:
    """Least size of a limit or a goal, for a quantity that may be 0; 0 for others.

    The unbalance of a body is at most the root of its mass times its inertia: its centre of mass is no
    farther out than its radius of gyration.

    Args:
        original: values of the original web; without mass and inertia there is no least size.
    """
    if not quantity_named(quantity).signed or not {"mass", "inertia"} <= original.keys():
        return 0.0
    return _LEAST_OFF_CENTRE * math.sqrt(original["mass"] * original["inertia"])


def size_of(value: float, original: float, least: float) -> float:
    """What a miss of a limit is measured by: its value, or the original's where that is 0."""
    return max(abs(value) or abs(original), least) or 1.0
