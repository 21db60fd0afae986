"""The limits of a design's goal by the evaluation: the optimiser's own model has not the last word."""

from __future__ import annotations

from collections.abc import Sequence

from cranktopo.design.goal.outcome import GoalOutcome, goal_outcome
from cranktopo.design.goal.wanted import wanted
from cranktopo.tasks.compare.result import Entry
from cranktopo.tasks.fea.goal_values import goal_values
from cranktopo.tasks.fea.targets import Target


def evaluated_goals(
    targets: Sequence[Target], entries: Sequence[Entry], baseline: int
) -> dict[str, GoalOutcome]:
    """Goal and limits of every target that has a goal, but for the baseline, by name of the target.

    Args:
        entries: of the targets, in their order; percent are of the baseline's values.
    """
    original = _values(targets[baseline], entries[baseline])
    found = {}
    for row, (target, entry) in enumerate(zip(targets, entries, strict=True)):
        goal = wanted(target.scene)
        if goal is not None and row != baseline:
            found[target.name] = goal_outcome(goal, _values(target, entry), original)
    return found


def _values(target: Target, entry: Entry) -> dict[str, float]:
    return goal_values(
        target.scene, entry.evaluation.result.model_copy(update={"fatigue_safety": entry.safety})
    )
