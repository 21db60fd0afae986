"""iterate.json: the steps of a loop, why it ended, which is best, and what became of its shape."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Literal, NamedTuple

from pydantic import Field

from cranktopo.base.errors import CranktopoError
from cranktopo.base.near_ties import clearly_more, exceeds, first_of_the_best
from cranktopo.base.result import UNLESS_NONE, FileName, Result
from cranktopo.design.assumed import Assumption
from cranktopo.design.goal.outcome import GoalOutcome, GoalWords
from cranktopo.design.goal.quantities import QuantityName
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.engine.histories import LoadsName
from cranktopo.runs.kind import SHAPE
from cranktopo.tasks.bound.result import BoundStatements, NoBound
from cranktopo.tasks.designs.run_webs import LoopWeb, best_web
from cranktopo.tasks.extraction.result import ShapedUndercuts
from cranktopo.tasks.refit.fit import usual_limits
from cranktopo.tasks.throw_fea.evaluation import Evaluation
from cranktopo.tasks.throw_fea.quantities import percent_of, throw_values
from cranktopo.throw.manufacturing_limits import ManufacturingLimits

_THIN_SHARE = 0.4
"""Least thickness beside a journal over that of the web, by default."""
_LIMITS = "rules"
"""Key of the limits in a manifest."""


@dataclass(frozen=True)
class Settings:
    """Settings of a loop.

    Attributes:
        steps: number of steps in which the volume falls to the design's volume fraction.
        least_transition_mm: thickness of the web around its journals below which the loop ends.
        element_size_mm: of the body-fitted mesh; None for its default.
        shape: whether the dimensions of the best web are optimised in the end.
    """

    steps: int
    least_transition_mm: float
    element_size_mm: float | None = None
    limits: ManufacturingLimits = field(default_factory=ManufacturingLimits)
    shape: bool = True

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> Settings:
        """Return the settings as a manifest keeps them; one of an older version has the usual limits."""
        try:
            others = {key: value for key, value in data.items() if key != _LIMITS}
            return cls(**others, limits=ManufacturingLimits(**data.get(_LIMITS, {})))
        except (TypeError, AttributeError):
            raise CranktopoError(
                "manifest.json: the loop's settings are damaged.", hint="Start a new loop."
            ) from None

    def as_json(self) -> dict[str, Any]:
        """Return the settings as a manifest keeps them."""
        data = asdict(self)
        limits = data.pop("limits")
        return {**data, _LIMITS: limits}


def loop_settings(
    scene: DesignLike,
    steps: int = 6,
    least_transition_mm: float | None = None,
    element_size_mm: float | None = None,
    limits: ManufacturingLimits | None = None,
    shape: bool = True,
) -> Settings:
    """Return the settings of a loop over a design; the least thickness is 40 % of the web's by default."""
    scene = as_scene(scene, whole=False)
    least_mm = least_transition_mm or _THIN_SHARE * scene.web.thickness_mm
    return Settings(steps, least_mm, element_size_mm, limits or usual_limits(scene), shape)


Verdict = Literal["better", "no gain", "too thin"]


