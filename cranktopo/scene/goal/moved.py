"""Limits of a model that errs, moved so that they hold by a better one."""

from __future__ import annotations


def moved_bound(required: float, in_model: float, better: float) -> float:
    """Bound of a limit in a model at which the better one reaches what is required.

    The error of a model is nearly the same for designs that are close to each other.

    Args:
        required: in the better model.
        in_model, better: values of the same design. The ratio is kept, the difference of what may be 0.
    """
    if min(required, in_model, better) > 0:
        return required * in_model / better
    return required + in_model - better
