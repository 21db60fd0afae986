"""What a millimetre of each dimension is worth, and the worst case within the tolerances of a forging."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from cranktopo.base.arrays import Array
from cranktopo.tasks.refit.family import parameter_unit
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.shape.mesh_model import MeshResponses

SHOWN = ("mass", "torsion", "bending", "inertia", "unbalance", "fatigue_safety")
_AT_BOUND = 0.02


@dataclass(frozen=True)
class Dimension:
    """A parameter of the web at the optimum.

    Attributes:
        value, low, high: mm, or degrees for a draft; the bounds of its range.
        at_bound: "low" or "high" where it lies on that bound; empty else.
        held_by: names of the rules, bounds and limits that keep it where it is.
        per_unit_percent: change of each quantity per mm or degree, % of the original's.
    """

    name: str
    unit: str
    value: float
    low: float
    high: float
    at_bound: str
    held_by: tuple[str, ...]
    per_unit_percent: dict[str, float]


def dimensions(
    web: ParametricWeb,
    values: Array,
    found: MeshResponses,
    original: Mapping[str, float],
    holders: Sequence[tuple[str, ...]],
) -> tuple[Dimension, ...]:
    """Every dimension of a web with what it is worth on body-fitted elements.

    Args:
        values: (n,) of its parameters.
        found: its quantities and their gradients.
        original: quantities of the original web.
        holders: of each parameter, by `held_by`.
    """
    told = [name for name in SHOWN if name in found.slopes and original.get(name)]
    percent = {name: 100 * found.slopes[name] / original[name] for name in told}
    return tuple(
        Dimension(
            name,
            parameter_unit(name),
            float(value),
            float(low),
            float(high),
            _bound(value, low, high),
            tuple(holders[index]),
            {quantity: float(slope[index]) for quantity, slope in percent.items()},
        )
        for index, (name, value, low, high) in enumerate(
            zip(web.layout.names, values, *web.bounds, strict=True)
        )
    )


def sensitivities_json(found: tuple[Dimension, ...], tolerance: float) -> dict[str, Any]:
    """The dimensions and the worst case as plain data.

    Args:
        tolerance: of every dimension, mm or degrees.
    """
    worst = worst_case_percent(found, tolerance)
    return {
        "parameters": [_parameter(dimension) for dimension in found],
        "worst_case_percent": {"tolerance": tolerance, **worst},
    }


def worst_case_percent(found: tuple[Dimension, ...], tolerance: float) -> dict[str, float]:
    """Largest change of each quantity with every dimension off by the tolerance, %, to first order."""
    names = found[0].per_unit_percent if found else {}
    return {name: tolerance * sum(abs(d.per_unit_percent[name]) for d in found) for name in names}


def _parameter(found: Dimension) -> dict[str, Any]:
    worth = found.per_unit_percent
    return {
        "name": found.name,
        "unit": found.unit,
        "value": found.value,
        "low": found.low,
        "high": found.high,
        "at_bound": found.at_bound or None,
        "held_by": list(found.held_by),
        "per_unit": {f"{name}_percent": worth[name] for name in SHOWN if name in worth},
    }


def _bound(value: float, low: float, high: float) -> str:
    if value - low < _AT_BOUND:
        return "low"
    return "high" if high - value < _AT_BOUND else ""
