"""The goal of a scene with every limit that counts: read, changed on request, checked."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import Any

from pydantic import ValidationError

from cranktopo.base.errors import CranktopoError, ExitCode, invalid, quoted
from cranktopo.design.balance_factor import rods_kg_mm
from cranktopo.design.crank_throws import throw_count
from cranktopo.design.goal.limit import Goal, GoalTable, Limit, LimitsTable, read_limits
from cranktopo.design.goal.quantities import QUANTITIES, Optimiser, QuantityName, nearest_quantity
from cranktopo.design.messages import explain, listed
from cranktopo.design.schema import Scene

_LIMIT = re.compile(r"\s*([^\s<>=!~≤≥]*)\s*(.*)", re.S)
_KEPT: tuple[QuantityName, ...] = ("mass", "torsion", "bending", "fatigue_safety")
"""Quantities that may not become worse than the original's unless the goal or a limit says otherwise."""


def with_goal(
    scene: Scene, *, minimise: str | None = None, maximise: str | None = None, limits: Sequence[str] = ()
) -> Scene:
    """Return the scene with another goal or with other limits.

    Args:
        minimise, maximise: a new goal in place of the scene's, whose limits go with it.
        limits: such as `torsion >= 100 %` or `bending none`, in place of what the scene and the goal by
            default say of that quantity; two of one quantity are a range.

    Raises:
        CranktopoError: limits without a goal, or a goal or limit that makes no sense.
    """
    goals = {"minimise": minimise, "maximise": maximise}
    table: dict[str, Any] = {key: value for key, value in goals.items() if value is not None}
    if not table and not limits:
        return scene
    if not table and scene.goal is not None:
        table = scene.goal.model_dump(exclude_none=True)
    table["limits"] = {**table.get("limits", {}), **limits_by_quantity(limits)}
    try:
        goal = GoalTable.model_validate(table)
    except ValidationError as error:
        wrong = explain(error, scene.name, ("goal",))
        raise CranktopoError(wrong.message, hint=wrong.hint, code=ExitCode.USAGE) from None
    scene = scene.model_copy(update={"goal": goal})
    check_goal(scene)
    return scene


def limits_by_quantity(texts: Sequence[str]) -> dict[str, str | tuple[str, ...]]:
    """Return limits as the scene's table has them; an unknown quantity is refused."""
    found: dict[str, tuple[str, ...]] = {}
    for text in texts:
        match = _LIMIT.fullmatch(text)
        name, rest = match.groups() if match else ("", text)
        if name not in QUANTITIES:
            what = (
                f"unknown quantity {quoted(name, 60)}" if name else "must begin with the name of a quantity"
            )
            message = f"limit {quoted(text)}: {what}."
            raise CranktopoError(message, hint=nearest_quantity(name), code=ExitCode.USAGE)
        found[name] = (*found.get(name, ()), rest.strip())
    return {name: rest[0] if len(rest) == 1 else rest for name, rest in found.items()}


def goal_of(scene: Scene) -> Goal | None:
    """Return the goal of a scene, if any, with its limits: those given, then those that the goal brings.

    By default nothing gets worse: mass stays at most, both stiffnesses and the fatigue safety at least 100 %
    of the original, but for the goal's own quantity; a stiffness per mass stands for that stiffness. With a
    counterweight the unbalance stays at most as it is, unless a balance factor is asked for: a smaller one
    would only pass for a lighter web. A goal does not drive the unbalance below 0. The safety is left out
    where the scene cannot give one. A given limit replaces the default one of its quantity.
    """
    if scene.goal is None:
        return None
    quantity = scene.goal.quantity
    stated = _stated_limits(scene.goal.limits)
    said = {name for name in QUANTITIES if getattr(scene.goal.limits, name) is not None}
    more = tuple(limit for limit in _default(scene, quantity) if limit.quantity not in said)
    return Goal("minimise" if scene.goal.minimise else "maximise", quantity, (*stated, *more))


def require_goal(scene: Scene, task: str, example: str) -> Goal:
    """Return the goal of a scene for a task that needs one; the refusal names an example to maximise."""
    goal = goal_of(scene)
    if goal is None:
        raise CranktopoError(
            f"goal: a {task} needs one.",
            hint=f"Give --minimise mass, or --maximise {example}, or a [goal] table.",
            code=ExitCode.USAGE,
        )
    return goal


