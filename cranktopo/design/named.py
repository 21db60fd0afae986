"""Designs as a script has them: a scene, the path of a file, or a name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from cranktopo.design.goal import scene_goal as goals
from cranktopo.design.goal.limit import Goal
from cranktopo.design.loading import load_scene, scene_from_dict, with_value
from cranktopo.design.schema import Scene

DesignLike = Scene | str | Path
"""A scene, the path of a TOML file, or the name of a built-in design or of a run of `shape`."""


def as_scene(design: DesignLike, *, whole: bool = True) -> Scene:
    """Return the scene of a design; without `whole` a file with two different halves is refused."""
    return design if isinstance(design, Scene) else load_scene(str(design), whole=whole)


def with_values(scene: DesignLike, values: Mapping[str, object]) -> Scene:
    """Return the scene of a design with other values, by key path such as `web.width_mm`.

    They are checked as those of a file.

    Raises:
        CranktopoError: unknown key, value outside its range, or inconsistent geometry.
    """
    data = as_scene(scene).model_dump(mode="json", exclude_none=True)
    for key, value in values.items():
        data = with_value(data, key, value)
    return scene_from_dict(data, str(data.get("name", "scene")), whole=True)


def wanted(scene: DesignLike) -> Goal | None:
    """Return the goal of a design, if any, with its limits: those given, then those that the goal brings.

    By default nothing gets worse: mass stays at most, both stiffnesses and the fatigue safety at least 100 %
    of the original, but for the goal's own quantity. With a counterweight the unbalance stays at most as it
    is. A given limit replaces the default one of its quantity.
    """
    return goals.goal_of(as_scene(scene))


def with_goal(
    scene: DesignLike, *, minimise: str | None = None, maximise: str | None = None, limits: Sequence[str] = ()
) -> Scene:
    """Return the scene of a design with another goal or with other limits.

    Args:
        minimise, maximise: a new goal in place of the design's, whose limits go with it.
        limits: such as `torsion >= 100 %` or `bending none`; two of one quantity are a range.

    Raises:
        CranktopoError: limits without a goal, or a goal or limit that makes no sense.
    """
    return goals.with_goal(as_scene(scene), minimise=minimise, maximise=maximise, limits=limits)
