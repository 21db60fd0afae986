"""The shaft with its mass beside the one without it: what webs and bearings carry, and what judges them."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from cranktopo.bodies.memory import check_element_size
from cranktopo.design.halves import default_element_size_mm
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import engine_of
from cranktopo.engine.bearings import required_bearing_spring_N_per_mm
from cranktopo.tasks.dynamics.moving_throw import MovingThrow
from cranktopo.tasks.dynamics.result import ShaftDynamics
from cranktopo.tasks.dynamics.stage import DynamicShaft, dynamic_shaft
from cranktopo.tasks.dynamics.stress import moving_stress
from cranktopo.tasks.shaft.assembly import ShaftBearings
from cranktopo.tasks.shaft.loaded_throw import ThrowBody, throw_body
from cranktopo.tasks.shaft.result import ShaftEvaluation
from cranktopo.tasks.shaft.stage import evaluate_shaft, throw_targets
from cranktopo.tasks.shaft_safety.judged import JudgedShaft, judged_by_stresses, stresses_of_throws
from cranktopo.tasks.throw_fatigue.shaft_stress import ShaftStress
from cranktopo.tasks.throw_fea.evaluation import mesh_target
from cranktopo.tasks.throw_fea.targets import Target


@dataclass(frozen=True)
class ShaftInMotion:
    """A judged shaft without its mass, and with it.

    Attributes:
        moving: judges the shaft with its mass.
    """

    evaluation: ShaftEvaluation
    judged: JudgedShaft
    dynamics: ShaftDynamics
    moving: JudgedShaft


def shaft_in_motion(
    target: Target, bearings: ShaftBearings, element_size_mm: float | None, speeds_rpm: Sequence[float]
) -> tuple[ShaftEvaluation, ShaftDynamics]:
    """Return a shaft without its mass, and its vibration.

    Raises:
        CranktopoError: as of `evaluate_shaft` and `dynamic_shaft`.
    """
    size = element_size_mm or default_element_size_mm(target.scene)
    check_element_size(target.scene, size)
    throws = dict.fromkeys(throw_targets(target))
    bodies = {one.name: throw_body(mesh_target(one, size), one.scene) for one in throws}
    shaft = _with_mass(target, bearings, bodies)
    speeds, resonances, added = shaft.with_resonances(speeds_rpm or _own_speed(target.scene))
    found = evaluate_shaft(target, bearings, size, speeds_rpm=speeds, bodies=bodies, add_worst_speed=True)
    return found, shaft.result(found.on_bearings, resonances, added)


def judged_in_motion(
    target: Target, bearings: ShaftBearings, method: str, speeds_rpm: Sequence[float], fillet_fraction: float
) -> ShaftInMotion:
    """Return a shaft with and without its mass, and what judges the webs of both.

    Raises:
        CranktopoError: as of `judged_shaft` and `dynamic_shaft`.
    """
    stresses = stresses_of_throws(target, bearings, method, fillet_fraction)
    begin = time.perf_counter()
    shaft = _with_mass(target, bearings, {name: stress.body for name, stress in stresses.items()})
    fields_s = time.perf_counter() - begin
    speeds, resonances, added = shaft.with_resonances(speeds_rpm or _own_speed(target.scene))
    found, judged = judged_by_stresses(target, bearings, method, stresses, speeds, add_worst_speed=True)
    dynamics = shaft.result(found.on_bearings, resonances, added)
    moving = _stresses(target, shaft.moving.throws, stresses, fillet_fraction, fields_s)
    return ShaftInMotion(found, judged, dynamics, replace(judged, throws=moving, moving=shaft))


def _own_speed(scene: Scene) -> tuple[float]:
    return (engine_of(scene).speed_rpm,)


def _with_mass(target: Target, bearings: ShaftBearings, bodies: Mapping[str, ThrowBody]) -> DynamicShaft:
    scene = target.scene
    spring = required_bearing_spring_N_per_mm(scene) if bearings == "spring" else None
    return dynamic_shaft(throw_targets(target), bodies, scene, bearings, spring)


def _stresses(
    target: Target,
    moving: Sequence[MovingThrow],
    stresses: Mapping[str, ShaftStress],
    fillet_fraction: float,
    fields_s: float,
) -> list[ShaftStress]:
    """Return the stresses of each throw with mass; the first has the time of all fields."""
    found: dict[str, ShaftStress] = {}
    for one, throw in zip(throw_targets(target), moving, strict=True):
        if one.name not in found:
            stress = moving_stress(stresses[one.name], throw, fillet_fraction)
            _, _, taken = stress.seconds
            found[one.name] = replace(stress, seconds=(0.0, 0.0 if found else fields_s, taken))
    return [found[one.name] for one in throw_targets(target)]
