"""Gas of a design that begins with its power: pressures, and where these cannot give it compression, too."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.base.units import plain_number
from cranktopo.design.engine import Gas
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import indicated_work_J
from cranktopo.engine.gas import pressure_curve
from cranktopo.engine.performance import mean_pressure_MPa, power_kW

_USUAL = 9.0
_OF_CHARGE = 4.5, 16.0
"""Mean pressure over that before compression: usual, and the range that a proposal keeps to."""
_MOST_OF_CHARGE = 12.0
"""The same where the peak is not known: more is charged."""
_COMPRESSION = (9.0, 11.0, 13.0, 15.0, 17.0)
_BURN_DEG = (60.0, 45.0, 30.0, 20.0)
"""Usual first, then shorter: under high compression only a short burning gives little work."""
_OVER_COMPRESSION = 1.05
"""Least peak over the pressure of compression alone that is proposed."""
_INTAKE_MPA = (0.03, 0.06, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6)
_PEAK_MPA = 1.5, 40.0
_CHARGED = 1.05
"""Intake pressure over that of the air from which an engine counts as charged."""
_EXHAUST_SHARE = 0.8
"""Pressure behind a charged engine over that before it."""
_HALVINGS = 14
_BEYOND = 1.0, 1.02, 1.05
"""Peak pressures that are tried for a hint, over what a power needs in proportion."""
_WITHIN = 0.99, 0.95, 0.9, 0.8, 0.65, 0.5
"""Powers that are tried for a hint, over the most that there is; their inverse over the least."""
_MET = 2e-3
"""Share by which a proposal may miss the mean pressure that is wanted."""


@dataclass(frozen=True)
class _Proposal:
    """Keys of `[engine.gas]`, and the mean pressure that they give, MPa."""

    keys: dict[str, float]
    mean_MPa: float

    @property
    def of_charge(self) -> float:
        """Mean pressure over that before compression."""
        return self.mean_MPa / self.keys["intake_pressure_MPa"]


def gas_for_power(
    scene: Scene, target_kW: float, peak_MPa: float | None, compression_ratio: float | None = None
) -> dict[str, float]:
    """Return keys of `[engine.gas]` with which an engine has a power, but for those at their default.

    Where the peak is known, the intake pressure gives the power; where that alone does not, another
    compression ratio, unless it is known as well, or a shorter burning does. Else the peak gives the power,
    the charge follows it, and the burning is as short as the compression needs.

    Raises:
        CranktopoError: no such gas, with what is assumed and what would do.
    """
    engine = scene.engine
    assert engine is not None
    mean = target_kW * _MPa_per_kW(scene)
    ratios = _COMPRESSION if compression_ratio is None else (compression_ratio,)
    found = _proposed(scene, mean, peak_MPa, ratios)
    if isinstance(found, _Range):
        raise _refused(scene, target_kW, mean, found, peak_MPa, ratios)
    return {key: value for key, value in found.items() if value != Gas.model_fields[key].default}


def _proposed(
    scene: Scene, mean: float, peak_MPa: float | None, ratios: Sequence[float]
) -> dict[str, float] | _Range:
    """Return keys that give a mean pressure, MPa; else the mean pressures that can be had."""
    return _by_peak(scene, mean) if peak_MPa is None else _at_peak(scene, mean, peak_MPa, ratios)


def gas_line(scene: Scene) -> str:
    """Return the gas of a starting point, all of it assumed, in one line."""
    engine = scene.engine
    assert engine is not None
    assert engine.gas is not None
    gas = engine.gas
    work = work_J(scene)
    parts = (
        f"peak {gas.peak_pressure_MPa:g} MPa at {gas.peak_angle_deg:g} deg, intake {gas.intake_MPa:.3g} MPa"
    )
    parts += f", exhaust {gas.exhaust_MPa:.3g} MPa, compression ratio {gas.compression_ratio:g}"
    return (
        f"assumed: {parts}, burn duration {gas.burn_duration_deg:g} deg: {power_kW(work, engine):.4g} kW at "
        f"{engine.speed_rpm:g} rpm, indicated mean pressure "
        f"{mean_pressure_MPa(work, engine, scene.throw.radius_mm):.3g} MPa{_of_charge_words(scene)}"
    )


def _of_charge_words(scene: Scene) -> str:
    """Return that an intake is that of a charged engine, and what the peak gives without a charge."""
    engine = scene.engine
    if engine is None or engine.gas is None:
        return ""
    if engine.gas.intake_MPa <= _CHARGED * engine.gas.ambient_pressure_MPa:
        return ""
    uncharged = with_gas(scene, {"intake_pressure_MPa": None, "exhaust_pressure_MPa": None})
    try:
        kW = power_kW(work_J(uncharged), engine)
    except CranktopoError:
        return "; such an intake is that of a charged engine"
    return f"; such an intake is that of a charged engine: without a charge this peak gives {kW:.4g} kW"


@dataclass(frozen=True)
class _Range:
    """Mean pressures that can be had, MPa."""

    least_MPa: float
    most_MPa: float


def _by_peak(scene: Scene, mean: float) -> dict[str, float] | _Range:
    """Return the peak that gives a mean pressure, the charge of one that needs it, and no longer a burning.

    The peak is above what compression alone reaches, which in a diesel is 5 MPa and more.
    """
    ambient, seen = _ambient(scene), list[float]()
    charge = _charged(min(max(mean / _MOST_OF_CHARGE, ambient), _INTAKE_MPA[-1]), ambient)
    intake = charge.get("intake_pressure_MPa", ambient)
    ends = max(_PEAK_MPA[0], _OVER_COMPRESSION * _compressed_MPa(scene, intake)), _PEAK_MPA[1]
    for burn in _BURN_DEG:
        fixed = {**charge, "burn_duration_deg": burn}

        def at(peak: float, fixed: dict[str, float] = fixed) -> float:
            return _mean_MPa(scene, {**fixed, "peak_pressure_MPa": peak}) or 0.0

        low, high = map(at, ends)
        seen += [found for found in (low, high) if found]
        if low <= mean <= high:
            peak = halved(at, ends, mean)
            if abs(at(peak) / mean - 1) < _MET:
                return {**fixed, "peak_pressure_MPa": peak}
    return _Range(min(seen, default=0.0), max(seen, default=0.0))


def _compressed_MPa(scene: Scene, intake_MPa: float) -> float:
    """Return the pressure that compression alone reaches at top dead centre."""
    assert scene.engine is not None
    assert scene.engine.gas is not None
    gas = scene.engine.gas
    return float(intake_MPa * gas.compression_ratio**gas.polytropic_compression)


def _at_peak(scene: Scene, mean: float, peak: float, ratios: Sequence[float]) -> dict[str, float] | _Range:
    """Return the intake pressure that gives a mean pressure, and whatever else it needs."""
    seen: list[float] = []
    for burn in _BURN_DEG:
        fits = []
        for ratio in ratios:
            fixed = {"peak_pressure_MPa": peak, "compression_ratio": ratio, "burn_duration_deg": burn}
            found = list(_over_intake(scene, fixed))
            seen += [one.mean_MPa for one in found if _plausible(one)]
            fits += [one for one in _between(scene, fixed, found, mean) if _plausible(one)]
            if fits and (burn, ratio) == (_BURN_DEG[0], ratios[0]):
                return fits[0].keys  # nothing but the intake is proposed
        if fits:
            return min(fits, key=lambda one: abs(math.log(one.of_charge / _USUAL))).keys
    return _Range(min(seen, default=0.0), max(seen, default=0.0))


def _over_intake(scene: Scene, fixed: dict[str, float]) -> Iterator[_Proposal]:
    """Yield what intake pressures give, the least first; none where compression alone reaches the peak."""
    for intake in sorted({*_INTAKE_MPA, _ambient(scene)}):
        keys = {**fixed, **_charged(intake, _ambient(scene))}
        mean = _mean_MPa(scene, keys)
        if mean is not None:
            yield _Proposal({**keys, "intake_pressure_MPa": intake}, mean)


def _plausible(one: _Proposal) -> bool:
    return _OF_CHARGE[0] <= one.of_charge <= _OF_CHARGE[1]


def _between(
    scene: Scene, fixed: dict[str, float], found: list[_Proposal], mean: float
) -> Iterator[_Proposal]:
    """Yield proposals of a mean pressure between two neighbours of which it is."""
    for one, other in pairwise(found):
        if not min(one.mean_MPa, other.mean_MPa) <= mean <= max(one.mean_MPa, other.mean_MPa):
            continue

        def at(intake: float) -> float:
            return _mean_MPa(scene, {**fixed, **_charged(intake, _ambient(scene))}) or 0.0

        ends = one.keys["intake_pressure_MPa"], other.keys["intake_pressure_MPa"]
        intake = halved(at, ends, mean, rising=one.mean_MPa < mean)
        yield _Proposal({**fixed, **_charged(intake, _ambient(scene)), "intake_pressure_MPa": intake}, mean)


def halved(
    at: Callable[[float], float], between: tuple[float, float], target: float, *, rising: bool = True
) -> float:
    """Return where a curve has a value between two places, to four digits."""
    low, high = between
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if (at(middle) < target) == rising else (low, middle)
    return float(f"{(low + high) / 2:.4g}")


def _charged(intake: float, ambient: float) -> dict[str, float]:
    """Return intake and exhaust pressure of a charged engine; the intake alone of any other."""
    if intake <= ambient:
        return {} if intake == ambient else {"intake_pressure_MPa": intake}
    exhaust = max(_EXHAUST_SHARE * intake, ambient)
    return {"intake_pressure_MPa": float(f"{intake:.4g}"), "exhaust_pressure_MPa": float(f"{exhaust:.4g}")}


def _ambient(scene: Scene) -> float:
    assert scene.engine is not None
    assert scene.engine.gas is not None
    return scene.engine.gas.ambient_pressure_MPa


def _mean_MPa(scene: Scene, keys: dict[str, float]) -> float | None:
    """Return the indicated mean pressure with keys of `[engine.gas]`; None where nothing can burn so."""
    assert scene.engine is not None
    try:
        return mean_pressure_MPa(work_J(with_gas(scene, keys)), scene.engine, scene.throw.radius_mm)
    except CranktopoError:
        return None


def with_gas(scene: Scene, keys: Mapping[str, float | None]) -> Scene:
    """Return the scene of an engine with other keys of its `[engine.gas]`, which are not checked."""
    engine = scene.engine
    assert engine is not None
    assert engine.gas is not None
    gas = engine.gas.model_copy(update=dict(keys))
    return scene.model_copy(update={"engine": engine.model_copy(update={"gas": gas})})


def work_J(scene: Scene) -> float:
    """Return the work of the gas in one cylinder per cycle, J."""
    curve = pressure_curve(scene)
    assert curve is not None
    assert scene.engine is not None
    return indicated_work_J(curve, scene.engine, scene.throw.radius_mm)


def _advice(scene: Scene, mean: float, peak: float | None, known: _Range, ratios: Sequence[float]) -> str:
    """Return what would do, as it was tried: a peak, no peak or, where the power is out of reach, another."""
    free = None if peak is None else _by_peak(scene, mean)
    if peak is not None and (needed := _peak_that_does(scene, mean, peak, known, ratios)):
        also = "" if isinstance(free, _Range) else "; or leave it out"
        return f" A peak pressure of {needed:g} MPa (--peak-pressure-MPa) would do{also}."
    if isinstance(free, dict):
        return f" Leave --peak-pressure-MPa out: it is {free['peak_pressure_MPa']:.3g} MPa then."
    if other := _power_that_does(scene, mean, peak, known, ratios):
        return f" A power of {other:g} kW (--power-kW) would do."
    if free and (other := _power_that_does(scene, mean, None, free, ratios)):
        return f" A power of {other:g} kW (--power-kW) would do without --peak-pressure-MPa."
    return ""


def _MPa_per_kW(scene: Scene) -> float:
    """Return the mean pressure of a kilowatt."""
    engine = scene.engine
    assert engine is not None
    return mean_pressure_MPa(1.0 / power_kW(1.0, engine), engine, scene.throw.radius_mm)


def _power_that_does(
    scene: Scene, mean: float, peak: float | None, known: _Range, ratios: Sequence[float]
) -> float | None:
    """Return a power of three digits within those that can be had, kW; None where none is taken.

    The charge follows the power, so that each is tried.
    """
    per_kW = _MPa_per_kW(scene)
    near, less = min(max(mean, known.least_MPa), known.most_MPa), mean > known.least_MPa
    for within in _WITHIN if near else ():
        tried = float(f"{near * (within if less else 1 / within) / per_kW:.3g}")
        if not isinstance(_proposed(scene, tried * per_kW, peak, ratios), _Range):
            return tried
    return None


def _peak_that_does(
    scene: Scene, mean: float, peak: float, pressure_range: _Range, ratios: Sequence[float]
) -> float | None:
    """Return a peak of three digits in proportion to the mean pressure that is wanted, or a little beyond.

    None where no such one is accepted: each takes a second to try.
    """
    more = mean > pressure_range.most_MPa
    near = pressure_range.most_MPa if more else pressure_range.least_MPa
    for beyond in _BEYOND if near else ():
        tried = float(f"{peak * mean / near * (beyond if more else 1 / beyond):.3g}")
        within = _PEAK_MPA[0] <= tried <= _PEAK_MPA[1]
        if within and not isinstance(_at_peak(scene, mean, tried, ratios), _Range):
            return tried
    return None


def _refused(
    scene: Scene,
    target_kW: float,
    mean: float,
    pressure_range: _Range,
    peak: float | None,
    ratios: Sequence[float],
) -> CranktopoError:
    """Return a refusal with what is assumed and what would do."""
    engine = scene.engine
    assert engine is not None
    assert engine.gas is not None
    assumed = f"{'assumed ' if len(ratios) > 1 else ''}compression ratio {ratios[0]:g}"
    assumed += f" to {ratios[-1]:g}" if peak is not None and len(ratios) > 1 else ""
    assumed += f", burn duration {_BURN_DEG[-1]:g} to {_BURN_DEG[0]:g} deg"
    at = f"peak pressures of {_PEAK_MPA[0]:g} to {_PEAK_MPA[1]:g} MPa"
    angle = f"assumed at {engine.gas.peak_angle_deg:g} deg after top dead centre"
    hint = "Look at bore, stroke, speed and number of cylinders."
    if peak is not None:
        assumed += ", a mean pressure of {:g} to {:g} times that before compression".format(*_OF_CHARGE)
        at = f"the peak pressure of {peak:g} MPa"
        hint = f"It is indicated, before friction: that at the shaft over 0.8 to 0.9. {hint}"
    hint += _advice(scene, mean, peak, pressure_range, ratios)
    if peak is not None:
        hint += " If it is at another angle, leave the power out and give engine.gas.peak_angle_deg."
    return invalid(
        "power_kW",
        target_kW,
        f"it needs an indicated mean pressure of {plain_number(mean, 3)} MPa; with {at}, {angle}, and "
        f"{assumed}, this engine has {_range_words(pressure_range, mean, target_kW / mean)}",
        hint,
    )


def _range_words(known: _Range, mean: float, kW_per_MPa: float) -> str:
    if not known.most_MPa:
        return "no power at all"
    but = ", but not this power" if known.least_MPa <= mean <= known.most_MPa else ""
    least, most = (plain_number(end * kW_per_MPa, 3) for end in (known.least_MPa, known.most_MPa))
    return f"{least} to {most} kW{but}"
