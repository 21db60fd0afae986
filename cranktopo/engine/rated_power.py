"""Power that the cylinder pressure gives beside the rated one, and the burn duration that joins them."""

from __future__ import annotations

from itertools import pairwise

from cranktopo.base.errors import CranktopoError
from cranktopo.base.units import plain_number
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import analyse
from cranktopo.engine.performance import power_kW
from cranktopo.engine.starting_gas import halved, work_J

MECHANICAL_EFFICIENCY = 0.9
"""Power at the shaft, as the rated one is, over the indicated one; assumed, 0.85 to 0.93 are usual."""
WORTH_A_WARNING_PERCENT = 15.0
_BURN_DEG = tuple(range(20, 121, 10))
"""Burn durations that are tried."""


def power_off_percent(scene: Scene) -> float | None:
    """Return by how much the indicated power is above that of the rated one; None where one is unknown."""
    engine = scene.engine
    cycle = analyse(scene).cycle if engine else None
    if engine is None or engine.rated_power_kW is None or cycle is None:
        return None
    return 100 * (power_kW(cycle.indicated_work_J, engine) / _wanted_kW(scene) - 1)


def rated_power_words(scene: Scene) -> str:
    """Return the rated power beside that of the cylinder pressure; empty where one is unknown."""
    off, engine = power_off_percent(scene), scene.engine
    if off is None or engine is None or engine.rated_power_kW is None:
        return ""
    side = "above" if off > 0 else "below"
    told = (
        f"rated power {plain_number(engine.rated_power_kW, 5)} kW at the shaft, {_wanted_kW(scene):.0f} kW "
        f"indicated at an assumed mechanical efficiency of {MECHANICAL_EFFICIENCY:g}: the cylinder pressure "
        f"gives {abs(off):.1f} % {side}"
    )
    return told + _by_burning(scene)


def rated_power_warnings(scene: Scene) -> tuple[str, ...]:
    """Return the same as a warning where the powers are far apart; else nothing."""
    off = power_off_percent(scene)
    return () if off is None or abs(off) <= WORTH_A_WARNING_PERCENT else (rated_power_words(scene),)


def burn_for_rated_power_deg(scene: Scene) -> float | None:
    """Return the burn duration with which the combustion model has the rated power; None where none has."""
    engine = scene.engine
    if engine is None or engine.gas is None or engine.gas.measured or engine.gas.map:
        return None

    def at(burn_deg: float) -> float:
        return _power_kW(scene, burn_deg)

    wanted, powers = _wanted_kW(scene), [(burn, at(burn)) for burn in _BURN_DEG]
    for (one, low), (other, high) in pairwise(powers):
        if 0 < low <= wanted <= high:
            return halved(at, (one, other), wanted)
    return None


def _by_burning(scene: Scene) -> str:
    """Return the burn duration that joins both powers, or that none does; nothing of a measured pressure."""
    engine, burn = scene.engine, burn_for_rated_power_deg(scene)
    if burn is not None:
        return f"; engine.gas.burn_duration_deg = {burn:.3g} gives the rated one"
    if engine is None or engine.gas is None or engine.gas.measured or engine.gas.map:
        return ""
    return (
        f"; no engine.gas.burn_duration_deg from {_BURN_DEG[0]} to {_BURN_DEG[-1]} gives the rated one: look "
        "at peak pressure, intake pressure and compression ratio"
    )


def _wanted_kW(scene: Scene) -> float:
    assert scene.engine is not None
    assert scene.engine.rated_power_kW is not None
    return scene.engine.rated_power_kW / MECHANICAL_EFFICIENCY


def _power_kW(scene: Scene, burn_deg: float) -> float:
    """Return the indicated power with a burn duration; 0 where nothing can burn so."""
    engine = scene.engine
    assert engine is not None
    assert engine.gas is not None
    gas = engine.gas.model_copy(update={"burn_duration_deg": burn_deg})
    changed = scene.model_copy(update={"engine": engine.model_copy(update={"gas": gas})})
    try:
        return power_kW(work_J(changed), engine)
    except CranktopoError:
        return 0.0
