"""What is wanted of a web: a goal and limits, in words that every optimiser understands."""

from cranktopo.scene.goal.limit import Goal, Limit, LimitSense
from cranktopo.scene.goal.quantities import QUANTITIES, GoalQuantity, QuantityName

__all__ = ["QUANTITIES", "Goal", "GoalQuantity", "Limit", "LimitSense", "QuantityName"]
