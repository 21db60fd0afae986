"""Power that the cylinder pressure gives beside the rated one, and the burn duration that joins them."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

from cranktopo.base.errors import CranktopoError
from cranktopo.base.units import plain_number
from cranktopo.design.engine import Gas
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import analyse
from cranktopo.engine.performance import power_kW
from cranktopo.engine.starting_gas import halved, with_gas, work_J

MECHANICAL_EFFICIENCY = 0.9
"""Power at the shaft, as the rated one is, over the indicated one; assumed, 0.85 to 0.93 are usual."""
WORTH_A_WARNING_PERCENT = 15.0
_BURN_DEG = tuple(range(20, 121, 10))
"""Burn durations that are tried."""


@dataclass(frozen=True)
class RatedPower:
    """The rated power beside that of the cylinder pressure.

    Attributes:
        off_percent: by how much the indicated power is above that of the rated one.
        words: both, and the burn duration that joins them.
    """

    off_percent: float
    words: str

    @property
    def warnings(self) -> tuple[str, ...]:
        """The words where the powers are far apart; else nothing."""
        return (self.words,) if abs(self.off_percent) > WORTH_A_WARNING_PERCENT else ()


def rated_power(scene: Scene) -> RatedPower | None:
    """Return the rated power beside that of the cylinder pressure; None where one is unknown."""
    engine = scene.engine
    if engine is None or engine.rated_power_kW is None:
        return None
    cycle = analyse(scene).cycle
    if cycle is None:
        return None
    indicated_kW = engine.rated_power_kW / MECHANICAL_EFFICIENCY
    given_kW = power_kW(cycle.indicated_work_J, engine)
    off = 100 * (given_kW / indicated_kW - 1)
    words = (
        f"rated power {plain_number(engine.rated_power_kW, 5)} kW at the shaft, "
        f"{plain_number(indicated_kW)} kW "
        f"indicated at an assumed mechanical efficiency of {MECHANICAL_EFFICIENCY:g}: the cylinder pressure "
        f"gives {abs(off):.1f} % "
        f"{'above' if off > 0 else 'below'}, {plain_number(given_kW)} kW"
    )
    return RatedPower(off, words + _by_burning(scene, engine.gas, indicated_kW))


def _by_burning(scene: Scene, gas: Gas | None, indicated_kW: float) -> str:
    """Return the burn duration that joins both powers, or that none does; nothing of a measured pressure."""
    if gas is None or gas.measured or gas.map:
        return ""
    burn = burn_duration_deg(scene, indicated_kW)
    if burn is not None:
        return f"; engine.gas.burn_duration_deg = {burn:.3g} gives the rated one"
    return (
        f"; no engine.gas.burn_duration_deg from {_BURN_DEG[0]} to {_BURN_DEG[-1]} gives the rated one: look "
        "at peak pressure, intake pressure and compression ratio"
    )


def burn_duration_deg(scene: Scene, indicated_kW: float) -> float | None:
    """Return the burn duration that gives the combustion model an indicated power; None where none does."""

    def at(burn_deg: float) -> float:
        return _power_kW(scene, burn_deg)

    powers = [(burn, at(burn)) for burn in _BURN_DEG]
    for (one, low), (other, high) in pairwise(powers):
        if 0 < low <= indicated_kW <= high:
            return halved(at, (one, other), indicated_kW)
    return None


def _power_kW(scene: Scene, burn_deg: float) -> float:
    """Return the indicated power with a burn duration; 0 where nothing can burn so."""
    assert scene.engine is not None
    try:
        return power_kW(work_J(with_gas(scene, {"burn_duration_deg": burn_deg})), scene.engine)
    except CranktopoError:
        return 0.0
