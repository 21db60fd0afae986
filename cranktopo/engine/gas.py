"""Gas force on the piston over the working cycle: measured or fitted, also from a map over speed."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.design.engine import Engine, Gas, GasAtSpeed
from cranktopo.design.schema import Scene
from cranktopo.engine.chamber import Chamber, chamber_of
from cranktopo.engine.combustion import combustion_pressure_MPa, fit_combustion
from cranktopo.engine.indicator import read_indicator

STEP_DEG = 0.25
_SAME_PEAK = 1e-3
FileState = tuple[str, int, int]
"""Path, time of the last change and size: what is remembered of a file holds as long as it stays."""


@dataclass(frozen=True, eq=False)
class PressureCurve:
    """Absolute cylinder pressure over one working cycle from firing top dead centre, its end not included.

    One curve equals itself alone, so that what follows from it is computed once.

    Opposed pistons have the least volume, from which the gas counts its angles, at `least_volume_deg`.
    """

    angle_deg: Array
    pressure_MPa: Array
    cycle_deg: float
    source: str
    least_volume_deg: float = 0.0


def file_state(path: str | Path) -> FileState:
    """Return the state of a file; that of one that is not there is its path alone."""
    try:
        found = Path(path).stat()
    except (OSError, ValueError):  # not there, or no name that a file can have
        return str(path), 0, 0
    return str(path), found.st_mtime_ns, found.st_size


def trace_states(scene: Scene) -> tuple[FileState, ...]:
    """Return the states of the pressure traces of a scene: with another content it has other loads."""
    gas = scene.engine.gas if scene.engine else None
    traces = (gas.indicator_csv, *(at.file for at in gas.map)) if gas else ()
    return tuple(file_state(name) for name in traces if name is not None)


def pressure_curve(scene: Scene) -> PressureCurve | None:
    """Return the cylinder pressure of a scene at its speed; None when the scene has no `[engine.gas]`.

    The same curve serves every speed, unless the scene has a map over speed. Raises CranktopoError for an
    indicator file that cannot be used and a peak that no combustion reaches.
    """
    engine = scene.engine
    if engine is None or engine.gas is None:
        return None
    if not engine.gas.map:
        return _curve_of(scene, engine, engine.gas)
    return between(mapped_curves(scene), engine.speed_rpm)


def between(curves: tuple[tuple[float, PressureCurve], ...], speed_rpm: float) -> PressureCurve:
    """Return the pressure at a speed from curves at others, the slowest first; beyond them the nearest."""
    (low, below), (high, above) = _around(curves, speed_rpm)
    part = (speed_rpm - low) / (high - low) if high > low else 0.0
    part = min(max(part, 0.0), 1.0)
    pressure = below.pressure_MPa + part * (above.pressure_MPa - below.pressure_MPa)
    return replace(below, pressure_MPa=pressure, source=_place_in_map(curves, speed_rpm))


def _place_in_map(curves: tuple[tuple[float, PressureCurve], ...], speed_rpm: float) -> str:
    """Return which entries of a map the pressure at a speed is of, and their sources."""
    (low, below), (high, above) = _around(curves, speed_rpm)
    if low != high and speed_rpm != low:
        return (
            f"map over speed at {speed_rpm:g} rpm, in proportion between {low:g} rpm ({below.source}) and "
            f"{high:g} rpm ({above.source})"
        )
    at = "" if speed_rpm == low else f" at {speed_rpm:g} rpm, beyond its ends: that of the nearest"
    return f"map over speed{at or ','} entry of {low:g} rpm: {below.source}"


def mapped_curves(scene: Scene) -> tuple[tuple[float, PressureCurve], ...]:
    """Return speed and pressure of each entry of a scene's map over speed, the slowest first."""
    engine = scene.engine
    if engine is None or engine.gas is None:
        return ()
    return tuple((at.rpm, _curve_in_map(scene, engine, number)) for number, at in enumerate(engine.gas.map))


_KEYS_OF_ENTRY = {
    "peak_pressure_MPa": "peak_pressure_MPa",
    "peak_angle_deg": "peak_angle_deg",
    "indicator_csv": "file",
}
"""Keys of an entry of a map by those of the gas that it stands for."""


def _curve_in_map(scene: Scene, engine: Engine, number: int) -> PressureCurve:
    """Return the pressure of an entry of the map; an error names the entry, not its gas."""
    assert engine.gas is not None
    at = engine.gas.map[number]
    try:
        return _curve_of(scene, engine, gas_at(engine.gas, at))
    except CranktopoError as error:
        message, hint = error.message, error.hint
        for key, own in _KEYS_OF_ENTRY.items():
            message = message.replace(f"engine.gas.{key}", f"engine.gas.map[{number}].{own}")
        if at.file is None:
            hint = (
                "Compression, intake pressure and burn duration are those of all entries: give this one "
                "its own trace by `file`, or another peak."
            )
        message = f"{message} It is the entry of {at.rpm:g} rpm."
        raise CranktopoError(message, hint=hint, code=error.code) from None


