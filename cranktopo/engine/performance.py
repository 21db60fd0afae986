"""Mean pressure, power and piston motion of a cycle, its pressure in words, signs of one that cannot be."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.notes import warn
from cranktopo.base.units import MM_PER_M, NMM_PER_NM, W_PER_KW, angular_speed_rad_s
from cranktopo.design.engine import Engine, Gas
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import Cycle, analyse
from cranktopo.engine.gas import higher_elsewhere, mapped_curves
from cranktopo.engine.kinematics import exact_motion

LATEST_PEAK_DEG = 30.0
"""Latest crank angle of the largest pressure after firing top dead centre; the earliest is 0."""
MOST_OF_CHARGE = 20.0
"""Largest mean pressure over that before compression: a charge with all fuel it can burn gives 12 to 16."""
LEAST_CHARGE_MPA = 0.02
"""Pressure before compression below that of any engine: a throttled one at idle has about 0.03."""
HIGHEST_MEAN_MPA = 3.5
"""Indicated mean pressure above those of engines in series: the highest charged ones have 3 to 3.4."""
EXPONENTS = 1.2, 1.45
"""Range of the polytropic exponent of compression."""
_TURN_DEG = 360.0
_COMPRESSION_DEG = -80.0, -40.0
"""Crank angles between which it is taken: inlet closed, nothing burns yet."""


@dataclass(frozen=True)
class PistonMotion:
    """Motion of the piston from top dead centre at a speed."""

    displacement_mm: Array
    speed_m_per_s: Array
    acceleration_m_per_s2: Array


def piston_motion(engine: Engine, radius_mm: float, angle_deg: Array) -> PistonMotion:
    """Return the piston's path, speed and acceleration at crank angles, positive away from the head."""
    motion = exact_motion(np.radians(angle_deg), radius_mm, engine.rod_length_mm)
    w, radius_m = angular_speed_rad_s(engine.speed_rpm), radius_mm / MM_PER_M
    return PistonMotion(
        motion.displacement_mm,
        motion.velocity_ratio * radius_m * w,
        motion.acceleration_ratio * radius_m * w**2,
    )


def mean_pressure_MPa(work_J: float, engine: Engine, radius_mm: float) -> float:
    """Return the work of a cycle over the swept volume."""
    return work_J * NMM_PER_NM / (math.pi / 4 * engine.bore_mm**2 * 2 * radius_mm)


def power_kW(work_J: float, engine: Engine) -> float:
    """Return the power of all cylinders at the engine's speed from their mean work in a cycle."""
    turns = angular_speed_rad_s(engine.speed_rpm) / (2 * math.pi)
    return work_J * engine.cylinders * turns * 360.0 / engine.cycle_deg / W_PER_KW


def pressure_words(scene: Scene, speeds_rpm: Iterable[float]) -> str:
    """Return what pressure acts at some speeds: one for all, or those of a map with their sources.

    Empty without gas, and where one pressure acts at the engine's own speed alone.
    """
    engine, speeds = scene.engine, tuple(speeds_rpm)
    if engine is None or engine.gas is None or not speeds:
        return ""
    if not engine.gas.map:
        if all(rpm == engine.speed_rpm for rpm in speeds):
            return ""
        return (
            f"The pressure is that of {engine.speed_rpm:.0f} rpm at every speed: with less load it is lower; "
            "[[engine.gas.map]] takes the pressure over speed."
        )
    mapped = mapped_curves(scene)
    entries = "; ".join(f"{rpm:g} rpm: {curve.source}" for rpm, curve in mapped)
    first, last = mapped[0][0], mapped[-1][0]
    inside = all(first <= rpm <= last for rpm in speeds)
    beyond = "" if inside else ", beyond its ends that of the nearest entry"
    between = ", in proportion between its entries" if len(mapped) > 1 else ""
    return f"The pressure is that of the map over speed{between}{beyond}: {entries}."


