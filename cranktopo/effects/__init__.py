"""Which physics a scene calls for, and why."""

from cranktopo.effects.cost import Cost, CostRates, Effort, effort
from cranktopo.effects.effect import Effect, EffectPlan
from cranktopo.effects.planning import plan, planned_scene
from cranktopo.effects.simulated import simulated_scene

__all__ = [
    "Cost",
    "CostRates",
    "Effect",
    "EffectPlan",
    "Effort",
    "effort",
    "plan",
    "planned_scene",
    "simulated_scene",
]
