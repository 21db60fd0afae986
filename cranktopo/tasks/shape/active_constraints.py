"""What keeps a dimension where it is, by name: rules, bounds and limits that it would break otherwise."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.scale import usual_scale
from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.family import parameter_unit
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.shape.rules import Rules
from cranktopo.tasks.shape.search import Quantities
from cranktopo.tasks.shape.search_goal import SearchGoal, SearchLimit

_NEAR_MM = 0.1
"""A rule holds a dimension that may move by less before it breaks; of throws of usual size."""
_NEAR_LIMIT = 2e-3
"""Relative room within which a limit counts as active."""
_SHARE = 0.1
"""Least effect of a dimension on a rule over that of the dimension with the largest one."""


def held_by(
    scene: Scene,
    web: ParametricWeb,
    values: Array,
    rules: Rules,
    goal: tuple[SearchGoal, Quantities, Mapping[str, float]] | None = None,
) -> list[tuple[str, ...]]:
    """What holds each dimension, the most direct first; empty where nothing does.

    Args:
        goal: with its quantities at the web and those of the original: then only what keeps a dimension from
            being changed for the better counts, a limit of the goal where neither rule nor bound does.
    """
    near_mm, count = _NEAR_MM / usual_scale(scene), len(values)
    better = np.zeros(count) if goal is None else -np.sign(goal[0].objective_slope(goal[1].slopes))
    found = []
    for index in range(count):
        names = [
            *_bounds(web, index, float(values[index]), better[index], near_mm),
            *_rules(rules, index, better[index], near_mm),
        ]
        if goal is not None and not names:
            names = list(_limits(*goal, index, better[index]))
        found.append(tuple(dict.fromkeys(names)))
    return found


def _bounds(web: ParametricWeb, index: int, value: float, better: float, near_mm: float) -> Iterator[str]:
    layout = web.layout
    name, low, high = layout.names[index], web.bounds[0][index], web.bounds[1][index]
    unit = parameter_unit(name)
    for side, bound, blocked in (("least", low, better <= 0), ("greatest", high, better >= 0)):
        if blocked and abs(value - bound) < near_mm:
            where = "value in [shape.free]" if name in layout.dimensions else "value of its range"
            yield f"{side} {'draft' if unit == 'deg' else where}, {bound:.4g} {unit}"


def _rules(rules: Rules, index: int, better: float, near_mm: float) -> Iterator[str]:
    slopes = rules.slopes[:, index]
    share = np.abs(slopes) / np.maximum(np.abs(rules.slopes).max(axis=1), 1e-12)
    near = (np.abs(rules.excess) <= near_mm * np.abs(slopes)) & (share >= _SHARE) & (slopes * better >= 0)
    for rule in sorted(np.flatnonzero(near), key=lambda rule: (-round(float(share[rule]), 6), rule)):
        yield rules.names[rule]


def _limits(
    goal: SearchGoal, found: Quantities, original: Mapping[str, float], index: int, better: float
) -> Iterator[str]:
    excess, slopes = (
        goal.excesses(found.values),
        goal.excess_slopes(found.slopes, len(found.slopes[goal.quantity])),
    )
    for limit, over, slope in zip(goal.limits, excess, slopes, strict=True):
        if over > -_NEAR_LIMIT and slope[index] * better > 0:
            yield _limit_name(limit, original)


def _limit_name(limit: SearchLimit, original: Mapping[str, float]) -> str:
    percent = 100 * limit.value / original[limit.quantity]
    return f"limit: {limit.quantity.replace('_', ' ')} {limit.sense} {percent:.4g} % of the original"