def note_pressure(name: str, scene: Scene, *, every_speed: bool = False) -> None:
    """Tell what is to be known of the pressure of a design before a result by its loads is believed."""
    for line in pressure_warnings(scene, every_speed=every_speed):
        warn(f"{name}: {line}")


def pressure_warnings(scene: Scene, *, every_speed: bool = False) -> tuple[str, ...]:
    """Return what is to be known of a scene's cylinder pressure before its loads are believed.

    Args:
        every_speed: the loads are those over the range of speeds, each with the pressure of its speed.
    """
    cycle = analyse(scene).cycle if scene.engine else None
    if cycle is None or scene.engine is None:
        return ()
    radius = scene.throw.radius_mm
    elsewhere = "" if every_speed else higher_elsewhere(scene)
    others = _unusual_mean(cycle, scene.engine, radius), elsewhere
    found = *implausible(cycle, scene.engine, radius), *(line for line in others if line)
    return found or _unchecked_angles(scene.engine.gas)


def _unusual_mean(cycle: Cycle, engine: Engine, radius_mm: float) -> str:
    mean = mean_pressure_MPa(cycle.indicated_work_J, engine, radius_mm)
    if mean <= HIGHEST_MEAN_MPA or _mean_too_high(cycle, engine, radius_mm):
        return ""
    return (
        f"the indicated mean pressure of {mean:.3g} MPa is more than engines in series have "
        f"({HIGHEST_MEAN_MPA:g} MPa): look at power, bore, stroke, speed and number of cylinders"
    )


def _unchecked_angles(gas: Gas | None) -> tuple[str, ...]:
    if gas is None or gas.indicator_csv is None or "compression_ratio" in gas.model_fields_set:
        return ()
    return (
        "the angles of the trace are not checked, and some degrees late or early change torque and power "
        "much: with engine.gas.compression_ratio they are compared with the compression",
    )


def implausible(cycle: Cycle, engine: Engine, radius_mm: float) -> tuple[str, ...]:
    """Return what no engine's pressure does, one line each: angle of the peak, charge, mean, exponent."""
    rules = (_peak_misplaced, _charge_too_low, _mean_too_high, _wrong_exponent)
    return tuple(line for rule in rules if (line := rule(cycle, engine, radius_mm)))


def _peak_after_firing_deg(cycle: Cycle, engine: Engine) -> float:
    """Return the crank angle of the largest pressure after firing top dead centre; negative before it.

    Opposed pistons have it where their volume is least.
    """
    curve = cycle.pressure
    angle = float(curve.angle_deg[int(curve.pressure_MPa.argmax())]) - curve.least_volume_deg
    angle = round(angle % engine.cycle_deg, 9)
    return angle if angle <= engine.cycle_deg / 2 else angle - engine.cycle_deg


def _a_turn_off(after_deg: float, engine: Engine) -> bool:
    """Tell whether a peak would be where an engine has it if the angles were moved by one turn."""
    return engine.cycle_deg > _TURN_DEG and 0 <= after_deg % _TURN_DEG <= LATEST_PEAK_DEG < abs(after_deg)


def _peak_misplaced(cycle: Cycle, engine: Engine, radius_mm: float) -> str:
    after = _peak_after_firing_deg(cycle, engine)
    if 0 <= after <= LATEST_PEAK_DEG:
        return ""
    firing_deg = engine.gas.firing_deg if engine.gas else 0.0
    found = (
        f"the pressure is largest {abs(after):g} deg {'after' if after > 0 else 'before'} firing top dead "
        f"centre, which is {firing_deg:g} deg; an engine that fires has its peak 0 to {LATEST_PEAK_DEG:g} "
        "deg after it"
    )
    return found + _firing_elsewhere(engine.gas, _a_turn_off(after, engine))


def _firing_elsewhere(gas: Gas | None, a_turn_off: bool) -> str:
    """Tell the key that says where a trace has firing top dead centre, and its value where that is clear."""
    if gas is None or not gas.measured:
        return ""
    if a_turn_off:
        value = (gas.firing_deg + _TURN_DEG) % (2 * _TURN_DEG)
        return f": the trace counts from gas exchange, write engine.gas.firing_deg = {value:g}"
    return ": engine.gas.firing_deg says where the trace has firing top dead centre"


