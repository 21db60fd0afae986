"""The goal of a sweep's optimisations, with limits of which one or more vary: an epsilon-constraint sweep."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from cranktopo.design.goal.wanted import limits_by_quantity, with_goal
from cranktopo.design.loading import scene_from_dict
from cranktopo.tasks.sweep.variation import Variation, read_text

LIMITS = "goal.limits"


def varied_limits(limits: Sequence[str]) -> tuple[list[str], list[Variation]]:
    """Limits that stay, and those with several values, such as `torsion >= 90:130:5 %`.

    Raises:
        CranktopoError: an unknown quantity, or a range without numbers.
    """
    fixed: list[str] = []
    varied: list[Variation] = []
    for name, value in limits_by_quantity(limits).items():
        texts = [value] if isinstance(value, str) else list(value)
        found = read_text(f"{LIMITS}.{name}", texts[0])
        if len(texts) == 1 and len(found.values) > 1:
            varied.append(found)
        else:
            fixed += [f"{name} {text}" for text in texts]
    return fixed, varied


def with_goal_tables(
    tables: dict[str, Any], design: str, minimise: str | None, maximise: str | None, limits: Sequence[str]
) -> dict[str, Any]:
    """Return the tables of a scene with another goal or other limits, as `with_goal` changes a scene.

    Raises:
        CranktopoError: a goal or limit that makes no sense.
    """
    if minimise is None and maximise is None and not limits:
        return tables
    scene = scene_from_dict(tables, design, whole=True)
    goal = with_goal(scene, minimise=minimise, maximise=maximise, limits=limits).goal
    return tables if goal is None else {**tables, "goal": goal.model_dump(mode="json", exclude_defaults=True)}
