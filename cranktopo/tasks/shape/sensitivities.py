"""What a millimetre of each dimension is worth, and the worst case within the tolerances of a forging."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from cranktopo.base.arrays import Array
from cranktopo.tasks.refit.family import unit_of
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.shape.mesh_model import MeshResponses
from cranktopo.tasks.shape.result import DimensionSensitivity, SensitivityTable

_SHOWN = ("mass", "torsion", "bending", "inertia", "unbalance", "fatigue_safety")
_AT_BOUND = 0.02


def dimension_sensitivities(
    web: ParametricWeb,
    values: Array,
    found: MeshResponses,
    original: Mapping[str, float],
    holders: Sequence[tuple[str, ...]],
) -> tuple[DimensionSensitivity, ...]:
    """Every dimension of a web with what it is worth on body-fitted elements.

    Args:
        values: (n,) of its parameters.
        found: its quantities and their gradients.
        original: quantities of the original web.
        holders: of each parameter, by `held_by`.
    """
    told = [name for name in _SHOWN if name in found.gradients and original.get(name)]
    percent = {name: 100 * found.gradients[name] / original[name] for name in told}
    return tuple(
        DimensionSensitivity(
            name=name,
            unit=unit_of(name),
            value=float(value),
            low=float(low),
            high=float(high),
            at_bound=_bound(value, low, high),
            held_by=holders[index],
            per_unit={f"{quantity}_percent": float(slope[index]) for quantity, slope in percent.items()},
        )
        for index, (name, value, low, high) in enumerate(
            zip(web.layout.names, values, *web.bounds, strict=True)
        )
    )


def sensitivity_table(found: Sequence[DimensionSensitivity], tolerance: float) -> SensitivityTable:
    """Return the dimensions with the worst case.

    Args:
        tolerance: of every dimension, mm or degrees.
    """
    worst = {"tolerance": tolerance, **worst_case_percent(found, tolerance)}
    return SensitivityTable(parameters=tuple(found), worst_case_percent=worst)


def worst_case_percent(found: Sequence[DimensionSensitivity], tolerance: float) -> dict[str, float]:
    """Largest change of each quantity with every dimension off by the tolerance, %, to first order."""
    names = found[0].per_unit_percent if found else {}
    return {name: tolerance * sum(abs(d.per_unit_percent[name]) for d in found) for name in names}


def _bound(value: float, low: float, high: float) -> str | None:
    if value - low < _AT_BOUND:
        return "low"
    return "high" if high - value < _AT_BOUND else None