def asks_for(scene: Scene, *quantities: QuantityName) -> bool:
    """Tell whether the goal of a scene, or one of its limits, is of one of some quantities."""
    goal = goal_of(scene)
    return goal is not None and not goal.quantities.isdisjoint(quantities)


def judged_by_evaluation(scene: Scene) -> bool:
    """Tell whether a density optimisation has limits that are to hold by the evaluation of its surface."""
    goal = goal_of(scene)
    if goal is None or not scene.optimise.limits_by_evaluation:
        return False
    return any("density" in QUANTITIES[limit.quantity].optimisers for limit in goal.limits)


def _stated_limits(table: LimitsTable) -> tuple[Limit, ...]:
    texts = ((quantity, getattr(table, name)) for name, quantity in QUANTITIES.items())
    return tuple(limit for what, text in texts if text is not None for limit in read_limits(what, text))


def _default(scene: Scene, goal: QuantityName) -> tuple[Limit, ...]:
    kept = tuple(
        Limit(name, ">=" if QUANTITIES[name].better == "high" else "<=", 100.0, percent=True, assumed=True)
        for name in _KEPT
        if name != goal.removesuffix("_per_mass") and not (name == "fatigue_safety" and _no_safety(scene))
    )
    if goal == "unbalance":
        return (*kept, Limit("unbalance", ">=", 0.0, assumed=True))
    balanced = (Limit("unbalance", "<=", 100.0, percent=True, assumed=True),)
    own_balance = goal == "balance_factor" or (scene.goal and scene.goal.limits.balance_factor)
    return (*kept, *balanced) if scene.web.counterweight and not own_balance else kept


def _no_safety(scene: Scene) -> str:
    """Return why the scene has no safety against fatigue; empty where it has one."""
    if unknown := _no_stress_level(scene):
        return unknown
    if scene.effects.fatigue == "off":
        return "effects.fatigue is 'off'"
    if scene.material.fatigue_bending_MPa is None:
        return "needs material.fatigue_bending_MPa"
    return _no_fillets(scene)


def _no_stress_level(scene: Scene) -> str:
    engine = scene.engine
    if engine is None:
        return "needs an [engine]: unit loads give no stress level"
    if engine.gas is None and None in (engine.max_gas_force_N, engine.max_torque_Nm):
        return "needs [engine.gas], or engine.max_gas_force_N and max_torque_Nm"
    return ""


def _no_fillets(scene: Scene) -> str:
    sharp = 0 in (scene.throw.main_journal.fillet_mm, scene.throw.crankpin.fillet_mm)
    return "needs fillets at both journals" if sharp else ""


def check_goal(scene: Scene) -> None:
    """Check that the limits leave the goal its sense and that the scene can tell every quantity."""
    goal = goal_of(scene)
    if goal is None:
        return
    problems = [*_goal_problems(scene, goal), *_limit_problems(scene, goal)]
    if problems:
        raise listed(problems, scene.name)


def check_known(goal: Goal, optimiser: Optimiser) -> None:
    """Check that an optimiser knows what it is asked for; limits that it does not know, it may leave.

    Raises:
        CranktopoError: a goal that it cannot tell, or that rests on limits alone that it cannot tell.
    """
    if optimiser not in QUANTITIES[goal.quantity].optimisers:
        raise invalid(
            f"goal.{goal.sense}",
            goal.quantity,
            f"the {optimiser} optimisation cannot tell the {QUANTITIES[goal.quantity].label} of a design",
            "Choose another goal; the evaluation of its result tells it.",
        )
    if optimiser == "density" and goal.limits_of("stress"):
        raise invalid(
            "goal.limits.stress",
            " and ".join(limit.condition for limit in goal.limits_of("stress")),
            "the density optimisation has no fillets, whose stress this is",
            "Use `cranktopo shape`, or leave this limit out.",
        )
    if optimiser == "density" and goal.held_by_elements_alone:
        raise invalid(
            f"goal.{goal.sense}",
            goal.quantity,
            f"the density optimisation leaves {_left_to_elements(goal)} to the evaluation of its surface, "
            "and no limit asks for a stiffness",
            "Limit torsion or bending, or use `cranktopo shape`.",
        )