def higher_elsewhere(scene: Scene) -> str:
    """Tell where a map over speed has a higher peak than at the scene's speed; empty where it has none."""
    curve, mapped = pressure_curve(scene), mapped_curves(scene)
    if curve is None or scene.engine is None or not mapped:
        return ""
    own = float(curve.pressure_MPa.max())
    rpm, peak = max(((rpm, float(at.pressure_MPa.max())) for rpm, at in mapped), key=lambda pair: pair[1])
    if peak <= own * (1 + _SAME_PEAK):
        return ""
    at = f"pressure at {scene.engine.speed_rpm:g} rpm: peak {own:.4g} MPa"
    return f"{at}; the map over speed has {peak:.4g} MPa at {rpm:g} rpm"


def gas_at(gas: Gas, at: GasAtSpeed) -> Gas:
    """Return the gas of one entry of a map over speed."""
    own = {"indicator_csv": at.file, "peak_pressure_MPa": at.peak_pressure_MPa}
    return gas.model_copy(update={**own, "peak_angle_deg": at.peak_angle_deg, "map": ()})


def _around(
    curves: tuple[tuple[float, PressureCurve], ...], speed_rpm: float
) -> tuple[tuple[float, PressureCurve], tuple[float, PressureCurve]]:
    """Return the curves on both sides of a speed, the nearest one twice beyond the ends."""
    after = sum(rpm <= speed_rpm for rpm, _ in curves)
    return curves[max(after - 1, 0)], curves[min(after, len(curves) - 1)]


def _curve_of(scene: Scene, engine: Engine, gas: Gas) -> PressureCurve:
    state = None if gas.indicator_csv is None else file_state(gas.indicator_csv)
    return _curve(gas, chamber_of(scene), engine.cycle_deg, state)


@lru_cache(maxsize=64)
def _curve(gas: Gas, room: Chamber, cycle_deg: float, _state: FileState | None) -> PressureCurve:
    """Compute the curve of what it depends on, the state of an indicator file among it."""
    angle = np.arange(0.0, cycle_deg, STEP_DEG)
    after = after_least_deg(angle, room, cycle_deg)
    if gas.indicator_csv is not None:
        pressure = _measured(gas, gas.indicator_csv, cycle_deg, after)
        firing = f", firing at its {gas.firing_deg:g} deg" if gas.firing_deg else ""
        source = f"indicator diagram {gas.indicator_csv}{firing}"
    else:
        model = fit_combustion(gas, room, cycle_deg)
        pressure = at_rising(lambda rising: combustion_pressure_MPa(model, rising), after)
        source = (
            f"Wiebe combustion model fitted to {gas.peak_pressure_MPa:g} MPa at "
            f"{gas.peak_angle_deg:g} deg: burning starts at {model.start_deg:.1f} deg, compression ratio "
            f"{gas.compression_ratio:g}"
        )
    if len(room.pistons) > 1:
        source += f"; opposed pistons, least volume at {room.dead_centre_deg:.4g} deg of this crank"
    for shared in (angle, pressure):
        shared.setflags(write=False)
    return PressureCurve(angle, pressure, cycle_deg, source, room.dead_centre_deg)


def after_least_deg(angle_deg: Array, room: Chamber, cycle_deg: float) -> Array:
    """Return crank angles as the gas counts them, after the least volume of firing, within a cycle."""
    return np.asarray(np.mod(angle_deg - room.dead_centre_deg, cycle_deg))


def at_rising(function: Callable[[Array], Array], angle_deg: Array) -> Array:
    """Return the values of a function that takes rising angles at angles in another order."""
    order = np.argsort(angle_deg, kind="stable")
    found = np.empty_like(angle_deg)
    found[order] = function(angle_deg[order])
    return found


def _measured(gas: Gas, path: str, cycle_deg: float, angle: Array) -> Array:
    """Join the measured points by a periodic monotone cubic (PCHIP: no overshoot between points)."""
    from scipy.interpolate import PchipInterpolator

    measured, pressure = read_indicator(path, cycle_deg, gas.ambient_pressure_MPa, gas.firing_deg)
    turns = cycle_deg * np.array([[-1.0], [0.0], [1.0]])
    curve = PchipInterpolator((measured + turns).ravel(), np.tile(pressure, 3))
    return np.asarray(curve(angle))


def gas_force_N(pressure_MPa: Array, engine: Engine) -> Array:
    """Return the force of the gas on the piston toward the crank axis, N."""
    if engine.gas is None:
        raise invalid("engine.gas", None, "must be given for a gas force")
    return (pressure_MPa - engine.gas.ambient_pressure_MPa) * math.pi / 4 * engine.bore_mm**2
