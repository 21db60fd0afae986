"""iterate.json: the steps of a loop, why it ended, which is best, and what became of its shape."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

from pydantic import Field

from cranktopo.base.result import Result
from cranktopo.design.goal.outcome import GoalOutcome, GoalWords
from cranktopo.design.goal.quantities import QuantityName
from cranktopo.runs.kind import SHAPE
from cranktopo.tasks.bound.result import BoundStatements, NoBound
from cranktopo.tasks.designs.run_webs import LoopWeb, best_web
from cranktopo.tasks.iterate.step import LoopStep


class StepRow(LoopStep, LoopWeb):
    """A step with its ratios, and in percent of the original web."""

    torsion_per_mass_Nm_per_rad_kg: float
    bending_per_mass_N_per_mm_kg: float
    percent_of_original: dict[str, float]
    beats_original: bool

    @classmethod
    def of(cls, step: LoopStep, original: LoopStep, name: str) -> StepRow:
        """Return the row of a step."""
        return cls(
            **vars(step),
            name=name,
            torsion_per_mass_Nm_per_rad_kg=step.torsion_per_kg,
            bending_per_mass_N_per_mm_kg=step.bending_per_kg,
            percent_of_original=step.percent_of(original),
            beats_original=step.number > 0 and step.beats(original),
        )


class ShapeOutcome(Result):
    """Outcome of the shape optimisation that the loop handed over to.

    Attributes:
        reason: why it ended.
        goal: as shape.json has it, or what was asked for.
        better_than_best_step: whether its web is better for the goal than the loop's best step.
        best_step_percent: the goal's quantity of the best step, % of the original; None where there is none.
        not_judged_of_steps: limits of the goal that the loop does not know of its steps.
    """

    folder: str = SHAPE
    found: bool
    reason: str
    goal: GoalOutcome | GoalWords
    better_than_best_step: bool = False
    best_step_percent: float | None = None
    not_judged_of_steps: list[QuantityName] = Field(default_factory=list)


class LoopResult(Result):
    """Result of a loop, finished or after any of its steps.

    Attributes:
        best_step: the step that gains most and beats the original web, if one does.
        notices: what a user may not expect, in sentences.
        lost_step: why the last step has no result; None where every step has.
        assumed: what the design does not say and is assumed.
        steps: the original web, every step, and the web of the shape optimisation where that found one.
        bound: what no web of the envelope can beat, beside the best web, once it is proven.
    """

    schema_version: int = 1
    design: str
    stop_reason: str
    least_transition_mm: float
    best_step: int | None
    notices: list[str] = Field(default_factory=list)
    lost_step: str | None = None
    assumed: list[dict[str, Any]] = Field(default_factory=list)
    steps: list[StepRow]
    shape: ShapeOutcome | None = None
    bound: NoBound | BoundStatements | None = None

    @property
    def best(self) -> StepRow | None:
        """The best web, if one beats the original: of the shape optimisation, or of the best step."""
        shape_is_better = self.shape is not None and self.shape.better_than_best_step
        return best_web(self.steps, self.best_step, shape_is_better)

    @property
    def done(self) -> int:
        """Number of the steps of the loop itself."""
        return sum(row.words != SHAPE for row in self.steps) - 1


class LoopRun(NamedTuple):
    """A finished loop."""

    folder: Path
    result: LoopResult
