"""Sensitivities of the dimensions of a web, what holds them, and the worst case within tolerances."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.goal.constraint import ACTIVE, Constraint
from cranktopo.design.goal.quantities import quantity_named
from cranktopo.design.halves import usual_scale
from cranktopo.design.schema import Scene
from cranktopo.numerics.optimisers.gradient_search import Multipliers
from cranktopo.tasks.refit.family import parameter_unit
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.web_shape.mesh_model import MeshResponses
from cranktopo.tasks.web_shape.result import DimensionSensitivity, SensitivityTable
from cranktopo.tasks.web_shape.rules import Rules
from cranktopo.tasks.web_shape.search_goal import Quantities, SearchGoal

_SHOWN = (
    "mass",
    "torsion",
    "bending",
    "inertia",
    "unbalance",
    "natural_frequency",
    "fatigue_safety",
    "stress",
    "oil_film",
)
_AT_BOUND = 0.02
_NEAR_MM = 0.1
"""A rule holds a dimension that may move by less before it breaks; of throws of usual size."""
_SHARE = 0.1
"""Minimum effect of a dimension on a rule over that of the dimension with the largest one."""
_LEAST_SHARE = 1e-3
"""The same on a limit: a smaller effect is noise of the elements."""


def dimension_sensitivities(
    web: ParametricWeb,
    values: Array,
    responses: MeshResponses,
    original: Mapping[str, float],
    holders: Sequence[tuple[str, ...]],
) -> tuple[DimensionSensitivity, ...]:
    """Return every dimension of a web with what it is worth; `holders` by `active_constraints`."""
    names = [name for name in _SHOWN if name in responses.gradients and original.get(name)]
    percent = {name: 100 * responses.gradients[name] / original[name] for name in names}
    return tuple(
        DimensionSensitivity(
            name=name,
            unit=parameter_unit(name),
            value=float(value),
            low=float(low),
            high=float(high),
            at_bound="low" if value - low < _AT_BOUND else "high" if high - value < _AT_BOUND else None,
            held_by=holders[index],
            per_unit={f"{quantity}_percent": float(slope[index]) for quantity, slope in percent.items()},
        )
        for index, (name, value, low, high) in enumerate(
            zip(web.layout.names, values, *web.bounds, strict=True)
        )
    )


def sensitivity_table(dimensions: Sequence[DimensionSensitivity], tolerance: float) -> SensitivityTable:
    """Return the dimensions with the worst case within a tolerance, mm or degrees."""
    worst = {"tolerance": tolerance, **worst_case_percent(dimensions, tolerance)}
    return SensitivityTable(parameters=tuple(dimensions), worst_case_percent=worst)


def worst_case_percent(dimensions: Sequence[DimensionSensitivity], tolerance: float) -> dict[str, float]:
    """Return the largest change of each quantity with every dimension off, %, to first order."""
    names = dimensions[0].per_unit_percent if dimensions else {}
    return {name: tolerance * sum(abs(d.per_unit_percent[name]) for d in dimensions) for name in names}


def active_constraints(
    scene: Scene,
    web: ParametricWeb,
    values: Array,
    rules: Rules,
    goal: tuple[SearchGoal, Quantities, Mapping[str, float]] | None = None,
    paid: Multipliers | None = None,
) -> list[tuple[str, ...]]:
    """Return what holds each dimension, the most direct first; empty where nothing does.

    Args:
        goal: with its quantities at the web and those of the original: then only what keeps a dimension from
            being changed for the better counts, a limit of the goal where neither rule nor bound does.
        paid: prices of rules and bounds: those that have one hold, too. A dimension that is worse for the
            goal may want to change for the sake of a limit, as a counterweight does at the envelope.
    """
    near_mm, count = _NEAR_MM / usual_scale(scene), len(values)
    paid = paid or Multipliers(np.zeros(0), np.zeros(len(rules.names)), np.zeros(count), 0.0)
    better = np.zeros(count) if goal is None else -np.sign(goal[0].objective_gradient(goal[1].gradients))
    found = []
    for index in range(count):
        names = [
            *_bounds(web, index, float(values[index]), better[index], near_mm, paid.bounds[index]),
            *_rules(rules, index, better[index], near_mm, paid.rules),
        ]
        if goal is not None and not names:
            names = list(_limits(*goal, index, better[index]))
        found.append(tuple(dict.fromkeys(names)))
    return found


def _bounds(
    web: ParametricWeb, index: int, value: float, better: float, near_mm: float, price: float
) -> Iterator[str]:
    layout = web.layout
    name, low, high = layout.names[index], web.bounds[0][index], web.bounds[1][index]
    unit = parameter_unit(name)
    sides = (("least", low, better <= 0 or price > 0), ("greatest", high, better >= 0 or price < 0))
    for side, bound, blocked in sides:
        if blocked and abs(value - bound) < near_mm:
            of_outline = "draft" if unit == "deg" else "value of its range"
            what = "value in [shape.free]" if name in layout.dimensions else of_outline
            yield f"{side} {what}, {bound:.4g} {unit}"


def _rules(rules: Rules, index: int, better: float, near_mm: float, prices: Array) -> Iterator[str]:
    gradients = rules.gradients[:, index]
    share = np.abs(gradients) / np.maximum(np.abs(rules.gradients).max(axis=1), 1e-12)
    near = (np.abs(rules.excess) <= near_mm * np.abs(gradients)) & (gradients * better >= 0)
    priced = (prices > 0) & (gradients * (prices @ gradients) > 0)
    holding = np.flatnonzero((near | priced) & (share >= _SHARE))
    for rule in sorted(holding, key=lambda rule: (-round(float(share[rule]), 6), rule)):
        yield rules.names[rule]


def _limits(
    goal: SearchGoal, quantities: Quantities, original: Mapping[str, float], index: int, better: float
) -> Iterator[str]:
    gradients = goal.violation_gradients(quantities.gradients, len(quantities.gradients[goal.quantity]))
    for limit, over, slope in zip(goal.limits, goal.violations(quantities.values), gradients, strict=True):
        if over > -ACTIVE and slope[index] * better > _LEAST_SHARE * np.abs(slope).max():
            name = limit.quantity.replace("_", " ")
            yield f"limit: {name} {limit.sense} {_bound_words(limit, original)}"


def _bound_words(limit: Constraint, original: Mapping[str, float]) -> str:
    """Return a bound as a share of the original's, or as it is where the quantity may be negative."""
    quantity = quantity_named(limit.quantity)
    if quantity.signed:
        return f"{limit.bound:.4g} {quantity.unit}"
    return f"{100 * limit.bound / original[limit.quantity]:.4g} % of the original"
