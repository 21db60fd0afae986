"""Gas force on the piston over the working cycle."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import invalid
from cranktopo.design.engine import Engine
from cranktopo.design.schema import Scene
from cranktopo.engine.combustion import combustion_pressure_MPa, fit_combustion
from cranktopo.engine.indicator import read_indicator

STEP_DEG = 0.25


@dataclass(frozen=True)
class PressureCurve:
    """Cylinder pressure over one working cycle, on evenly spaced crank angles.

    Attributes:
        angle_deg: crank angles from firing top dead centre, 0 up to (not including) the cycle, deg.
        pressure_MPa: absolute pressure at these angles, MPa.
        source: where the curve comes from, one sentence.
    """

    angle_deg: Array
    pressure_MPa: Array
    cycle_deg: float
    source: str


def pressure_curve(scene: Scene) -> PressureCurve | None:
    """The cylinder pressure of a scene; None when the scene has no `[engine.gas]`.

    The same curve serves every speed.

    Raises:
        CranktopoError: an indicator file that cannot be used, a peak that no combustion reaches.
    """
    engine = scene.engine
    if engine is None or engine.gas is None:
        return None
    angle = np.arange(0.0, engine.cycle_deg, STEP_DEG)
    if engine.gas.indicator_csv is not None:
        return _measured(engine, engine.gas.indicator_csv, angle)
    model = fit_combustion(engine.gas, scene.throw.radius_mm, engine.rod_length_mm, engine.cycle_deg)
    source = (
        f"Wiebe combustion model fitted to {engine.gas.peak_pressure_MPa:g} MPa at "
        f"{engine.gas.peak_angle_deg:g} deg: burning starts at {model.start_deg:.1f} deg, compression ratio "
        f"{engine.gas.compression_ratio:g}"
    )
    return PressureCurve(angle, combustion_pressure_MPa(model, angle), engine.cycle_deg, source)


def _measured(engine: Engine, path: str, angle: Array) -> PressureCurve:
    """The measured points joined by a periodic monotone cubic (PCHIP: no overshoot between points)."""
    from scipy.interpolate import PchipInterpolator

    ambient = engine.gas.ambient_pressure_MPa if engine.gas else 0.0
    measured, pressure = read_indicator(path, engine.cycle_deg, ambient)
    turns = engine.cycle_deg * np.array([[-1.0], [0.0], [1.0]])
    curve = PchipInterpolator((measured + turns).ravel(), np.tile(pressure, 3))
    return PressureCurve(angle, curve(angle), engine.cycle_deg, f"indicator diagram {path}")


def gas_force_N(pressure_MPa: Array, engine: Engine) -> Array:
    """Force of the gas on the piston toward the crank axis, N.

    Raises:
        CranktopoError: the engine has no gas table.
    """
    if engine.gas is None:
        raise invalid("engine.gas", None, "must be given for a gas force")
    return (pressure_MPa - engine.gas.ambient_pressure_MPa) * math.pi / 4 * engine.bore_mm**2
