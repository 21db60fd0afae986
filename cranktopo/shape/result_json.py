"""shape.json: the goal and its limits, the original, the result, what changed, every dimension."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from cranktopo.scene.goal import QUANTITIES
from cranktopo.scene.goal.outcome import goal_json, limit_outcomes
from cranktopo.shape.sensitivities import SHOWN, TOLERANCE, Dimension, dimensions, worst_case_percent
from cranktopo.shape.stage import HELD, ShapeOptimum

SCHEMA_VERSION = 1
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
    found = dimensions(optimum.web, result.values, optimum.responses, optimum.original.values)
    return {
        "schema_version": SCHEMA_VERSION,
        "design": design,
        "goal": goal_json(goal, result.web.values, optimum.original.values, HELD),
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
            for r, price in zip(optimum.stated.limits, optimum.prices.limits, strict=True)
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
        return (
            f"every limit holds by the evaluation, web {optimum.best + 1} of {len(optimum.rounds)} evaluated"
        )
    values, original = result.web.values, optimum.original.values
    told = limit_outcomes(optimum.goal, values, original, HELD)
    worst = max(told, key=lambda outcome: outcome.missed or 0.0)
    label, percent = QUANTITIES[worst.limit.quantity].label, 100 * (worst.missed or 0.0)
    return (
        f"{label} misses its limit by {percent:.2f} % by the evaluation, best of {len(optimum.rounds)} webs"
    )
