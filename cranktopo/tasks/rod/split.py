"""The split of the big end: the rod's way through the cylinder, and an oblique joint over the cycle."""

from __future__ import annotations

import math

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.checks.rod import rod_of
from cranktopo.design.rod_split import big_end_range_mm
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import engine_of
from cranktopo.engine.rod_split import SplitForces, split_forces
from cranktopo.tasks.bolts.result import JointCheck
from cranktopo.tasks.rod.result import ObliqueSplit, Passage, SplitForce

_BOLTS = 2


def passage(scene: Scene) -> Passage:
    """Return the size of the big end without its cap beside the bore of the cylinder."""
    rod, bore = rod_of(scene)[0], engine_of(scene).bore_mm
    low, high = big_end_range_mm(rod)
    corners = math.hypot(high - low, rod.big_end_width_mm)
    return Passage(width_mm=high - low, over_corners_mm=corners, bore_mm=bore, passes=corners < bore)


def oblique_split(scene: Scene, bolt: JointCheck | None) -> ObliqueSplit | None:
    """Return the joint of an oblique split at its worst angles of the cycle; None where it is square.

    Args:
        bolt: the check of one of its bolts, where it has any.
    """
    rod = rod_of(scene)[0]
    if not rod.split_angle_deg:
        return None
    states = split_forces(scene)
    sliding, safety, left = None, None, None
    if bolt is not None:
        held = [_friction_N(one, bolt, rod.split_friction) for one in states]
        missing = [np.abs(one.shear_N) - hold for one, hold in zip(states, held, strict=True)]
        sliding, left = _worst(states, missing), max(0.0, *(float(one.max()) for one in missing))
        safety = min(
            float((hold / np.maximum(np.abs(one.shear_N), 1e-9)).min())
            for one, hold in zip(states, held, strict=True)
        )
    return ObliqueSplit(
        angle_deg=rod.split_angle_deg,
        parting=_worst(states, [one.parting_N for one in states]),
        shear=_worst(states, [np.abs(one.shear_N) for one in states]),
        friction=rod.split_friction,
        sliding=sliding,
        sliding_safety=safety,
        left_for_shape_N=left,
    )


def cap_force_N(scene: Scene) -> float:
    """Return the largest force between rod and cap of an oblique split, in any direction."""
    return max(float(np.hypot(one.parting_N, one.shear_N).max()) for one in split_forces(scene))


def split_stress_N(scene: Scene) -> float:
    """Return the largest force on the section at the split whose stress is that of von Mises, tension."""
    squares = (one.parting_N**2 + 3 * one.shear_N**2 for one in split_forces(scene))
    return math.sqrt(max(float(square.max()) for square in squares))


def _friction_N(forces: SplitForces, bolt: JointCheck, friction: float) -> Array:
    """Return the force that friction holds at each angle with the smallest preload of both bolts."""
    joint = bolt.vdi_2230
    least = joint.least_preload_N
    clamped = _BOLTS * least - (1 - joint.load_factor) * np.maximum(forces.parting_N, 0.0)
    return np.asarray(friction * np.maximum(clamped, 0.0))


def _worst(states: list[SplitForces], values: list[Array]) -> SplitForce:
    """The state where a value is largest."""
    one, value = max(zip(states, values, strict=True), key=lambda pair: float(pair[1].max()))
    at = int(value.argmax())
    return SplitForce(
        parting_N=float(one.parting_N[at]),
        shear_N=float(abs(one.shear_N[at])),
        speed_rpm=one.speed_rpm,
        crank_angle_deg=float(one.angle_deg[at]),
    )