def _charge_too_low(cycle: Cycle, engine: Engine, radius_mm: float) -> str:
    charge = _pressure_at(cycle, -180.0)
    if not _measured(engine) or charge >= LEAST_CHARGE_MPA:
        return ""
    found = (
        f"the trace has {charge:.3g} MPa before compression, less than any engine ({LEAST_CHARGE_MPA:g} MPa)"
    )
    exponent = _exponent(cycle, engine)
    if exponent is not None and EXPONENTS[0] <= exponent <= EXPONENTS[1]:
        return (
            f"{found}, and rises in compression as gas does, with the exponent {exponent:.2f}: all its "
            "pressures are too low by a factor; check the unit in the header"
        )
    return (
        f"{found}: its pressures are gauge pressures or offset; add the ambient pressure, or what is "
        "missing, to all of them, so that they are absolute"
    )


def _measured(engine: Engine) -> bool:
    return engine.gas is not None and engine.gas.measured


def _mean_too_high(cycle: Cycle, engine: Engine, radius_mm: float) -> str:
    mean, charge = mean_pressure_MPa(cycle.indicated_work_J, engine, radius_mm), _pressure_at(cycle, -180.0)
    if mean <= 0:
        return (
            f"the gas does no work (mean pressure {mean:.3g} MPa): angles count from firing top dead centre"
        )
    if mean <= MOST_OF_CHARGE * charge or _charge_too_low(cycle, engine, radius_mm):
        return ""
    cause = (
        "are the trace's pressures gauge pressures, or offset? They must be absolute"
        if _measured(engine)
        else "give engine.gas.intake_pressure_MPa of a charged engine"
    )
    return (
        f"the indicated mean pressure of {mean:.3g} MPa is {mean / charge:.3g} times the {charge:.3g} MPa "
        f"before compression; no engine has more than {MOST_OF_CHARGE:g} times: {cause}"
    )


def _wrong_exponent(cycle: Cycle, engine: Engine, radius_mm: float) -> str:
    """A trace at wrong angles, or offset, does not rise with the volume; only with a compression ratio given.

    Nothing is told beside a charge too low, which raises the exponent by itself.
    """
    exponent = _exponent(cycle, engine)
    if exponent is None or EXPONENTS[0] <= exponent <= EXPONENTS[1]:
        return ""
    if _a_turn_off(_peak_after_firing_deg(cycle, engine), engine) or _charge_too_low(
        cycle, engine, radius_mm
    ):
        return ""
    side, offset = ("late", "high") if exponent < EXPONENTS[0] else ("early", "low")
    return (
        f"the pressure rises in compression with the exponent {exponent:.2f}, where gas has {EXPONENTS[0]:g} "
        f"to {EXPONENTS[1]:g}: the trace is {side} by some degrees (engine.gas.firing_deg), its pressures "
        f"are too {offset} (they must be absolute), or engine.gas.compression_ratio is another"
    )


def _exponent(cycle: Cycle, engine: Engine) -> float | None:
    """Exponent of the volume in the compression of a trace; None without a trace or its compression ratio."""
    gas = engine.gas
    if gas is None or gas.indicator_csv is None or "compression_ratio" not in gas.model_fields_set:
        return None
    volume = cycle.room.volume(np.array(_COMPRESSION_DEG), gas.compression_ratio)
    early, late = (_pressure_at(cycle, angle) for angle in _COMPRESSION_DEG)
    return math.log(late / early) / math.log(volume[0] / volume[1]) if early > 0 else None


def _pressure_at(cycle: Cycle, angle_deg: float) -> float:
    """Return the pressure at an angle after the least volume of firing, MPa."""
    curve = cycle.pressure
    at = angle_deg + curve.least_volume_deg
    return float(np.interp(at, curve.angle_deg, curve.pressure_MPa, period=curve.cycle_deg))
