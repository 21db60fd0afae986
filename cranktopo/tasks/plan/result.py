"""The physics plan of a design: the JSON object of `plan --json`."""

from __future__ import annotations

from cranktopo.base.result import UNLESS_NONE, Result
from cranktopo.bodies.cells.outside import OutsideEnvelope
from cranktopo.design.assumed import Assumption
from cranktopo.design.goal.outcome import StatedGoal
from cranktopo.engine.plan.effect import Effect


class PlannedEvaluations(Result):
    """Body-fitted evaluations by which the limits of a goal are judged."""

    number: int
    seconds: float


class DesignPlan(Result):
    """Effects of a design, its goal, and what it leaves out."""

    schema_version: int = 1
    design: str
    goal: StatedGoal | None = UNLESS_NONE
    effects: tuple[Effect, ...]
    evaluations: PlannedEvaluations
    outside_envelope: OutsideEnvelope | None = UNLESS_NONE
    """Part of the web that lies outside of the envelope; none without an envelope, or of unlike halves."""
    assumed: tuple[Assumption, ...]
