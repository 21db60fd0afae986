"""What a loop reached: its steps, why it ended, which is best, and what the shape optimisation made of it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cranktopo.base.progress import Json
from cranktopo.design.assumed import Assumption, assumed_json
from cranktopo.runs.kind import SHAPE
from cranktopo.tasks.iterate.settings import Settings
from cranktopo.tasks.iterate.shape_step import ShapeStep
from cranktopo.tasks.iterate.step import LoopStep


@dataclass(frozen=True)
class Outcome:
    """What the loop reached.

    Attributes:
        steps: the original web and every step done.
        stop_reason: why it ended.
        best: the step that gains most and beats the original web, if one does.
        notices: what a user may not expect, in sentences.
        lost: why the last step has no result; empty where every step has.
        assumed: what the design does not say and is assumed.
        shaped: the shape optimisation that the loop handed over to, once it has ended.
        bound: what no web of the envelope can beat, beside the best web, once it is proven.
    """

    folder: Path
    design: str
    steps: tuple[LoopStep, ...]
    stop_reason: str
    best: LoopStep | None
    settings: Settings
    notices: tuple[str, ...] = ()
    lost: str = ""
    assumed: tuple[Assumption, ...] = ()
    shaped: ShapeStep | None = None
    bound: Json | None = None

    @property
    def rows(self) -> tuple[LoopStep, ...]:
        """The original web, every step, and the web of the shape optimisation where that found one."""
        return (
            self.steps if self.shaped is None or self.shaped.row is None else (*self.steps, self.shaped.row)
        )

    def as_json(self) -> dict[str, Any]:
        """The content of iterate.json."""
        original = self.steps[0]
        return {
            "schema_version": 1,
            "design": self.design,
            "stop_reason": self.stop_reason,
            "least_transition_mm": self.settings.least_transition_mm,
            "best_step": None if self.best is None else self.best.number,
            "notices": list(self.notices),
            "lost_step": self.lost or None,
            "assumed": assumed_json(self.assumed),
            "steps": [{"name": self._name(step), **step.as_json(original)} for step in self.rows],
            "shape": None if self.shaped is None else self.shaped.as_json(),
            "bound": self.bound,
        }

    def _name(self, step: LoopStep) -> str:
        if step.number == 0:
            return "original"
        return str(step.number) if step.number < len(self.steps) else SHAPE
