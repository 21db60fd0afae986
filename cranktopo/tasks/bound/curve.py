"""The largest stiffness over the mass, as the displacements of one bound prove it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cranktopo.design.goal.limit import Goal, Limit
from cranktopo.design.goal.quantities import QuantityName
from cranktopo.tasks.bound.lower_bound import Bound, BoundModel
from cranktopo.tasks.bound.proof import best_proof
from cranktopo.tasks.bound.requirements import Ceiling


def stiffest(quantity: QuantityName, mass_percent: float) -> Goal:
    """The largest stiffness of a web that is no heavier than a share of the original, %."""
    return Goal("maximise", quantity, (_no_heavier(mass_percent),))


def stiffness_percent(model: BoundModel, bound: Bound, masses_percent: Sequence[float]) -> list[float | None]:
    """What no web of each mass can beat in a bound's stiffness, % of the original's.

    Args:
        bound: of that stiffness, tightest at its own mass.

    Returns:
        None where no web is that light.
    """
    plane = model.plane(bound.displacements)
    goal = np.array([float(name == bound.wanted.quantity) for name in plane.names])
    found = []
    for percent in masses_percent:
        ceiling = Ceiling("mass", 1.0, percent / 100, _no_heavier(percent))
        value = best_proof(plane, goal, [ceiling], np.ones(1)).value
        found.append(100 / value if 0 < value < np.inf else None)
    return found


def _no_heavier(percent: float) -> Limit:
    return Limit("mass", "<=", percent, percent=True)
