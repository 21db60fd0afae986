"""Another goal or other limits for a scene, as the command line and scripts give them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from pydantic import ValidationError

from cranktopo.base.errors import CranktopoError, ExitCode, quoted
from cranktopo.design.checks.goal import check_goal
from cranktopo.design.goal.quantities import QUANTITIES, nearest_quantity
from cranktopo.design.goal.table import GoalTable
from cranktopo.design.messages import explain
from cranktopo.design.schema import Scene

_LIMIT = re.compile(r"\s*([^\s<>=!~≤≥]*)\s*(.*)", re.S)


def with_goal(
    scene: Scene, *, minimise: str | None = None, maximise: str | None = None, limits: Sequence[str] = ()
) -> Scene:
    """Return the scene with another goal or with other limits.

    Args:
        minimise, maximise: a new goal in place of the scene's, whose limits go with it.
        limits: such as `torsion >= 100 %` or `bending none`, in place of what the scene and the goal by
            default say of that quantity; two of one quantity are a range.

    Raises:
        CranktopoError: limits without a goal, or a goal or limit that makes no sense.
    """
    goals = {"minimise": minimise, "maximise": maximise}
    table: dict[str, Any] = {key: value for key, value in goals.items() if value is not None}
    if not table and not limits:
        return scene
    if not table and scene.goal is not None:
        table = scene.goal.model_dump(exclude_none=True)
    table["limits"] = {**table.get("limits", {}), **limits_by_quantity(limits)}
    try:
        goal = GoalTable.model_validate(table)
    except ValidationError as error:
        raise _wrong_use(explain(error, scene.name, ("goal",))) from None
    scene = scene.model_copy(update={"goal": goal})
    check_goal(scene)
    return scene


def limits_by_quantity(texts: Sequence[str]) -> dict[str, str | tuple[str, ...]]:
    """Return limits as the scene's table has them.

    Raises:
        CranktopoError: an unknown quantity.
    """
    found: dict[str, tuple[str, ...]] = {}
    for text in texts:
        match = _LIMIT.fullmatch(text)
        name, rest = match.groups() if match else ("", text)
        if name not in QUANTITIES:
            what = (
                f"unknown quantity {quoted(name, 60)}" if name else "must begin with the name of a quantity"
            )
            message = f"limit {quoted(text)}: {what}."
            raise CranktopoError(message, hint=nearest_quantity(name), code=ExitCode.USAGE)
        found[name] = (*found.get(name, ()), rest.strip())
    return {name: rest[0] if len(rest) == 1 else rest for name, rest in found.items()}


def _wrong_use(error: CranktopoError) -> CranktopoError:
    return CranktopoError(error.message, hint=error.hint, code=ExitCode.USAGE)