class LoopStep(Result):
    """An evaluated web; step 0 is the original one.

    Attributes:
        torsion_Nm_per_rad: torsional stiffness with the scene's support.
        bending_N_per_mm: bending stiffness with the scene's support.
        transition_mm: least thickness of the web around its journals.
        overlap_percent: how much of the extracted web the re-model has in common with it (IoU); None for
            the original.
        removed_percent: volume that the optimiser was to take out of the envelope; None for the original.
        undercuts: what the process cannot leave; None for the original and in loops of an earlier version.
    """

    number: int
    throw_kg: float
    web_kg: float
    torsion_Nm_per_rad: float
    bending_N_per_mm: float
    torsion_error_percent: float
    bending_error_percent: float
    transition_mm: float
    overlap_percent: float | None
    removed_percent: float | None
    seconds: float
    undercuts: ShapedUndercuts | None = UNLESS_NONE

    @property
    def makeable(self) -> bool:
        """True unless the process that was asked for cannot make the web."""
        return self.undercuts is None or self.undercuts.makeable

    @property
    def torsion_per_kg(self) -> float:
        """Torsional stiffness per mass of the throw, N m/(rad kg): the target."""
        return self.torsion_Nm_per_rad / self.throw_kg

    @property
    def bending_per_kg(self) -> float:
        """Bending stiffness per mass of the throw, N/(mm kg)."""
        return self.bending_N_per_mm / self.throw_kg

    def beats(self, original: LoopStep) -> bool:
        """Tell whether it is no heavier, no softer in bending, and stiffer in torsion per mass."""
        return (
            not exceeds(self.throw_kg, original.throw_kg)
            and not exceeds(original.bending_N_per_mm, self.bending_N_per_mm)
            and clearly_more(self.torsion_per_kg, original.torsion_per_kg)
        )

    def too_thin(self, least_transition_mm: float) -> bool:
        """Tell whether the web beside a journal is thinner than allowed."""
        return exceeds(least_transition_mm, self.transition_mm)

    def values(self) -> dict[str, float]:
        """Return mass, stiffnesses and ratios by the keys of their quantities."""
        return throw_values(self.throw_kg, self.torsion_Nm_per_rad, self.bending_N_per_mm)

    def percent_of(self, original: LoopStep) -> dict[str, float]:
        """Return mass, stiffnesses and ratios in percent of the original web's."""
        return percent_of(self.values(), original.values())


def step_of(
    number: int,
    evaluation: Evaluation,
    transition_mm: float,
    overlap_percent: float | None = None,
    removed_percent: float | None = None,
    seconds: float = 0.0,
    undercuts: ShapedUndercuts | None = None,
) -> LoopStep:
    """Return a step from its evaluation and what else was measured; see `LoopStep`."""
    return LoopStep(
        number=number,
        throw_kg=evaluation.throw_kg,
        web_kg=evaluation.web_kg,
        torsion_Nm_per_rad=evaluation.torsion_Nm_per_rad,
        bending_N_per_mm=evaluation.bending_N_per_mm,
        torsion_error_percent=evaluation.torsion_error_percent,
        bending_error_percent=evaluation.bending_error_percent,
        transition_mm=transition_mm,
        overlap_percent=overlap_percent,
        removed_percent=removed_percent,
        seconds=seconds,
        undercuts=undercuts,
    )


def verdict(steps: Sequence[LoopStep], least_transition_mm: float) -> Verdict:
    """Return what the last of the steps (the original web first) says about going on."""
    last, before = steps[-1], steps[1:-1]
    if last.too_thin(least_transition_mm):
        return "too thin"
    if before and not clearly_more(last.torsion_per_kg, max(step.torsion_per_kg for step in before)):
        return "no gain"
    return "better"


def best_step(steps: Sequence[LoopStep], least_transition_mm: float) -> LoopStep | None:
    """Return the step that gains most in torsional stiffness per mass of those that beat the original web.

    Of steps that gain the same the first is taken; none whose web is too thin around its journals, and none
    that the process cannot make.
    """
    original, *others = steps
    sound = [s for s in others if s.beats(original) and s.makeable and not s.too_thin(least_transition_mm)]
    return first_of_the_best(sound, lambda step: step.torsion_per_kg) if sound else None


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
        left_off: loads that safety and stress do not count although they are above the threshold, in words.
        loads: load states of safety and stress, as shape.json has them.
        less_safe: what stands first where the web is less safe in its shaft, in words.
        in_shaft: what is told of its safety in the shaft, where a throw alone was judged, in words.
    """

    folder: FileName = SHAPE
    found: bool
    reason: str
    goal: GoalOutcome | GoalWords
    better_than_best_step: bool = False
    best_step_percent: float | None = None
    not_judged_of_steps: list[QuantityName] = Field(default_factory=list)
    left_off: str | None = UNLESS_NONE
    loads: LoadsName | None = UNLESS_NONE
    less_safe: str | None = UNLESS_NONE
    in_shaft: str | None = UNLESS_NONE


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
    assumed: tuple[Assumption, ...] = ()
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
