"""The goal of a scene with every limit that counts, those that go without saying included."""

from __future__ import annotations

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.design.goal.limit import Goal, Limit, read_limits
from cranktopo.design.goal.quantities import QUANTITIES, QuantityName
from cranktopo.design.goal.table import LimitsTable
from cranktopo.design.schema import Scene

_KEPT: tuple[QuantityName, ...] = ("mass", "torsion", "bending", "fatigue_safety")
"""Quantities that may not become worse than the original's unless the goal or a limit says otherwise."""


def wanted(scene: Scene) -> Goal | None:
    """Return the goal of a scene with its limits: those that are given, then those that the goal brings.

    By default nothing gets worse: mass stays at most, both stiffnesses and the fatigue safety at least 100 %
    of the original, but for the goal's own quantity; a stiffness per mass stands for that stiffness. With a
    counterweight the unbalance stays at most as it is: a smaller one would only pass for a lighter web. A
    goal does not drive the unbalance below 0. The safety is left out where the scene cannot give one. A given
    limit replaces the default one of its quantity.

    Returns:
        None for a scene without a goal.
    """
    if scene.goal is None:
        return None
    quantity = scene.goal.quantity
    given = _given(scene.goal.limits)
    said = {name for name in QUANTITIES if getattr(scene.goal.limits, name) is not None}
    more = tuple(limit for limit in _default(scene, quantity) if limit.quantity not in said)
    return Goal("minimise" if scene.goal.minimise else "maximise", quantity, (*given, *more))


def require_goal(scene: Scene, task: str, example: str) -> Goal:
    """Return the goal of a scene for a task that needs one.

    Args:
        example: a quantity that it might maximise, for the message.

    Raises:
        CranktopoError: the scene has none (exit code 2).
    """
    goal = wanted(scene)
    if goal is None:
        raise CranktopoError(
            f"goal: a {task} needs one.",
            hint=f"Give --minimise mass, or --maximise {example}, or a [goal] table.",
            code=ExitCode.USAGE,
        )
    return goal


def judged_by_evaluation(scene: Scene) -> bool:
    """Tell whether a density optimisation has limits that are to hold by the evaluation of its surface."""
    goal = wanted(scene)
    if goal is None or not scene.optimise.limits_by_evaluation:
        return False
    return any("density" in QUANTITIES[limit.quantity].optimisers for limit in goal.limits)


def _given(table: LimitsTable) -> tuple[Limit, ...]:
    texts = ((quantity, getattr(table, name)) for name, quantity in QUANTITIES.items())
    return tuple(limit for what, text in texts if text is not None for limit in read_limits(what, text))


def _default(scene: Scene, goal: QuantityName) -> tuple[Limit, ...]:
    kept = tuple(
        Limit(name, ">=" if QUANTITIES[name].better == "high" else "<=", 100.0, percent=True, assumed=True)
        for name in _KEPT
        if name != goal.removesuffix("_per_mass") and not (name == "fatigue_safety" and no_safety(scene))
    )
    if goal == "unbalance":
        return (*kept, Limit("unbalance", ">=", 0.0, assumed=True))
    balanced = (Limit("unbalance", "<=", 100.0, percent=True, assumed=True),)
    return (*kept, *balanced) if scene.web.counterweight else kept


def no_safety(scene: Scene) -> str:
    """Return why the scene has no safety against fatigue; empty where it has one."""
    throw = scene.throw
    if scene.engine is None:
        return "needs an [engine]: unit loads give no stress level"
    engine = scene.engine
    if engine.gas is None and None in (engine.max_gas_force_N, engine.max_torque_Nm):
        return "needs [engine.gas], or engine.max_gas_force_N and max_torque_Nm"
    if scene.effects.fatigue == "off":
        return "effects.fatigue is 'off'"
    if scene.material.fatigue_bending_MPa is None:
        return "needs material.fatigue_bending_MPa"
    if throw.main_journal.fillet_mm == 0 or throw.crankpin.fillet_mm == 0:
        return "needs fillets at both journals"
    return ""
