"""From an optimum to the content of shape.json."""

from __future__ import annotations

from cranktopo.design.goal.outcome import GoalWords, goal_outcome
from cranktopo.design.goal.quantities import QUANTITIES
from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.family import parameter_unit
from cranktopo.tasks.shape.result import (
    LimitPrice,
    RoundValues,
    RulePrice,
    SensitivityTable,
    ShapeParameter,
    ShapeResult,
    ShapeValues,
)
from cranktopo.tasks.shape.rules import rule_unit, rules_at
from cranktopo.tasks.shape.search import HELD
from cranktopo.tasks.shape.search_goal import goal_on_cells
from cranktopo.tasks.shape.sensitivities import active_constraints, dimension_sensitivities, sensitivity_table
from cranktopo.tasks.shape.stage import ShapeOptimum

_PER_UNIT = {"mm": 1.0, "deg": 1.0, "%": 100.0}
_COMPARED = ("mass", "torsion", "bending", "torsion_per_mass", "bending_per_mass", "inertia", "unbalance")


def assemble_result(
    scene: Scene, optimum: ShapeOptimum, start: dict[str, float], seconds: dict[str, float]
) -> ShapeResult:
    """Return the content of shape.json without bound, assumptions and files.

    Args:
        scene: the design.
        start: parameters of the web that the search began with, by name.
        seconds: wall time by part.
    """
    goal, result, original = optimum.goal, optimum.result, optimum.original
    table, on_cells = _sensitivities(scene, optimum), goal_on_cells(goal)
    return ShapeResult(
        design=scene.name,
        goal=goal_outcome(goal, result.web.values, original.values, HELD),
        status="converged" if result.held else "limits not met",
        stop_reason=_reason(optimum),
        original=original.evaluation,
        result=result.web.evaluation,
        values=ShapeValues(original=original.values, result=result.web.values),
        change_percent=_changes(optimum),
        parameters=tuple(ShapeParameter(**dict(row), start=start.get(row.name)) for row in table.parameters),
        worst_case_percent=table.worst_case_percent,
        prices=tuple(
            LimitPrice.model_validate(
                {"quantity": limit.quantity, "sense": limit.sense, "goal_percent_per_percent": float(price)}
            )
            for limit, price in zip(optimum.stated.limits, optimum.multipliers.limits, strict=True)
        ),
        goal_on_cells=GoalWords.model_validate({goal.sense: on_cells.quantity}),
        prices_remainder_percent=100 * optimum.multipliers.remainder,
        rule_prices=_rule_prices(scene, optimum),
        trials=optimum.trials,
        rounds=tuple(
            RoundValues(values=found.web.values, excess_percent=found.excess_percent)
            for found in optimum.rounds
        ),
        best_round=optimum.best,
        iterations=len(optimum.rounds),
        evaluations=sum(trial.evaluations for trial in optimum.trials)
        + sum(found.evaluations for found in optimum.rounds),
        seconds=seconds,
    )


def _rule_prices(scene: Scene, optimum: ShapeOptimum) -> tuple[RulePrice, ...]:
    """Return what a unit of each rule and bound would give in the goal, % of the original's."""
    web, paid, found = optimum.web, optimum.multipliers, dict[tuple[str, str], float]()
    names = [(name, rule_unit(name)) for name in rules_at(scene, web, optimum.result.values).names]
    bounds = [
        (f"{'least' if price > 0 else 'greatest'} {name}", parameter_unit(name))
        for name, price in zip(web.layout.names, paid.bounds, strict=True)
    ]
    for key, price in zip([*names, *bounds], [*paid.rules, *abs(paid.bounds)], strict=True):
        if price > 0:
            found[key] = found.get(key, 0.0) + 100 * float(price) / _PER_UNIT[key[1]]
    return tuple(
        RulePrice(name=name, unit=unit, goal_percent_per_unit=price) for (name, unit), price in found.items()
    )


def _changes(optimum: ShapeOptimum) -> dict[str, float]:
    values, original = optimum.result.web.values, optimum.original.values
    return {
        name: 100 * (values[name] / original[name] - 1)
        for name in (*_COMPARED, "fatigue_safety")
        if values.get(name) and original[name]
    }


def _sensitivities(scene: Scene, optimum: ShapeOptimum) -> SensitivityTable:
    """Return what a millimetre is worth, what holds each dimension, and the worst case."""
    web, values, original = optimum.web, optimum.result.values, optimum.original.values
    goal = optimum.stated, optimum.responses, original
    holders = active_constraints(scene, web, values, rules_at(scene, web, values), goal)
    found = dimension_sensitivities(web, values, optimum.responses, original, holders)
    return sensitivity_table(found, scene.shape.tolerance_mm)


def _reason(optimum: ShapeOptimum) -> str:
    result, count = optimum.result, len(optimum.rounds)
    if result.held:
        return f"every limit holds by the evaluation, web {optimum.best + 1} of {count} evaluated"
    told = goal_outcome(optimum.goal, result.web.values, optimum.original.values, HELD).limits
    worst = max(told, key=lambda limit: limit.violation or 0.0)
    label, percent = QUANTITIES[worst.quantity].label, 100 * (worst.violation or 0.0)
    return f"{label} misses its limit by {percent:.2f} % by the evaluation, best of {count} webs"
