"""The estimate of an effect, the effect as it is decided, and the plan of all."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from cranktopo.base.result import Result
from cranktopo.engine.plan.cost import Cost


@dataclass(frozen=True)
class Estimate:
    """The estimate of one effect by its rule, before the scene's own choice is applied.

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


Switch = Literal["on", "off"]


class Effect(Result):
    """One effect: on or off, and why."""

    name: str
    """Name as in the scene's `[effects]`."""
    state: Switch
    reason: str
    estimate_percent: float | None
    """Change by the effect in percent of the quantity named in the reason; None when nothing is known or no
    closed form exists."""
    cost: Cost
    """Cost of having it on."""
    changes: str
    """Consequence of leaving it out."""


@dataclass(frozen=True)
class PhysicsPlan:
    """The effects of a scene, in the order of the scene's table."""

    effects: tuple[Effect, ...]

    @property
    def enabled(self) -> frozenset[str]:
        """Names of the effects that are on, as `loads.load_cases` takes them."""
        return frozenset(effect.name for effect in self.effects if effect.state == "on")

    def __getitem__(self, name: str) -> Effect:
        return next(effect for effect in self.effects if effect.name == name)

    def as_json(self) -> list[dict[str, object]]:
        """Return the effects as the metrics of every run hold them."""
        return [effect.as_json() for effect in self.effects]
