"""What a millimetre of each dimension is worth, and the worst case within the tolerances of a forging."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cranktopo.remodel.parametric_web import ParametricWeb
from cranktopo.shape.mesh_model import MeshResponses

Array = NDArray[np.float64]
SHOWN = ("mass", "torsion", "bending", "inertia", "unbalance", "fatigue_safety")
TOLERANCE = 0.5
"""Usual tolerance of a forged dimension, mm; of an angle, degrees."""
_AT_BOUND = 0.02


@dataclass(frozen=True)
class Dimension:
    """A parameter of the web at the optimum.

    Attributes:
        value, low, high: mm, or degrees for a draft; the bounds of its range.
        at_bound: "low" or "high" where it lies on that bound; empty else.
        per_unit_percent: change of each quantity per mm or degree, % of the original's.
    """

    name: str
    unit: str
    value: float
    low: float
    high: float
    at_bound: str
    per_unit_percent: dict[str, float]


def dimensions(
    web: ParametricWeb, values: Array, found: MeshResponses, original: Mapping[str, float]
) -> tuple[Dimension, ...]:
    """Every dimension of a web with what it is worth on body-fitted elements.

    Args:
        values: (n,) of its parameters.
        found: its quantities and their gradients.
        original: quantities of the original web.
    """
    told = [name for name in SHOWN if name in found.slopes and original.get(name)]
    percent = {name: 100 * found.slopes[name] / original[name] for name in told}
    return tuple(
        Dimension(
            name,
            "deg" if name.endswith("draft") else "mm",
            float(value),
            float(low),
            float(high),
            _bound(value, low, high),
            {quantity: float(slope[index]) for quantity, slope in percent.items()},
        )
        for index, (name, value, low, high) in enumerate(
            zip(web.layout.names, values, *web.bounds, strict=True)
        )
    )


def worst_case_percent(found: tuple[Dimension, ...], tolerance: float = TOLERANCE) -> dict[str, float]:
    """Largest change of each quantity with every dimension off by the tolerance, %, to first order."""
    names = found[0].per_unit_percent if found else {}
    return {name: tolerance * sum(abs(d.per_unit_percent[name]) for d in found) for name in names}


def _bound(value: float, low: float, high: float) -> str:
    if value - low < _AT_BOUND:
        return "low"
    return "high" if high - value < _AT_BOUND else ""
