"""A goal and its limits as a bound takes them: compliances and sums over cells, small is good.

A stiffness is a load squared over a compliance. A limit that no convex statement can hold is left out, which
only adds webs: the bound stays one, but a looser one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from cranktopo.base.errors import CranktopoError, ExitCode, invalid
from cranktopo.design.goal.constraint import Constraint
from cranktopo.design.goal.limit import Goal, Limit
from cranktopo.design.goal.quantities import STIFFNESS_OF, QuantityName

LINEAR = ("mass", "inertia", "unbalance")
STIFFNESSES: tuple[QuantityName, ...] = ("torsion", "bending")


@dataclass(frozen=True)
class ConvexProblem:
    """Objective and constraints, every quantity over its value for the original web.

    Attributes:
        quantity: what is minimised: a compliance, by its load case, or a sum over cells.
        per_mass: minimise its product with the mass.
        constraints: on compliances, by their load cases, and on sums over cells.
        limits: the constraints as the user knows them.
        dropped: limits that are left out, each with the reason.
    """

    goal: Goal
    quantity: str
    per_mass: bool
    constraints: tuple[Constraint, ...]
    limits: tuple[Limit, ...]
    dropped: tuple[tuple[Limit, str], ...]

    def goal_value(self, value: float, original: float) -> float:
        """Return the goal's own quantity for a value of what is minimised.

        Args:
            original: the goal's quantity of the original web.
        """
        return original / value if self.goal.sense == "maximise" else original * value


def convex_problem(goal: Goal, original: Mapping[str, float]) -> ConvexProblem:
    """Return a goal as a bound takes it.

    Args:
        original: quantities of the original web in the same model.

    Raises:
        CranktopoError: a goal about which nothing can be proven.
    """
    if goal.quantity == "fatigue_safety":
        raise invalid(
            f"goal.{goal.sense}",
            goal.quantity,
            "a bound is proven for mass, inertia, unbalance and stiffness, not for stress",
            "Name another goal; limits of fatigue safety are left out, which keeps the bound valid.",
        )
    if goal.quantity == "unbalance" and original["unbalance"] <= 0:
        raise CranktopoError(
            f"goal: the original's unbalance is {original['unbalance']:.4g} kg mm, not above 0, and a "
            "bound is told by its share.",
            hint="Minimise the mass or the inertia.",
            code=ExitCode.INVALID_INPUT,
        )
    found = [(limit, _constraint(limit, original)) for limit in goal.limits]
    kept = [(limit, one) for limit, one in found if isinstance(one, Constraint)]
    dropped = tuple((limit, why) for limit, why in found if isinstance(why, str))
    name = goal.quantity.removesuffix("_per_mass")
    constraints, limits = tuple(one for _, one in kept), tuple(limit for limit, _ in kept)
    return ConvexProblem(goal, name, name != goal.quantity, constraints, limits, dropped)


def _constraint(limit: Limit, original: Mapping[str, float]) -> Constraint | str:
    """Return the limit over the original's value, or why no convex statement holds it."""
    if limit.quantity == "fatigue_safety":
        return "stress is not part of the proof"
    own = original[limit.quantity]
    if own == 0:
        return "the original's value is 0"
    share = limit.value / 100 if limit.percent else limit.value / own
    if limit.quantity in LINEAR:
        return Constraint(limit.quantity, "<=" if (limit.sense == "<=") == (own > 0) else ">=", share)
    if limit.quantity.endswith("_per_mass"):
        return "a least stiffness per mass is not convex"
    if limit.quantity in STIFFNESS_OF and limit.sense == "<=":
        return Constraint(STIFFNESS_OF[limit.quantity], "<=", share)
    if limit.quantity in STIFFNESSES and limit.sense == ">=":
        return Constraint(limit.quantity, "<=", 1 / share)
    return "a web may not be too stiff: that is not convex"
