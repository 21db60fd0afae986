"""Which physics a scene calls for, and why."""

from cranktopo.effects.cost import Cost, CostRates, Effort, bound_cell_mm, effort
from cranktopo.effects.effect import Effect, EffectPlan
from cranktopo.effects.planning import plan, planned_scene
from cranktopo.effects.simulated import simulated_scene, switched

__all__ = [
    "Cost",
    "CostRates",
    "Effect",
    "EffectPlan",
    "Effort",
    "bound_cell_mm",
    "effort",
    "plan",
    "planned_scene",
    "simulated_scene",
    "switched",
]
