"""Fall of the stress below the surface of a fillet.

Source: IACS UR M53, Appendix V, 3 (1): a notch part that falls exponentially, and a nominal part that is
linear to a midpoint in the web. The rule gives both by radius; here the exponent is such that the fall at the
surface is the related gradient that the elements have there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.hardening import Fillet
from cranktopo.design.schema import Scene
from cranktopo.tasks.throw_fatigue.m53 import Dimensions, concentration_factors, dimensions

_CONCENTRATION = 1.5, 4.0
"""Range of the concentration factor in bending; beyond it the polynomials are outside their validity."""


@dataclass(frozen=True)
class NotchShape:
    """Shape of a fillet, on which the stress below it depends beside its gradient.

    Attributes:
        concentration: factor in bending of the fillet.
        middle_mm: depth of the midpoint in the web, where the nominal stress is zero.
    """

    concentration: float
    middle_mm: float


def notch_shape(half: Scene, fillet: Fillet) -> NotchShape:
    """Return the shape of a fillet of half a throw, by the rule's polynomials."""
    size = dimensions(half)
    factors = concentration_factors(size)
    factor = factors.alpha_bending if fillet == "pin" else factors.beta_bending
    low, high = _CONCENTRATION
    return NotchShape(min(max(factor, low), high), web_middle_mm(size))


def web_middle_mm(size: Dimensions) -> float:
    """Return half the distance between pin and journal fillet: sqrt(W^2 + S^2) / 2 with the overlap S."""
    return size.fillet_distance / 2


def stress_share(shape: NotchShape, gradient_per_mm: Array, depth_mm: float) -> tuple[Array, Array]:
    """Return the stress at a depth over that of the surface, and its related gradient there, (n,) each.

    A gradient below that of the nominal stress is a straight line.

    Args:
        gradient_per_mm: related stress gradient at the surface, (n,).
    """
    nominal = 1 / shape.concentration
    slope = np.minimum(gradient_per_mm, nominal / shape.middle_mm)
    rate = (gradient_per_mm - slope) / (1 - nominal)
    notch = (1 - nominal) * np.exp(-rate * depth_mm)
    linear = nominal - slope * depth_mm
    share = np.maximum(notch + np.maximum(linear, 0.0), 1e-9)
    decay = rate * notch + np.where(linear > 0, slope, 0.0)
    return share, decay / share
