"""Rule of torsional vibration: what it does to the torque between load states."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cranktopo.base.units import frequency_text, signed_percent
from cranktopo.design.checks.engine import is_damped
from cranktopo.design.misfire import all_firing
from cranktopo.design.schema import Scene
from cranktopo.engine.forces import INERTIA_EFFECTS
from cranktopo.engine.histories import load_history
from cranktopo.engine.judged_speeds import rated_speeds, speeds_of_range
from cranktopo.engine.plan.context import PlanningContext
from cranktopo.engine.plan.effect import Estimate
from cranktopo.engine.vibration.shaft_chain import estimated_chain
from cranktopo.engine.vibration.vibrating_shaft import worst_orders_words, worst_speed_rpm

_OFF = frozenset(INERTIA_EFFECTS)
_ON = _OFF | {"torsional_vibration"}


@dataclass(frozen=True)
class _Amplification:
    """Torque of the load states with the vibration against that without it.

    Attributes:
        frequency_Hz: first natural frequency.
        orders: of which the torque is where the shaft swings most, in words.
        speed_rpm: where it swings most, of the speeds at which the engine runs.
        percent: change of the torque amplitude between the load states that strength is judged by.
        speeds_percent: the same of a shaft that does not twist, by judging the speeds of the range as well.
        twist_percent: change by the twist alone, both judged over the range.
    """

    frequency_Hz: float
    orders: str
    speed_rpm: float
    percent: float
    speeds_percent: float
    twist_percent: float


def torsional_vibration(context: PlanningContext) -> Estimate:
    """Torque amplitude of the load states with the vibration against that without it.

    These are the states of `fatigue`: of the vibrating shaft the extremes over the range of speeds, barred
    ones apart, of one that does not twist those of `rated_speeds`.
    """
    absent = _absent(context.scene)
    if absent:
        return Estimate(None, "", "nothing", absent=absent, impossible=absent)
    found = _amplification(context)
    shaft = context.scene.shaft
    has_stiffness = shaft is not None and shaft.gives_stiffness
    source = "" if has_stiffness else " (throws in closed form)"
    because = (
        f"first natural frequency {frequency_text(found.frequency_Hz)}{source}, torque amplitude of the load "
        f"states {signed_percent(found.percent, 3)} ({signed_percent(found.twist_percent, 3)} by the twist, "
        f"{signed_percent(found.speeds_percent, 3)} as torques of the whole range of speeds count with it), "
        f"worst at {found.speed_rpm:.0f} rpm, {found.orders}"
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


def _amplification(context: PlanningContext) -> _Amplification:
    """Find the load states with and without the vibration, and where it is worst."""
    scene = all_firing(context.scene)
    off, on = _stiff_Nm(rated_speeds(scene, _OFF)), replace(context, vibrating=True).amplitudes[1]
    over_the_range = _stiff_Nm(speeds_of_range(scene, _OFF), join=True)
    return _Amplification(
        estimated_chain(scene).chain.damped_modes()[0].frequency_Hz,
        worst_orders_words(scene, _ON),
        worst_speed_rpm(scene, _ON),
        100 * (on / off - 1),
        100 * (over_the_range / off - 1),
        100 * (on / over_the_range - 1),
    )


def _stiff_Nm(speeds: Sequence[Scene], *, join: bool = False) -> float:
    """Return the largest torque amplitude of a shaft that does not twist.

    Args:
        join: the largest torque of all speeds with the smallest of all, as those of a vibrating shaft are.
    """
    known = [load_history(at, "extremes", _OFF | {"torsion"}).torque_Nm for at in speeds]
    return float(np.ptp(known) if join else max(map(np.ptp, known))) / 2
