"""Gas force on the piston over the working cycle: measured, or by Wiebe heat release between polytropes.

One zone of ideal gas (J. B. Heywood, Internal Combustion Engine Fundamentals, McGraw-Hill 1988, sections
9.2.2 and 14.4.2). With v the volume over the clearance volume, n the polytropic exponent of the expansion
and x the burnt fraction, the energy balance d(p v^n) = (n - 1) q v^(n-1) dx integrates to

    p v^n = p_s v_s^n + (n - 1) q Integral_s v^(n-1) dx,    x = 1 - exp(-6.908 (phi / phi_b)^(m+1)),

phi the angle since the start of burning s, phi_b the burn duration (99.9 %), m the Wiebe shape and q the
heat over the clearance volume. Before s the charge is compressed with its own exponent. Start s and heat q
follow from the peak pressure and its angle.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from pathlib import Path

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import invalid
from cranktopo.base.root import root
from cranktopo.design.engine import Engine, Gas, GasAtSpeed
from cranktopo.design.schema import Scene
from cranktopo.engine.chamber import Chamber, chamber_of
from cranktopo.engine.indicator import read_indicator

_WIEBE_EFFICIENCY = 6.908  # -ln(1 - 0.999)
_OVERLAP_DEG = 20.0  # width of the change from exhaust to intake pressure after gas-exchange dead centre


@dataclass(frozen=True)
class _Combustion:
    """A combustion model fitted to the peak.

    Attributes:
        cycle_deg: 720 (four-stroke) or 360 (two-stroke).
        start_deg: start of burning after the least volume of firing (negative: before it).
        heat_MPa: heat released per cycle over the clearance volume.
    """

    gas: Gas
    room: Chamber
    cycle_deg: float
    start_deg: float
    heat_MPa: float


def fit_combustion(gas: Gas, room: Chamber, cycle_deg: float) -> _Combustion:
    """Return start of burning and heat such that the pressure peaks where and as high as the scene says.

    At the peak p' = 0, hence (n - 1) q x' = n p v'; q follows from the integral for a trial start, and the
    start from this one equation. Raises CranktopoError where none fits the peak.
    """
    peak = _required_value("engine.gas.peak_angle_deg", gas.peak_angle_deg)

    def model(start: float) -> _Combustion:
        trial = _Combustion(gas, room, cycle_deg, start, 1.0)
        return _Combustion(gas, room, cycle_deg, start, _heat_for_peak(trial))

    def slope(start: float) -> float:
        return _peak_slope(model(start), peak)

    _check_above_compression(gas, model(peak - 1.0))
    earliest, latest = max(peak - 2 * gas.burn_duration_deg, -90.0), peak - 0.05
    if slope(earliest) * slope(latest) > 0:
        raise invalid(
            "engine.gas.peak_angle_deg",
            peak,
            f"no start of burning puts the peak there with burn_duration_deg = {gas.burn_duration_deg:g}",
            "Lengthen burn_duration_deg or move the peak.",
        )
    fitted = model(root(slope, earliest, latest, 1e-12))
    _check_is_highest(fitted)
    return fitted


def combustion_pressure_MPa(model: _Combustion, angle_deg: Array) -> Array:
    """Return the absolute cylinder pressure at rising angles after the least volume of firing, MPa."""
    gas = model.gas
    opening, closing = gas.exhaust_opening_deg, _intake_closing_deg(model)
    pressure = np.empty_like(angle_deg)
    burning = angle_deg <= 180.0
    pressure[burning] = _expansion(model, angle_deg[burning])
    compressing = angle_deg >= model.cycle_deg + model.start_deg
    late = compressing & (angle_deg >= closing)
    pressure[late] = _expansion(model, angle_deg[late] - model.cycle_deg)
    early = (angle_deg >= closing) & ~compressing
    pressure[early] = _compression(model, angle_deg[early] - model.cycle_deg)
    exchange = (angle_deg > 180.0) & (angle_deg < closing)
    pressure[exchange] = _gas_exchange(model, angle_deg[exchange])
    blowdown = (angle_deg > opening) & burning
    weight = _smooth_step((angle_deg[blowdown] - opening) / (180.0 - opening))
    released = gas.exhaust_MPa if model.cycle_deg > 360 else gas.intake_MPa
    pressure[blowdown] += weight * (released - pressure[blowdown])
    return pressure


def _gas_exchange(model: _Combustion, angle_deg: Array) -> Array:
    gas = model.gas
    if model.cycle_deg <= 360:
        return np.full_like(angle_deg, gas.intake_MPa)
    weight = _smooth_step((angle_deg - 360.0) / _OVERLAP_DEG)
    return gas.exhaust_MPa + weight * (gas.intake_MPa - gas.exhaust_MPa)


def _intake_closing_deg(model: _Combustion) -> float:
    """Start of compression: bottom dead centre, or where the two-stroke's ports close."""
    return 540.0 if model.cycle_deg > 360 else 360.0 - model.gas.exhaust_opening_deg


def _smooth_step(fraction: Array) -> Array:
    return (1.0 - np.cos(np.pi * np.clip(fraction, 0.0, 1.0))) / 2


def _volume(model: _Combustion, angle_deg: Array) -> tuple[Array, Array]:
    """Volume over the clearance volume, and its derivative per rad."""
    return model.room.volume(angle_deg, model.gas.compression_ratio)


