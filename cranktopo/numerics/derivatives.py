"""Derivatives of functions that are not worth deriving by hand."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array

_IMAGINARY = 1e-30
"""Imaginary step: nothing cancels, so it may be as small as it likes."""


def central_difference(
    function: Callable[[Array], Array], at: Array, step: float, places: Iterable[int] | None = None
) -> Array:
    """Return the derivatives of a function by the first axis of its argument, as the last axis of the result.

    Args:
        function: of an array such as `at`; its result may have any shape.
        places: positions along the first axis, by default all; by the others the derivatives are 0.
    """
    steps = step * np.eye(len(at)).reshape(len(at), len(at), *(1,) * (at.ndim - 1))
    chosen = range(len(at)) if places is None else places
    found = {i: (function(at + steps[i]) - function(at - steps[i])) / (2 * step) for i in chosen}
    shape = np.shape(next(iter(found.values())) if found else function(at))
    return np.stack([found.get(i, np.zeros(shape)) for i in range(len(at))], axis=-1)


def complex_step(function: Callable[[Any], Any], at: Array) -> Array:
    """Return the derivatives of an analytic function by its variables, exact to rounding, as the last axis.

    Source: J. R. R. A. Martins et al., The complex-step derivative approximation, ACM TOMS 29, 2003.
    """
    sides = [function(at + 1j * _IMAGINARY * unit).imag / _IMAGINARY for unit in np.eye(len(at))]
    return np.stack(sides, axis=-1)
