"""shape.json: the goal and its limits, the original, the result, what changed, every dimension."""

from __future__ import annotations

from dataclasses import asdict
from math import degrees
from typing import Any

from cranktopo.scene.goal import QUANTITIES, Limit
from cranktopo.shape.sensitivities import SHOWN, TOLERANCE, Dimension, dimensions, worst_case_percent
from cranktopo.shape.stage import HELD, ShapeOptimum

SCHEMA_VERSION = 1
_ACTIVE = 5e-3
"""A limit within this of its value, relative, counts as active."""
_COMPARED = ("mass", "torsion", "bending", "torsion_per_mass", "bending_per_mass", "inertia", "unbalance")


def shape_json(
    design: str, optimum: ShapeOptimum, start: dict[str, float], seconds: dict[str, float]
) -> dict[str, Any]:
    """The content of shape.json without its files.

    Args:
        start: parameters of the web that the search began with, by name.
        seconds: wall time by part.
    """
    goal, result = optimum.goal, optimum.result
    found = dimensions(optimum.model, result.found)
    return {
        "schema_version": SCHEMA_VERSION,
        "design": design,
        "goal": {goal.sense: goal.quantity, "limits": [_limit(limit, optimum) for limit in goal.limits]},
        "status": "converged" if result.held else "limits not met",
        "stop_reason": _reason(optimum),
        "original": optimum.original.evaluation,
        "result": result.web.evaluation,
        "values": {"original": optimum.original.values, "result": result.web.values},
        "change_percent": _changes(optimum),
        "parameters": [_parameter(dimension, start) for dimension in found],
        "worst_case_percent": {"tolerance": TOLERANCE, **worst_case_percent(found)},
        "prices": [
            {"quantity": r.quantity, "goal_percent_per_percent": float(price)}
            for r, price in zip(result.goal.limits, optimum.prices.limits, strict=True)
        ],
        "trials": [asdict(trial) for trial in optimum.trials],
        "rounds": [
            {"values": r.web.values, "excess_percent": list(r.excess_percent)} for r in optimum.rounds
        ],
        "iterations": len(optimum.rounds),
        "evaluations": sum(trial.evaluations for trial in optimum.trials)
        + sum(r.evaluations for r in optimum.rounds),
        "seconds": seconds,
    }


def _limit(limit: Limit, optimum: ShapeOptimum) -> dict[str, Any]:
    reached, required = _reached(limit, optimum), limit.value
    excess = (reached - required) / abs(required or 1.0) * (1 if limit.sense == "<=" else -1)
    return {
        "quantity": limit.quantity,
        "sense": limit.sense,
        "required": required,
        "reached": reached,
        "unit": limit.unit,
        "holds": bool(excess <= HELD),
        "active": bool(abs(excess) <= _ACTIVE),
        "assumed": limit.assumed,
    }


def _reached(limit: Limit, optimum: ShapeOptimum) -> float:
    """The result in the unit of the limit."""
    values, original = optimum.result.web.values, optimum.original.values
    deformed = {"pin_displacement": "bending", "twist": "torsion"}.get(limit.quantity)
    if deformed is None:
        value = values[limit.quantity]
        return 100 * value / original[limit.quantity] if limit.percent else value
    if limit.percent:
        return 100 * original[deformed] / values[deformed]
    case = next(case for case in optimum.model.model.cases if case.name == deformed)
    return (case.radial_N if deformed == "bending" else degrees(case.torque_Nm)) / values[deformed]


def _changes(optimum: ShapeOptimum) -> dict[str, float]:
    values, original = optimum.result.web.values, optimum.original.values
    names = (*_COMPARED, "fatigue_safety")
    return {
        name: 100 * (values[name] / original[name] - 1)
        for name in names
        if values.get(name) and original[name]
    }


def _parameter(found: Dimension, start: dict[str, float]) -> dict[str, Any]:
    worth = {
        f"{name}_percent": found.per_unit_percent[name] for name in SHOWN if name in found.per_unit_percent
    }
    return {
        "name": found.name,
        "unit": found.unit,
        "start": start.get(found.name),
        "value": found.value,
        "low": found.low,
        "high": found.high,
        "at_bound": found.at_bound or None,
        "per_unit": worth,
    }


def _reason(optimum: ShapeOptimum) -> str:
    result = optimum.result
    if result.held:
        return f"every limit holds by the evaluation after {optimum.best + 1} of {len(optimum.rounds)} rounds"
    worst, limit = max(zip(result.excess_percent, optimum.true_limits, strict=True), key=lambda pair: pair[0])
    label = QUANTITIES[limit.quantity].label  # type: ignore[index]
    return f"{label} misses its limit by {worst:.2f} % by the evaluation, after {len(optimum.rounds)} rounds"
