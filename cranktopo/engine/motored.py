"""Pressure of a cylinder that does not fire: its charge is compressed and expands, and nothing burns.

Without combustion and without loss of heat the charge expands by the polytrope that compressed it: pressures
are alike on both sides of top dead centre until the exhaust opens, and the gas exchange is that of a cylinder
that fires. A measured trace does not tell that polytrope where fuel burns; its own compression is mirrored
about top dead centre, with what burns before it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.engine import Engine, Gas
from cranktopo.design.misfire import MIRRORED
from cranktopo.design.schema import Scene
from cranktopo.engine.chamber import chamber_of
from cranktopo.engine.combustion import combustion_pressure_MPa, fit_combustion
from cranktopo.engine.gas import (
    PressureCurve,
    after_least_deg,
    at_rising,
    between,
    gas_at,
    mapped_curves,
    pressure_curve,
)


def motored_curve(scene: Scene) -> PressureCurve | None:
    """Return the pressure of a cylinder that does not fire, at the engine's speed; None without pressures.

    Raises:
        CranktopoError: as of `pressure_curve`.
    """
    engine, fired = scene.engine, pressure_curve(scene)
    if engine is None or engine.gas is None or fired is None:
        return None
    if engine.gas.map:
        return between(motored_map(scene), engine.speed_rpm)
    return _motored(scene, engine, engine.gas, fired)


def motored_map(scene: Scene) -> tuple[tuple[float, PressureCurve], ...]:
    """Return speed and pressure without combustion of each entry of a map over speed, the slowest first."""
    engine = scene.engine
    if engine is None or engine.gas is None:
        return ()
    pairs = zip(engine.gas.map, mapped_curves(scene), strict=True)
    return tuple((rpm, _motored(scene, engine, gas_at(engine.gas, at), fired)) for at, (rpm, fired) in pairs)


def _motored(scene: Scene, engine: Engine, gas: Gas, fired: PressureCurve) -> PressureCurve:
    if gas.indicator_csv is not None:
        return replace(fired, pressure_MPa=_mirrored(fired, gas.exhaust_opening_deg), source=MIRRORED)
    room = chamber_of(scene)
    model = fit_combustion(gas, room, engine.cycle_deg)
    cold = gas.model_copy(update={"polytropic_expansion": gas.polytropic_compression})
    still = replace(model, gas=cold, heat_MPa=0.0)
    after = after_least_deg(fired.angle_deg, room, engine.cycle_deg)
    pressure = at_rising(lambda rising: combustion_pressure_MPa(still, rising), after)
    return replace(fired, pressure_MPa=pressure, source="compression and expansion without combustion")


def _mirrored(fired: PressureCurve, opening_deg: float) -> Array:
    """The trace with its compression in place of the expansion, which passes into the gas exchange."""
    pressure = fired.pressure_MPa
    angle = np.mod(fired.angle_deg - fired.least_volume_deg, fired.cycle_deg)
    expanding = angle < 180.0
    exhaust = np.clip((angle[expanding] - opening_deg) / (180.0 - opening_deg), 0.0, 1.0)
    weight = (1.0 - np.cos(np.pi * exhaust)) / 2
    found = pressure.copy()
    before = np.interp(-angle[expanding], angle, pressure, period=fired.cycle_deg)
    found[expanding] = before + weight * (pressure[expanding] - before)
    return found
