"""shape.json: the goal and its limits, the original, the result, what changed, every dimension."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from cranktopo.design.goal.outcome import goal_json, limit_outcomes
from cranktopo.design.goal.quantities import QUANTITIES
from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.family import parameter_unit
from cranktopo.tasks.shape.active_constraints import held_by
from cranktopo.tasks.shape.goal_in_model import goal_on_cells
from cranktopo.tasks.shape.rules import rule_unit, rules_at
from cranktopo.tasks.shape.search import HELD
from cranktopo.tasks.shape.sensitivities import dimensions, sensitivities_json
from cranktopo.tasks.shape.stage import ShapeOptimum

SCHEMA_VERSION = 1
_PER_UNIT = {"mm": 1.0, "deg": 1.0, "%": 100.0}
_COMPARED = ("mass", "torsion", "bending", "torsion_per_mass", "bending_per_mass", "inertia", "unbalance")


def shape_json(
    scene: Scene, optimum: ShapeOptimum, start: dict[str, float], seconds: dict[str, float]
) -> dict[str, Any]:
    """The content of shape.json without its files.

    Args:
        scene: the design.
        start: parameters of the web that the search began with, by name.
        seconds: wall time by part.
    """
    goal, result = optimum.goal, optimum.result
    worth = _worth(scene, optimum)
    return {
        "schema_version": SCHEMA_VERSION,
        "design": scene.name,
        "goal": goal_json(goal, result.web.values, optimum.original.values, HELD),
        "status": "converged" if result.held else "limits not met",
        "stop_reason": _reason(optimum),
        "original": optimum.original.evaluation,
        "result": result.web.evaluation,
        "values": {"original": optimum.original.values, "result": result.web.values},
        "change_percent": _changes(optimum),
        "parameters": [{**row, "start": start.get(row["name"])} for row in worth["parameters"]],
        "worst_case_percent": worth["worst_case_percent"],
        "prices": [
            {"quantity": r.quantity, "sense": r.sense, "goal_percent_per_percent": float(price)}
            for r, price in zip(optimum.stated.limits, optimum.prices.limits, strict=True)
        ],
        "goal_on_cells": {goal.sense: goal_on_cells(goal).quantity},
        "prices_remainder_percent": 100 * optimum.prices.remainder,
        "rule_prices": _rule_prices(scene, optimum),
        "trials": [asdict(trial) for trial in optimum.trials],
        "rounds": [
            {"values": r.web.values, "excess_percent": list(r.excess_percent)} for r in optimum.rounds
        ],
        "best_round": optimum.best,
        "iterations": len(optimum.rounds),
        "evaluations": sum(trial.evaluations for trial in optimum.trials)
        + sum(r.evaluations for r in optimum.rounds),
        "seconds": seconds,
    }


def _rule_prices(scene: Scene, optimum: ShapeOptimum) -> list[dict[str, Any]]:
    """What a unit of each rule and bound would give in the goal, % of the original's."""
    web, paid, found = optimum.web, optimum.prices, dict[tuple[str, str], float]()
    names = [(name, rule_unit(name)) for name in rules_at(scene, web, optimum.result.values).names]
    bounds = [
        (f"{'least' if price > 0 else 'greatest'} {name}", parameter_unit(name))
        for name, price in zip(web.layout.names, paid.bounds, strict=True)
    ]
    for key, price in zip([*names, *bounds], [*paid.rules, *abs(paid.bounds)], strict=True):
        if price > 0:
            found[key] = found.get(key, 0.0) + 100 * float(price) / _PER_UNIT[key[1]]
    return [
        {"name": name, "unit": unit, "goal_percent_per_unit": price} for (name, unit), price in found.items()
    ]


def _changes(optimum: ShapeOptimum) -> dict[str, float]:
    values, original = optimum.result.web.values, optimum.original.values
    names = (*_COMPARED, "fatigue_safety")
    return {
        name: 100 * (values[name] / original[name] - 1)
        for name in names
        if values.get(name) and original[name]
    }


def _worth(scene: Scene, optimum: ShapeOptimum) -> dict[str, Any]:
    """What a millimetre is worth, what holds each dimension, and the worst case within the tolerance."""
    web, values, original = optimum.web, optimum.result.values, optimum.original.values
    goal = optimum.stated, optimum.responses, original
    holders = held_by(scene, web, values, rules_at(scene, web, values), goal)
    found = dimensions(web, values, optimum.responses, original, holders)
    return sensitivities_json(found, scene.shape.tolerance_mm)


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
