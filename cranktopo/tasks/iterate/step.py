"""One step of the loop as numbers: what was reached, and what of it beats the original web."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from cranktopo.base.near_ties import clearly_more, exceeds, first_of_the_best
from cranktopo.base.result import Result
from cranktopo.tasks.fea.evaluation import Evaluation
from cranktopo.tasks.fea.quantities import percent_of, throw_values

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
    found: Evaluation,
    transition_mm: float,
    overlap_percent: float | None = None,
    removed_percent: float | None = None,
    seconds: float = 0.0,
) -> LoopStep:
    """Return a step from its evaluation and what else was measured; see `LoopStep`."""
    return LoopStep(
        number=number,
        throw_kg=found.throw_kg,
        web_kg=found.web_kg,
        torsion_Nm_per_rad=found.torsion_Nm_per_rad,
        bending_N_per_mm=found.bending_N_per_mm,
        torsion_error_percent=found.torsion_error_percent,
        bending_error_percent=found.bending_error_percent,
        transition_mm=transition_mm,
        overlap_percent=overlap_percent,
        removed_percent=removed_percent,
        seconds=seconds,
    )


def verdict(steps: Sequence[LoopStep], least_transition_mm: float) -> Verdict:
    """Return what the last of the steps (the original web first) says about going on.

    Args:
        least_transition_mm: thickness of the web around its journals below which the loop ends.
    """
    last, before = steps[-1], steps[1:-1]
    if last.too_thin(least_transition_mm):
        return "too thin"
    if before and not clearly_more(last.torsion_per_kg, max(step.torsion_per_kg for step in before)):
        return "no gain"
    return "better"


def best_step(steps: Sequence[LoopStep], least_transition_mm: float) -> LoopStep | None:
    """Return the step that gains most in torsional stiffness per mass of those that beat the original web.

    Of steps that gain the same the first is taken.

    Args:
        steps: all steps, the original web first.
        least_transition_mm: least thickness of the web around its journals that counts as sound.
    """
    original, *others = steps
    sound = [s for s in others if s.beats(original) and not s.too_thin(least_transition_mm)]
    return first_of_the_best(sound, lambda step: step.torsion_per_kg) if sound else None
