"""Combustion fitted to the peak pressure: Wiebe heat release between polytropes.

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
from dataclasses import dataclass
from functools import cache

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import invalid
from cranktopo.base.quadrature import gauss_legendre
from cranktopo.base.root import root
from cranktopo.design.engine import Gas
from cranktopo.engine.chamber import Chamber

_WIEBE_EFFICIENCY = 6.908  # -ln(1 - 0.999)
_OVERLAP_DEG = 20.0  # width of the change from exhaust to intake pressure after gas-exchange dead centre


@dataclass(frozen=True)
class Combustion:
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


def fit_combustion(gas: Gas, room: Chamber, cycle_deg: float) -> Combustion:
    """Return start of burning and heat such that the pressure peaks where and as high as the scene says.

    At the peak p' = 0, hence (n - 1) q x' = n p v'; q follows from the integral for a trial start, and the
    start from this one equation. Raises CranktopoError where none fits the peak.
    """
    peak = _required_value("engine.gas.peak_angle_deg", gas.peak_angle_deg)

    def model(start: float) -> Combustion:
        trial = Combustion(gas, room, cycle_deg, start, 1.0)
        return Combustion(gas, room, cycle_deg, start, _heat_for_peak(trial))

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


def combustion_pressure_MPa(model: Combustion, angle_deg: Array) -> Array:
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


def _gas_exchange(model: Combustion, angle_deg: Array) -> Array:
    gas = model.gas
    if model.cycle_deg <= 360:
        return np.full_like(angle_deg, gas.intake_MPa)
    weight = _smooth_step((angle_deg - 360.0) / _OVERLAP_DEG)
    return gas.exhaust_MPa + weight * (gas.intake_MPa - gas.exhaust_MPa)


def _intake_closing_deg(model: Combustion) -> float:
    """Start of compression: bottom dead centre, or where the two-stroke's ports close."""
    return 540.0 if model.cycle_deg > 360 else 360.0 - model.gas.exhaust_opening_deg


def _smooth_step(fraction: Array) -> Array:
    return (1.0 - np.cos(np.pi * np.clip(fraction, 0.0, 1.0))) / 2


def _volume(model: Combustion, angle_deg: Array) -> Array:
    """Volume over the clearance volume."""
    return model.room.volume(angle_deg, model.gas.compression_ratio)


def _compression(model: Combustion, angle_deg: Array) -> Array:
    closing = np.array([_intake_closing_deg(model) - model.cycle_deg])
    ratio: Array = _volume(model, closing) / _volume(model, angle_deg)
    return model.gas.intake_MPa * ratio**model.gas.polytropic_compression


def _burn_rate(model: Combustion, angle_deg: Array) -> Array:
    """Derivative of the burnt fraction per rad."""
    power = model.gas.wiebe_shape + 1.0
    phi = np.maximum(angle_deg - model.start_deg, 0.0) / model.gas.burn_duration_deg
    rate = _WIEBE_EFFICIENCY * power * phi ** (power - 1.0) * np.exp(-_WIEBE_EFFICIENCY * phi**power)
    return rate / math.radians(model.gas.burn_duration_deg)


def _burn_integral(model: Combustion, angle_deg: Array) -> Array:
    """Integral of v^(n-1) dx from the start of burning to each angle (ascending, not before the start)."""
    first = np.concatenate([[model.start_deg], angle_deg[:1]])  # alone: it may be as long as fifty others
    return np.cumsum(np.concatenate([_burnt_between(model, ends) for ends in (first, angle_deg)]))


def _burnt_between(model: Combustion, ends_deg: Array) -> Array:
    """Integral of v^(n-1) dx over each step between ascending angles, by parts of at most 1 deg.

    Over these the 4-point rule is good to 1e-8.
    """
    nodes, weights = _gauss_points()
    parts = max(1, int(np.ceil(np.diff(ends_deg).max(initial=0.0))))
    fine = np.linspace(ends_deg[:-1], ends_deg[1:], parts + 1, axis=1)
    half = np.diff(fine, axis=1)[..., None] / 2
    points = (fine[:, :-1] + fine[:, 1:])[..., None] / 2 + half * nodes
    values = _volume(model, points) ** (model.gas.polytropic_expansion - 1.0) * _burn_rate(model, points)
    steps: Array = (values * weights * np.radians(half)).sum(axis=(1, 2))
    return steps


@cache
def _gauss_points() -> tuple[Array, Array]:
    """Return places from -1 to 1 and their weights; finding them takes longer than using them."""
    nodes, weights = gauss_legendre(4)
    return nodes, weights


def _expansion(model: Combustion, angle_deg: Array) -> Array:
    n = model.gas.polytropic_expansion
    before = angle_deg < model.start_deg
    pressure = _compression(model, angle_deg)
    start = np.array([model.start_deg])
    constant = _compression(model, start) * _volume(model, start) ** n
    after = angle_deg[~before]
    energy = constant + (n - 1.0) * model.heat_MPa * _burn_integral(model, after)
    pressure[~before] = energy / _volume(model, after) ** n
    return pressure


def _heat_for_peak(model: Combustion) -> float:
    """Heat that lifts the pressure to the peak at the peak angle, for the model's start of burning."""
    n = model.gas.polytropic_expansion
    peak_deg = _required_value("engine.gas.peak_angle_deg", model.gas.peak_angle_deg)
    peak, start = np.array([peak_deg]), np.array([model.start_deg])
    charge = _compression(model, start) * _volume(model, start) ** n
    needed = _peak_MPa(model.gas) * _volume(model, peak) ** n - charge
    return float((needed / ((n - 1.0) * _burn_integral(model, peak)))[0])


def _peak_slope(model: Combustion, peak_deg: float) -> float:
    """Residual of (n - 1) q x' = n p v' at the peak angle."""
    n, peak = model.gas.polytropic_expansion, np.array([peak_deg])
    heating = (n - 1.0) * model.heat_MPa * _burn_rate(model, peak)
    expansion = n * _peak_MPa(model.gas) * model.room.volume_rate(peak, model.gas.compression_ratio)
    return float((heating - expansion)[0])


def _peak_MPa(gas: Gas) -> float:
    return _required_value("engine.gas.peak_pressure_MPa", gas.peak_pressure_MPa)


def _required_value(key: str, value: float | None) -> float:
    if value is None:
        raise invalid(key, value, "must be given for the combustion model")
    return value


def _check_above_compression(gas: Gas, model: Combustion) -> None:
    compressed = float(_compression(model, np.array([0.0]))[0])
    if _peak_MPa(gas) <= compressed:
        raise invalid(
            "engine.gas.peak_pressure_MPa",
            gas.peak_pressure_MPa,
            f"must be above the compression pressure {compressed:.3f} MPa",
            "Raise the peak or lower compression_ratio or intake_pressure_MPa.",
        )


def _check_is_highest(model: Combustion) -> None:
    pressure = _expansion(model, np.arange(-60.0, 90.0, 0.5))
    if pressure.max() > _peak_MPa(model.gas) * (1 + 1e-6):
        raise invalid(
            "engine.gas.peak_angle_deg",
            model.gas.peak_angle_deg,
            f"the fitted pressure is higher elsewhere ({pressure.max():.3f} MPa)",
            "Move the peak closer to top dead centre or shorten burn_duration_deg.",
        )
