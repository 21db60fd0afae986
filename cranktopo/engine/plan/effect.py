"""An effect of the plan, and the plan itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from cranktopo.base.result import Result
from cranktopo.engine.plan.cost import Cost

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
