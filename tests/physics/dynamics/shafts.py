"""Shafts with mass on a coarse mesh, and the same in one piece: a way that no condensation is in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import at_speed
from cranktopo.numerics.turning_body import TurningBody
from cranktopo.tasks.dynamics.moving_shaft import MovingShaft, moving_shaft
from cranktopo.tasks.dynamics.moving_throw import MovingThrow, moving_throw, pin_friction_Ns_per_mm
from cranktopo.tasks.shaft.cycle import CycleForces, cycle_forces
from cranktopo.tasks.shaft.loaded_throw import ThrowBody, throw_body

Array = NDArray[np.float64]
SIZE_MM = 24.0
LOSS = 0.02


def mikron(**shaft: Any) -> Scene:
    """The plain Mikron with parts on its shaft."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    return scene_from_dict({**data, "shaft": shaft} if shaft else data)


@cache
def body() -> ThrowBody:
    scene = mikron()
    return throw_body(mesh_throw(scene, SIZE_MM), scene)


@cache
def throw(loss_factor: float = LOSS, friction: float = 0.0) -> MovingThrow:
    return moving_throw(body(), mikron(), loss_factor, friction)


def shaft_of(scene: Scene, spring: float | None = None, loss_factor: float = LOSS) -> MovingShaft:
    one = throw(loss_factor, pin_friction_Ns_per_mm(scene, scene))
    return moving_shaft([one] * len(scene.shaft_angles_deg), scene, spring)


def without_mass(shaft: MovingShaft) -> MovingShaft:
    """The same shaft, of a material that weighs nothing, and nothing on it."""
    light: dict[int, MovingThrow] = {}
    for one in shaft.throws:
        light[id(one)] = replace(one, damped=replace(one.damped, body=_light(one.damped.body)))
    ends = [replace(end, body=_light(end.body)) for end in shaft.ends]
    return replace(shaft, throws=tuple(light[id(one)] for one in shaft.throws), ends=(ends[0], ends[1]))


def _light(body: TurningBody) -> TurningBody:
    none = np.zeros_like(body.mass)
    return TurningBody(body.stiffness, none, none, none, none)


def forces_at(scene: Scene, rpm: float) -> CycleForces:
    return cycle_forces(at_speed(scene, rpm))


def of_orders(throws: int, orders: Sequence[int], states: int, speed: float, seed: int = 1) -> CycleForces:
    """Forces of a few harmonics of a cycle of two turns, in no relation to each other."""
    rng = np.random.default_rng(seed)
    angle = 720.0 * np.arange(states) / states
    curves = np.zeros((4, throws, states))
    for order in orders:
        size = rng.normal(0.0, 1e4, (2, 4, throws, 1)) * np.array([1, 1, 9, 9])[:, None, None]
        phase = np.radians(order * angle / 2)
        curves += size[0] * np.cos(phase) + (size[1] * np.sin(phase) if order else 0.0)
    radial, tangential, radial_aside, tangential_aside = curves
    return CycleForces(angle, radial, tangential, radial_aside, tangential_aside, speed)
