"""Consistency of a goal with its limits and with what the scene can tell."""

from __future__ import annotations

from collections.abc import Iterator

from cranktopo.base.errors import invalid, quoted
from cranktopo.design.goal.limit import Goal
from cranktopo.design.goal.quantities import QUANTITIES, Optimiser, QuantityName
from cranktopo.design.goal.wanted import no_safety, wanted
from cranktopo.design.messages import listed
from cranktopo.design.schema import Scene


def check_goal(scene: Scene) -> None:
    """Check that the limits leave the goal its sense and that the scene can tell every quantity.

    Raises:
        CranktopoError: every inconsistency found.
    """
    goal = wanted(scene)
    if goal is None:
        return
    problems = [*_goal_problems(scene, goal), *_limit_problems(scene, goal)]
    if problems:
        raise listed(problems, scene.name)


def check_known(goal: Goal, optimiser: Optimiser) -> None:
    """Check that an optimiser knows what it is asked for; limits that it does not know, it may leave.

    Raises:
        CranktopoError: it does not.
    """
    if optimiser not in QUANTITIES[goal.quantity].optimisers:
        raise invalid(
            f"goal.{goal.sense}",
            goal.quantity,
            f"the {optimiser} optimisation cannot tell the {QUANTITIES[goal.quantity].label} of a design",
            "Choose another goal; the evaluation of its result tells it.",
        )


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
    held = goal.load_cases or any(limit.quantity == "fatigue_safety" for limit in goal.limits)
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
    """Return a limit as the scene gives it."""
    assert scene.goal is not None
    return f"goal.limits.{name} = {quoted(getattr(scene.goal.limits, name))}"


def _cannot_tell(scene: Scene, name: QuantityName) -> str:
    """Why the scene does not give a quantity its size; empty where it does."""
    if not QUANTITIES[name].engine_load:
        return ""
    return no_safety(scene) if name == "fatigue_safety" else _no_load(scene, QUANTITIES[name].load_case)


def _no_load(scene: Scene, case: str) -> str:
    """Why a load case carries a unit load; empty where the engine gives its size."""
    if scene.engine is None:
        return "needs an [engine]: without one the load is a unit load"
    given = scene.engine.max_gas_force_N if case == "bending" else scene.engine.max_torque_Nm
    key = "max_gas_force_N" if case == "bending" else "max_torque_Nm"
    if scene.engine.gas is None and given is None:
        return f"needs [engine.gas] or engine.{key}: without them the load is a unit load"
    return ""
