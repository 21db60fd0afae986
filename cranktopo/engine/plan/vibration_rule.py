"""Rule of torsional vibration: what it does to the torque, by the disks of the shaft in closed form."""

from __future__ import annotations

from dataclasses import dataclass

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
        percent: change against that of a shaft that does not twist, over the same range.
    """

    frequency_Hz: float
    order: float
    speed_rpm: float
    percent: float


def torsional_vibration(context: PlanningContext) -> Estimate:
    """Torque amplitude of the vibrating shaft against that of a stiff one, every mode and order in it."""
    absent = _absent(context.scene)
    if absent:
        return Estimate(None, "", "nothing", absent=absent, impossible=absent)
    found = _amplification(context.scene)
    shaft = context.scene.shaft
    has_stiffness = shaft is not None and shaft.gives_stiffness
    source = "" if has_stiffness else " (throws in closed form)"
    because = (
        f"first natural frequency {frequency_text(found.frequency_Hz)}{source}, torque amplitude "
        f"{signed_percent(found.percent, 3)}, worst at {found.speed_rpm:.0f} rpm by order {found.order:g}"
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
    """Solve the shaft with its mean inertia: all orders, over the range of speeds."""
    shaft, harmonics, limits = estimated_chain(scene), torque_harmonics(scene), speed_range_rpm(scene)
    assert harmonics is not None
    modes = shaft.chain.damped_modes()
    orders = orders_to_solve(shaft, modes, harmonics, limits)
    speeds = speeds_to_solve(limits, critical_speeds(shaft, modes, harmonics, limits, orders), _SPEEDS)
    found = vibration(shaft, harmonics, speeds, orders)
    stiff = max(_stiff_amplitude_Nm(harmonics, float(speed)) for speed in speeds)
    return _Amplification(
        float(modes[0].frequency_Hz),
        found.worst.order,
        float(found.speeds_rpm[found.worst.speed_index]),
        100 * (found.worst_Nm / stiff - 1),
    )


def _stiff_amplitude_Nm(harmonics: TorqueHarmonics, speed_rpm: float) -> float:
    """Return the largest torque amplitude behind a throw of a shaft that does not twist."""
    behind = np.cumsum(harmonics.of_throws_Nm(speed_rpm), axis=1).T
    return float(np.ptp(curve_of(behind, 2 * behind.shape[1]), axis=1).max()) / 2
