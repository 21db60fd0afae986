"""What a rule says about one effect before the scene's own choice is applied."""

from __future__ import annotations

from dataclasses import dataclass, field

from cranktopo.engine.plan.cost import Cost


@dataclass(frozen=True)
class Estimate:
    """The estimate of one effect.

    Attributes:
        percent: size of the effect, percent of the quantity that matters; None when it is not known.
        because: the estimate in words, with its numbers.
        changes: what leaving the effect out changes.
        absent: why `auto` leaves it out whatever its size; empty when the size decides.
        needed: why `auto` takes it in whatever its size; empty when the size decides.
        impossible: why it cannot be on at all; empty when it can.
        indispensable: why it cannot be off; empty when it can.
    """

    percent: float | None
    because: str
    changes: str
    cost: Cost = field(default_factory=Cost)
    absent: str = ""
    needed: str = ""
    impossible: str = ""
    indispensable: str = ""