def _left_to_elements(goal: Goal) -> str:
    found = (QUANTITIES[limit.quantity] for limit in goal.limits)
    return " and ".join(dict.fromkeys(f"the {one.label}" for one in found if "density" not in one.optimisers))


def _goal_problems(scene: Scene, goal: Goal) -> Iterator[tuple[str, str]]:
    quantity, key = QUANTITIES[goal.quantity], f"goal.{goal.sense} = '{goal.quantity}'"
    unknown = _cannot_tell(scene, goal.quantity)
    if unknown:
        yield f"{key}: {quantity.label} {unknown}", "Give what it needs, or choose another goal."
    if any(not limit.assumed for limit in goal.limits_of(goal.quantity)):
        yield (
            f"{_written(scene, goal.quantity)}: the goal itself makes it as {quantity.better} as the other "
            "limits allow",
            "Leave this limit out, or choose another goal.",
        )
    held = goal.load_cases or any(QUANTITIES[limit.quantity].of_stress for limit in goal.limits)
    if quantity.better == "low" and not held:
        yield (
            f"{key}: no limit asks for a stiffness, and no web at all would be best",
            "Limit torsion or bending.",
        )


def _limit_problems(scene: Scene, goal: Goal) -> Iterator[tuple[str, str]]:
    for name in dict.fromkeys(limit.quantity for limit in goal.limits if not limit.assumed):
        unknown = _cannot_tell(scene, name)
        if unknown:
            case = QUANTITIES[name].load_case
            instead = f"limit {case} instead" if case else "leave this limit out"
            yield (
                f"{_written(scene, name)}: {QUANTITIES[name].label} {unknown}",
                f"Give what it needs, or {instead}.",
            )


def _written(scene: Scene, name: QuantityName) -> str:
    assert scene.goal is not None
    return f"goal.limits.{name} = {quoted(getattr(scene.goal.limits, name))}"


def _cannot_tell(scene: Scene, name: QuantityName) -> str:
    """Tell why the scene does not give a quantity its size; empty where it does."""
    if name == "balance_factor" and not rods_kg_mm(scene)[1]:
        return "needs [engine.masses]: without them nothing oscillates"
    if name == "natural_frequency":
        return _no_frequency(scene)
    if QUANTITIES[name].of_bearings:
        return _no_film(scene)
    if not QUANTITIES[name].engine_load:
        return ""
    if name == "stress":
        return _no_stress_level(scene) or _no_fillets(scene)
    return _no_safety(scene) if name == "fatigue_safety" else _no_load(scene, QUANTITIES[name].load_case)


def _no_frequency(scene: Scene) -> str:
    shaft, crank = scene.shaft, scene.crank
    if scene.engine is None:
        return "needs an [engine]: it has the throws of the shaft"
    if shaft is not None and shaft.gives_stiffness:
        return "needs the stiffness that the web gives a throw: leave out that of [shaft], which is fixed"
    if crank is not None and not crank.uniform:
        return "needs a crank whose throws are all alike"
    joined = shaft is not None and any((shaft.pulley, shaft.damper, shaft.has_takeoff))
    if throw_count(scene) == 1 and not joined and not (crank and crank.end):
        return "needs more than one throw, or what turns with it in [shaft]: one disk alone does not swing"
    return ""


def _no_film(scene: Scene) -> str:
    if scene.bearings is None:
        return "needs [bearings]: clearance and oil make the film"
    if scene.engine is None or scene.engine.gas is None or not scene.engine.speed_rpm:
        return "needs [engine.gas] and engine.speed_rpm: they load the bearings over the cycle"
    return ""


def _no_load(scene: Scene, case: str) -> str:
    """Tell why a load case carries a unit load; empty where the engine gives its size."""
    if scene.engine is None:
        return "needs an [engine]: without one the load is a unit load"
    key = "max_gas_force_N" if case == "bending" else "max_torque_Nm"
    if scene.engine.gas is None and getattr(scene.engine, key) is None:
        return f"needs [engine.gas] or engine.{key}: without them the load is a unit load"
    return ""
