"""Rule of torsional vibration: what it does to the torque, by the disks of the shaft in closed form."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from cranktopo.base.units import frequency_text, signed_percent
from cranktopo.design.checks.engine import is_damped, speed_range_rpm
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.context import PlanningContext
from cranktopo.engine.plan.effect import Estimate
from cranktopo.engine.vibration.shaft_chain import estimated_chain
from cranktopo.engine.vibration.steady import critical_speeds, orders_to_solve, speeds_to_solve, vibration
from cranktopo.engine.vibration.torque_harmonics import TorqueHarmonics, curve_of, torque_harmonics

_SPEEDS = 60
"""Even steps over the range beside its critical speeds."""


@dataclass(frozen=True)
class _Amplification:
    """The largest torque amplitude ahead of or behind a throw over the range of speeds.

    Attributes:
        frequency_Hz: first natural frequency.
        order: the one with the largest share at that place.
        percent: change against a shaft that does not twist at the speeds at which that is judged.
        by_twist_percent: change against one over the same range.
        judged_rpm: speed of those with the larger amplitude.
    """

    frequency_Hz: float
    order: float
    speed_rpm: float
    percent: float
    by_twist_percent: float
    judged_rpm: float


def torsional_vibration(context: PlanningContext) -> Estimate:
    """Torque amplitude of the vibrating shaft over its speeds against what is judged of a stiff one.

    A stiff shaft is judged at the engine's speed and its overspeed alone, so that the estimate is what
    switching the effect on changes. Every mode and order is in it.
    """
    absent = _absent(context.scene)
    if absent:
        return Estimate(None, "", "nothing", absent=absent, impossible=absent)
    found = _amplification(context.scene)
    shaft = context.scene.shaft
    has_stiffness = shaft is not None and shaft.gives_stiffness
    source = "" if has_stiffness else " (throws in closed form)"
    because = (
        f"first natural frequency {frequency_text(found.frequency_Hz)}{source}, torque amplitude "
        f"{signed_percent(found.percent, 3)} against a stiff shaft's at {found.judged_rpm:.0f} rpm "
        f"({signed_percent(found.by_twist_percent, 3)} against its over all speeds), "
        f"worst at {found.speed_rpm:.0f} rpm by order {found.order:g}"
    )
    change = 100 * (1 / (1 + found.percent / 100) - 1)
    return Estimate(abs(found.percent), because, f"torque amplitude {signed_percent(change)}")


def _absent(scene: Scene) -> str:
    """Why nothing can be told of the vibration; empty when it can."""
    shaft, engine = scene.shaft, scene.engine
    if shaft is None:
        return "the scene has no [shaft]"
    if engine is None or engine.gas is None:
        return "the scene tells no torque over the cycle ([engine.gas])"
    if engine.max_torque_Nm is not None or engine.min_torque_Nm is not None:
        return "engine.max_torque_Nm or min_torque_Nm is taken as it is"
    if not shaft.has_takeoff:
        return "nothing is joined to the takeoff in [shaft]"
    if not is_damped(shaft):
        return "nothing damps the shaft, so that a resonance has no limit"
    return ""


def _amplification(scene: Scene) -> _Amplification:
    """Solve the shaft with its mean inertia: all orders, over the range of speeds but for barred ones."""
    shaft, harmonics, limits = estimated_chain(scene), torque_harmonics(scene), speed_range_rpm(scene)
    assert harmonics is not None
    modes = shaft.chain.damped_modes()
    orders = orders_to_solve(shaft, modes, harmonics, limits)
    speeds = speeds_to_solve(limits, critical_speeds(shaft, modes, harmonics, limits, orders), _SPEEDS)
    barred = (scene.shaft.barred_rpm if scene.shaft else None) or ()
    ends = np.clip([end for ends in barred for end in ends], *limits)
    found = replace(vibration(shaft, harmonics, np.union1d(speeds, ends), orders), barred_rpm=barred)
    assert scene.engine is not None
    judged = {rpm: _stiff_amplitude_Nm(harmonics, rpm) for rpm in scene.engine.own_speeds_rpm}
    largest = max(judged, key=lambda rpm: judged[rpm])
    running = found.speeds_rpm[found.running]
    stiff = max(_stiff_amplitude_Nm(harmonics, float(speed)) for speed in running)
    return _Amplification(
        frequency_Hz=float(modes[0].frequency_Hz),
        order=found.worst.order,
        speed_rpm=float(found.speeds_rpm[found.worst.speed_index]),
        percent=100 * (found.worst_Nm / judged[largest] - 1),
        by_twist_percent=100 * (found.worst_Nm / stiff - 1),
        judged_rpm=largest,
    )


def _stiff_amplitude_Nm(harmonics: TorqueHarmonics, speed_rpm: float) -> float:
    """Return the largest torque amplitude behind a throw of a shaft that does not twist."""
    behind = np.cumsum(harmonics.of_throws_Nm(speed_rpm), axis=1).T
    return float(np.ptp(curve_of(behind, 2 * behind.shape[1]), axis=1).max()) / 2
