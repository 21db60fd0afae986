"""An effect of the plan, and the plan itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from cranktopo.engine.plan.cost import Cost

Switch = Literal["on", "off"]


@dataclass(frozen=True)
class Effect:
    """One effect: whether the scene calls for it, and why.

    Attributes:
        name: name as in the scene's `[effects]`.
        estimate_percent: what the effect changes, in percent of the quantity named in the reason; None when
            nothing is known or no closed form exists.
        cost: what having it on costs.
        changes: what leaving it out changes.
    """

    name: str
    state: Switch
    reason: str
    estimate_percent: float | None
    cost: Cost
    changes: str

    def as_json(self) -> dict[str, Any]:
        """The effect as the metrics of every run hold it."""
        return {
            "name": self.name,
            "state": self.state,
            "reason": self.reason,
            "estimate_percent": self.estimate_percent,
            "cost": self.cost.as_json(),
            "changes": self.changes,
        }


@dataclass(frozen=True)
class EffectPlan:
    """The effects of a scene, in the order of the scene's table."""

    effects: tuple[Effect, ...]

    @property
    def enabled(self) -> frozenset[str]:
        """Names of the effects that are on, as `loads.load_cases` takes them."""
        return frozenset(effect.name for effect in self.effects if effect.state == "on")

    def __getitem__(self, name: str) -> Effect:
        return next(effect for effect in self.effects if effect.name == name)

    def as_json(self) -> list[dict[str, Any]]:
        """The effects as the metrics of every run hold them."""
        return [effect.as_json() for effect in self.effects]
