"""Changes that counterweights and balancer shafts make to the free forces and moments, order by order."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from cranktopo.base.units import number_text
from cranktopo.engine.balance.whole_engine import AS_IT_IS
from cranktopo.tasks.balance.result import Balance, StateForces

Vector = Literal["force", "moment"]
VECTORS: dict[Vector, str] = {"force": "N", "moment": "N m"}
"""Free forces and moments of an order, with their units."""
_COUNTS = 0.01
"""Change that is told, over the largest value of any order and state."""


@dataclass(frozen=True)
class OrderChange:
    """The free force (N) or moment (N m) of an order, as the engine is and in another state."""

    order: int
    before: float
    after: float
    unit: str

    @property
    def words(self) -> str:
        """Both values, such as `21 to 5188 N`."""
        return f"{number_text(self.before)} to {number_text(self.after)} {self.unit}"


def size_of(entry: StateForces, vector: Vector) -> float:
    """Return the largest size over a turn of what an order leaves free."""
    return entry.force_N if vector == "force" else entry.moment_Nm


def largest_order(data: Balance, vector: Vector, state: str) -> tuple[int, float]:
    """Return the order that leaves most free in a state, of equal ones the lowest, and how much."""
    sizes = [(size_of(entry, vector), entry.order) for entry in data.free if entry.state == state]
    size, order = max(sizes, key=lambda one: float(f"{one[0]:.6g}"))
    return order, size


def order_changes(data: Balance, vector: Vector, state: str) -> tuple[OrderChange, ...]:
    """Return the orders that a state changes by more than a hundredth of the largest of all."""
    sizes = {(entry.state, entry.order): size_of(entry, vector) for entry in data.free}
    least = _COUNTS * max(sizes.values())
    found = (
        OrderChange(order, sizes[AS_IT_IS, order], after, VECTORS[vector])
        for (where, order), after in sizes.items()
        if where == state
    )
    return tuple(one for one in found if abs(one.after - one.before) > least)
