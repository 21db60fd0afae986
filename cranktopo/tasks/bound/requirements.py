"""A goal and its limits as a bound takes them: compliances and sums over cells, small is good.

A stiffness is a load squared over a compliance. A limit that no convex statement can hold is left out, which
only adds webs: the bound stays one, but a looser one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from cranktopo.base.errors import CranktopoError, ExitCode, invalid
from cranktopo.design.goal.limit import Goal, Limit
from cranktopo.design.goal.quantities import STIFFNESS_OF, QuantityName

LINEAR = ("mass", "inertia", "unbalance")
STIFFNESSES: tuple[QuantityName, ...] = ("torsion", "bending")


@dataclass(frozen=True)
class Ceiling:
    """A limit on a compliance or a sum: sign * (value - limit) <= 0.

    Attributes:
        quantity: a load case, whose compliance counts, or a sum over cells.
        limit: over the value of the original web.
        told: the limit as the user knows it.
    """

    quantity: str
    sign: float
    limit: float
    told: Limit


@dataclass(frozen=True)
class Wanted:
    """What is minimised and what limits it, every quantity over its value for the original web.

    Attributes:
        quantity: what is minimised: a compliance, by its load case, or a sum over cells.
        per_mass: minimise its product with the mass.
        dropped: limits that are left out, each with the reason.
    """

    goal: Goal
    quantity: str
    per_mass: bool
    ceilings: tuple[Ceiling, ...]
    dropped: tuple[tuple[Limit, str], ...]

    def told(self, value: float, original: float) -> float:
        """The goal's own quantity for a value of what is minimised.

        Args:
            original: the goal's quantity of the original web.
        """
        return original / value if self.goal.sense == "maximise" else original * value


def wanted_of(goal: Goal, original: Mapping[str, float]) -> Wanted:
    """A goal as a bound takes it.

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
    ceilings, dropped = [], []
    for limit in goal.limits:
        found = _ceiling(limit, original)
        if isinstance(found, Ceiling):
            ceilings.append(found)
        else:
            dropped.append((limit, found))
    name = goal.quantity.removesuffix("_per_mass")
    return Wanted(goal, name, name != goal.quantity, tuple(ceilings), tuple(dropped))


def _ceiling(limit: Limit, original: Mapping[str, float]) -> Ceiling | str:
    """The limit as a ceiling, or why there is none."""
    if limit.quantity == "fatigue_safety":
        return "stress is not part of the proof"
    own = original[limit.quantity]
    if own == 0:
        return "the original's value is 0"
    share = limit.value / 100 if limit.percent else limit.value / own
    if limit.quantity in LINEAR:
        sign = 1.0 if (limit.sense == "<=") == (own > 0) else -1.0
        return Ceiling(limit.quantity, sign, share, limit)
    if limit.quantity.endswith("_per_mass"):
        return "a least stiffness per mass is not convex"
    if limit.quantity in STIFFNESS_OF and limit.sense == "<=":
        return Ceiling(STIFFNESS_OF[limit.quantity], 1.0, share, limit)
    if limit.quantity in STIFFNESSES and limit.sense == ">=":
        return Ceiling(limit.quantity, 1.0, 1 / share, limit)
    return "a web may not be too stiff: that is not convex"
