"""Rules of the load cases: each matters by its strain energy, or because a goal is read off it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from cranktopo.design.goal.limit import Goal
from cranktopo.design.goal.quantities import QUANTITIES, QuantityName
from cranktopo.design.load_kinds import MAIN_KINDS
from cranktopo.engine.load_type import LoadType
from cranktopo.engine.plan.context import PlanningContext
from cranktopo.engine.plan.effect import Estimate


@dataclass(frozen=True)
class PlannedLoadType(LoadType):
    """A kind of load case with an estimate of its own.

    Attributes:
        estimate: by its rule; the others are estimated by `quasi_static`.
    """

    estimate: Callable[[PlanningContext], Estimate] = field(kw_only=True)


def quasi_static(load: LoadType, context: PlanningContext) -> Estimate:
    """Estimate a load on pin or journals by the closed-form strain energy that it causes."""
    size = getattr(context.state(load.name).case, load.load)
    amount = f"{size:,.1f} N m" if load.load == "torque_Nm" else f"{size:,.0f} N"
    return by_size_or_goal(context, load, f"{load.label} {amount}")


def by_size_or_goal(context: PlanningContext, load: LoadType, size: str) -> Estimate:
    """Return the estimate of a load case, whose need a goal decides where there is one.

    Args:
        size: the load in words.
    """
    found = _by_size(context, load.name, size)
    return found if context.goal is None else _for_goal(found, context.goal, load)


def _by_size(context: PlanningContext, kind: str, load: str) -> Estimate:
    cost, changes = context.costing.load_case(), f"no {kind} in the objective"
    if context.unit_loads:
        why = "unit loads cannot be compared"
        needed, absent = (why, "") if kind in MAIN_KINDS else ("", why)
        return Estimate(None, load, changes, cost, absent=absent, needed=needed)
    energy = context.energy_Nmm
    dominant = max(MAIN_KINDS, key=lambda name: energy[name])
    percent = 100 * energy[kind] / energy[dominant] if energy[dominant] else 0.0
    because = f"{load}: strain energy {percent:.3g} % of {dominant}'s"
    if kind == dominant:
        because = f"{load}: the largest strain energy ({energy[kind] / 1000:.3g} J)"
    weightless = getattr(context.scene.optimise.weights, kind) == 0
    absent = f"optimise.weights.{kind} is 0" if weightless else ""
    changes += f" ({percent:.3g} % of the largest energy)"
    changes += "; stress and fatigue count it by its size" if weightless else ""
    return Estimate(percent, because, changes, cost, absent=absent)


def _for_goal(estimate: Estimate, goal: Goal, load: LoadType) -> Estimate:
    """Return the estimate of a load case whose need a goal decides, not its size."""
    kind = load.name
    users = [f"{goal.sense} {goal.quantity}"] if QUANTITIES[goal.quantity].load_case == kind else []
    users += [str(limit) for limit in goal.limits if QUANTITIES[limit.quantity].load_case == kind]
    if not goal.load_cases and kind in MAIN_KINDS:  # which stand for the stress where there are no fillets
        users += users_of_stress(goal)
    if not users:
        absent, changes = "neither goal nor limits need it", "nothing"
        if kind not in MAIN_KINDS and users_of_stress(goal):
            judged = "fatigue safety" if wants_safety(goal) else "stress"
            absent, changes = f"{absent} on cells: the {judged} counts it", f"{changes} on cells"
        return replace(estimate, changes=changes, absent=absent, needed="")
    needed = f"the goal needs it: {', '.join(users)}"
    changes = f"{', '.join(users)} cannot be told"
    return replace(estimate, changes=changes, absent="", needed=needed, indispensable=needed)


def wants_safety(goal: Goal | None) -> str:
    """Tell why the goal needs the fatigue safety; empty when it does not."""
    users = [] if goal is None else users_of(goal, "fatigue_safety")
    return f"the goal needs it: {', '.join(users)}" if users else ""


def users_of_stress(goal: Goal) -> list[str]:
    """Return the sentences of a goal that speak of stress or safety."""
    return [user for name, of in QUANTITIES.items() if of.of_stress for user in users_of(goal, name)]


def users_of(goal: Goal, name: QuantityName) -> list[str]:
    """Return the sentences of a goal that speak of a quantity."""
    limits = [str(limit) for limit in goal.limits_of(name)]
    return [f"{goal.sense} {name}"] if goal.quantity == name else limits
