"""The content of shape.json from the best web of a search: values, prices of limits and rules, reasons."""

from __future__ import annotations

from cranktopo.design.goal.balance_moved import balance_moved
from cranktopo.design.goal.constraint import TOLERANCE
from cranktopo.design.goal.outcome import GoalOutcome, GoalWords, goal_outcome
from cranktopo.design.goal.quantities import QUANTITIES
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import Loads, loads_name
from cranktopo.tasks.refit.family import parameter_unit
from cranktopo.tasks.web_shape.loads_told import loads_left_off
from cranktopo.tasks.web_shape.optimum import ShapeOptimum
from cranktopo.tasks.web_shape.result import (
    LimitPrice,
    RoundValues,
    RulePrice,
    SafetyInShaft,
    SensitivityTable,
    ShapeParameter,
    ShapeResult,
    ShapeValues,
    too_loose,
)
from cranktopo.tasks.web_shape.rules import rule_unit, rules_at
from cranktopo.tasks.web_shape.search_goal import quantity_on_cells
from cranktopo.tasks.web_shape.sensitivities import (
    active_constraints,
    dimension_sensitivities,
    sensitivity_table,
)
from cranktopo.tasks.web_shape.stage import stresses_in
from cranktopo.tasks.web_shape.text import QUANTITIES_TOLD

_PER_UNIT = {"mm": 1.0, "deg": 1.0, "%": 100.0}


def assembled(
    scene: Scene,
    optimum: ShapeOptimum,
    start: dict[str, float],
    seconds: dict[str, float],
    loads: Loads,
    in_shaft: SafetyInShaft | None = None,
) -> ShapeResult:
    """Return the content of shape.json without bound, assumptions and files; `start` as it began, by name."""
    goal, result, original = optimum.goal, optimum.result, optimum.original
    outcome = goal_outcome(goal, result.web.values, original.values)
    table, on_cells = _sensitivities(scene, optimum), quantity_on_cells(goal)
    moved = balance_moved(scene, result.web.values, original.values)
    both: Loads | None = "extremes" if in_shaft and scene.effects.continuous_shaft == "auto" else None
    missed = any(limit.holds is False for limit in outcome.limits) or not (in_shaft is None or in_shaft.held)
    return ShapeResult(
        design=scene.name,
        goal=outcome,
        status="limits not met" if missed else "converged",
        stop_reason=_reason(optimum, outcome),
        original=original.evaluation,
        result=result.web.evaluation,
        values=ShapeValues(original=original.values, result=result.web.values),
        change_percent=_changes(optimum),
        parameters=tuple(ShapeParameter(**dict(row), start=start.get(row.name)) for row in table.parameters),
        worst_case_percent=table.worst_case_percent,
        prices=_limit_prices(optimum, outcome),
        goal_on_cells=GoalWords.model_validate({goal.sense: on_cells}),
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
        loads=loads_name(loads) if stresses_in(goal.quantities) else None,
        in_shaft=in_shaft,
        unfinished=optimum.unfinished,
        balance=moved.told if moved else None,
        left_off=loads_left_off(scene, both or loads) or None,
    )


def _limit_prices(optimum: ShapeOptimum, outcome: GoalOutcome) -> tuple[LimitPrice, ...]:
    """Return what a percent of each limit costs in the goal, % of the original's, where that is known."""
    rest = 100 * optimum.multipliers.remainder
    fitted = [
        LimitPrice.model_validate(
            {"quantity": limit.quantity, "sense": limit.sense, "goal_percent_per_percent": float(price)}
        )
        for limit, price in zip(optimum.stated.limits, optimum.multipliers.limits, strict=True)
    ]
    return tuple(
        price.model_copy(update={"goal_percent_per_percent": price.known(outcome.limits, rest)})
        for price in fitted
    )


def _rule_prices(scene: Scene, optimum: ShapeOptimum) -> tuple[RulePrice, ...]:
    """Return what a unit of each rule and bound would give in the goal, % of the original's, where known."""
    web, paid, found = optimum.web, optimum.multipliers, dict[tuple[str, str], float]()
    if too_loose(100 * paid.remainder):
        return ()
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
        for name in QUANTITIES_TOLD
        if values.get(name) and original[name]
    }


def _sensitivities(scene: Scene, optimum: ShapeOptimum) -> SensitivityTable:
    web, values, original = optimum.web, optimum.result.values, optimum.original.values
    goal = optimum.stated, optimum.responses, original
    paid = None if too_loose(100 * optimum.multipliers.remainder) else optimum.multipliers
    holders = active_constraints(scene, web, values, rules_at(scene, web, values), goal, paid)
    found = dimension_sensitivities(web, values, optimum.responses, original, holders)
    return sensitivity_table(found, scene.shape.tolerance_mm)


def _reason(optimum: ShapeOptimum, outcome: GoalOutcome) -> str:
    result, count = optimum.result, len(optimum.rounds)
    if result.held:
        return f"every limit holds by the evaluation, web {optimum.best + 1} of {count} evaluated"
    worst = max(outcome.limits, key=lambda limit: limit.violation or 0.0)
    label, percent = QUANTITIES[worst.quantity].label, 100 * (worst.violation or 0.0)
    within = f", within the {100 * TOLERANCE:g} % that count as kept" if worst.holds else ""
    return f"{label} misses its limit by {percent:.2f} % by the evaluation{within}, best of {count} webs"