def _compression(model: _Combustion, angle_deg: Array) -> Array:
    closing = np.array([_intake_closing_deg(model) - model.cycle_deg])
    ratio: Array = _volume(model, closing)[0] / _volume(model, angle_deg)[0]
    return model.gas.intake_MPa * ratio**model.gas.polytropic_compression


def _burn_rate(model: _Combustion, angle_deg: Array) -> Array:
    """Derivative of the burnt fraction per rad."""
    power = model.gas.wiebe_shape + 1.0
    phi = np.maximum(angle_deg - model.start_deg, 0.0) / model.gas.burn_duration_deg
    rate = _WIEBE_EFFICIENCY * power * phi ** (power - 1.0) * np.exp(-_WIEBE_EFFICIENCY * phi**power)
    return rate / math.radians(model.gas.burn_duration_deg)


def _burn_integral(model: _Combustion, angle_deg: Array) -> Array:
    """Integral of v^(n-1) dx from the start of burning to each angle (ascending, not before the start)."""
    nodes, weights = _gauss_points()
    ends = np.concatenate([[model.start_deg], angle_deg])
    # Long steps are halved until none exceeds 1 deg, so that the 4-point rule is good to 1e-8.
    parts = max(1, int(np.ceil(np.diff(ends).max(initial=0.0))))
    fine = np.linspace(ends[:-1], ends[1:], parts + 1, axis=1)
    half = np.diff(fine, axis=1)[..., None] / 2
    points = (fine[:, :-1] + fine[:, 1:])[..., None] / 2 + half * nodes
    values = _volume(model, points)[0] ** (model.gas.polytropic_expansion - 1.0) * _burn_rate(model, points)
    steps: Array = (values * weights * np.radians(half)).sum(axis=(1, 2))
    return np.cumsum(steps)


@cache
def _gauss_points() -> tuple[Array, Array]:
    """Return places from -1 to 1 and their weights; finding them takes longer than using them."""
    nodes, weights = np.polynomial.legendre.leggauss(4)
    return nodes, weights


def _expansion(model: _Combustion, angle_deg: Array) -> Array:
    n = model.gas.polytropic_expansion
    before = angle_deg < model.start_deg
    pressure = _compression(model, angle_deg)
    start = np.array([model.start_deg])
    constant = _compression(model, start) * _volume(model, start)[0] ** n
    after = angle_deg[~before]
    energy = constant + (n - 1.0) * model.heat_MPa * _burn_integral(model, after)
    pressure[~before] = energy / _volume(model, after)[0] ** n
    return pressure


def _heat_for_peak(model: _Combustion) -> float:
    """Heat that lifts the pressure to the peak at the peak angle, for the model's start of burning."""
    n = model.gas.polytropic_expansion
    peak_deg = _required_value("engine.gas.peak_angle_deg", model.gas.peak_angle_deg)
    peak, start = np.array([peak_deg]), np.array([model.start_deg])
    charge = _compression(model, start) * _volume(model, start)[0] ** n
    needed = _peak_MPa(model.gas) * _volume(model, peak)[0] ** n - charge
    return float((needed / ((n - 1.0) * _burn_integral(model, peak)))[0])


def _peak_slope(model: _Combustion, peak_deg: float) -> float:
    """Residual of (n - 1) q x' = n p v' at the peak angle."""
    n, peak = model.gas.polytropic_expansion, np.array([peak_deg])
    heating = (n - 1.0) * model.heat_MPa * _burn_rate(model, peak)
    expansion = n * _peak_MPa(model.gas) * _volume(model, peak)[1]
    return float((heating - expansion)[0])


def _peak_MPa(gas: Gas) -> float:
    return _required_value("engine.gas.peak_pressure_MPa", gas.peak_pressure_MPa)


def _required_value(key: str, value: float | None) -> float:
    if value is None:
        raise invalid(key, value, "must be given for the combustion model")
    return value


def _check_above_compression(gas: Gas, model: _Combustion) -> None:
    compressed = float(_compression(model, np.array([0.0]))[0])
    if _peak_MPa(gas) <= compressed:
        raise invalid(
            "engine.gas.peak_pressure_MPa",
            gas.peak_pressure_MPa,
            f"must be above the compression pressure {compressed:.3f} MPa",
            "Raise the peak or lower compression_ratio or intake_pressure_MPa.",
        )


def _check_is_highest(model: _Combustion) -> None:
    pressure = _expansion(model, np.arange(-60.0, 90.0, 0.5))
    if pressure.max() > _peak_MPa(model.gas) * (1 + 1e-6):
        raise invalid(
            "engine.gas.peak_angle_deg",
            model.gas.peak_angle_deg,
            f"the fitted pressure is higher elsewhere ({pressure.max():.3f} MPa)",
            "Move the peak closer to top dead centre or shorten burn_duration_deg.",
        )


STEP_DEG = 0.25
_SAME_PEAK = 1e-3
FileState = tuple[str, int, int]
"""Path, time of the last change and size: what is remembered of a file holds as long as it stays."""


@dataclass(frozen=True)
class PressureCurve:
    """Absolute cylinder pressure over one working cycle from firing top dead centre, its end not included.

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
    return tuple((at.rpm, _curve_of(scene, engine, gas_at(engine.gas, at))) for at in engine.gas.map)


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
