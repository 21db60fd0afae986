"""Meshes and condensed throws of shafts, each made once for all tests of a process that do not ask how."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from cranktopo.design.schema import Scene
from cranktopo.tasks.modes.reduced_throw import reduced_throw
from cranktopo.tasks.shaft import condensed_throw
from cranktopo.tasks.shaft.loaded_throw import throw_body
from cranktopo.tasks.throw_fea.evaluation import mesh_target
from cranktopo.tasks.throw_fea.targets import Target

_NO_BODY = {"name", "engine", "shaft", "supports", "bearings"}
"""What no mesh depends on, for throws whose two rods share a pin."""
_kept: dict[Hashable, Any] = {}


def _body_of(scene: Scene) -> str:
    return scene.model_dump_json(exclude=_NO_BODY)


def _loaded(scene: Scene) -> Hashable:
    """What a throw with its unit loads depends on: of its shaft only whether one takes the torque off."""
    takeoff = scene.shaft is not None and scene.shaft.has_takeoff
    return takeoff, scene.model_dump_json(exclude={"shaft", "supports", "bearings"})


def _once(function: Callable[..., Any], key_of: Callable[..., Hashable]) -> Callable[..., Any]:
    """Return the function; what it found for a key is found again, and what it was found of is kept."""

    def found(*given: Any, **named: Any) -> Any:
        key = function.__name__, key_of(*given, **named)
        if key not in _kept:
            _kept[key] = function(*given, **named), given
        return _kept[key][0]

    return found


def _of_target(target: Target, size_mm: float, graded: bool = True) -> Hashable:
    return target.file, _body_of(target.scene), size_mm, graded


@contextmanager
def throws_once() -> Iterator[None]:
    """Inside, shafts and modes have meshes and condensed throws from before, where they are of the same."""
    mesh = _once(mesh_target, _of_target)
    body = _once(throw_body, lambda meshed, scene: (id(meshed), _loaded(scene)))
    condensed = _once(condensed_throw.of_body, lambda body, scene: (id(body), _loaded(scene)))
    reduced = _once(
        reduced_throw, lambda body, scene, shapes, steps, kg: (id(body), _loaded(scene), steps, kg)
    )
    with pytest.MonkeyPatch.context() as patch:
        for room in ("shaft.stage", "modes.stage", "shaft_safety.in_motion"):
            patch.setattr(f"cranktopo.tasks.{room}.mesh_target", mesh)
        for room in ("shaft.condensed_throw", "modes.stage", "shaft_safety.in_motion"):
            patch.setattr(f"cranktopo.tasks.{room}.throw_body", body)
        for room in ("shaft.condensed_throw", "shaft.stage"):
            patch.setattr(f"cranktopo.tasks.{room}.of_body", condensed)
        patch.setattr("cranktopo.tasks.modes.stage.reduced_throw", reduced)
        yield
