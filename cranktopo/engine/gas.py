"""Gas force on the piston over the working cycle."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import invalid
from cranktopo.design.engine import Engine, Gas
from cranktopo.design.schema import Scene
from cranktopo.engine.combustion import combustion_pressure_MPa, fit_combustion
from cranktopo.engine.indicator import read_indicator

STEP_DEG = 0.25
FileState = tuple[str, int, int]
"""Path, time of the last change and size: what is remembered of a file holds as long as it stays."""


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


def file_state(path: str | Path) -> FileState:
    """Return the state of a file; that of one that is not there is its path alone."""
    try:
        found = Path(path).stat()
    except (OSError, ValueError):  # not there, or no name that a file can have
        return str(path), 0, 0
    return str(path), found.st_mtime_ns, found.st_size


def pressure_curve(scene: Scene) -> PressureCurve | None:
    """Return the cylinder pressure of a scene; None when the scene has no `[engine.gas]`.

    The same curve serves every speed, and every stage that asks for it again.

    Raises:
        CranktopoError: an indicator file that cannot be used, a peak that no combustion reaches.
    """
    engine = scene.engine
    if engine is None or engine.gas is None:
        return None
    measured = engine.gas.indicator_csv
    state = None if measured is None else file_state(measured)
    return _curve(engine.gas, scene.throw.radius_mm, engine.rod_length_mm, engine.cycle_deg, state)


@lru_cache(maxsize=64)
def _curve(
    gas: Gas, radius_mm: float, rod_length_mm: float, cycle_deg: float, _state: FileState | None
) -> PressureCurve:
    """Compute the curve of what it depends on, the state of an indicator file among it."""
    angle = np.arange(0.0, cycle_deg, STEP_DEG)
    if gas.indicator_csv is not None:
        pressure, source = (
            _measured(gas, gas.indicator_csv, cycle_deg, angle),
            f"indicator diagram {gas.indicator_csv}",
        )
    else:
        model = fit_combustion(gas, radius_mm, rod_length_mm, cycle_deg)
        pressure = combustion_pressure_MPa(model, angle)
        source = (
            f"Wiebe combustion model fitted to {gas.peak_pressure_MPa:g} MPa at "
            f"{gas.peak_angle_deg:g} deg: burning starts at {model.start_deg:.1f} deg, compression ratio "
            f"{gas.compression_ratio:g}"
        )
    for shared in (angle, pressure):
        shared.setflags(write=False)
    return PressureCurve(angle, pressure, cycle_deg, source)


def _measured(gas: Gas, path: str, cycle_deg: float, angle: Array) -> Array:
    """Join the measured points by a periodic monotone cubic (PCHIP: no overshoot between points)."""
    from scipy.interpolate import PchipInterpolator

    measured, pressure = read_indicator(path, cycle_deg, gas.ambient_pressure_MPa)
    turns = cycle_deg * np.array([[-1.0], [0.0], [1.0]])
    curve = PchipInterpolator((measured + turns).ravel(), np.tile(pressure, 3))
    return np.asarray(curve(angle))


def gas_force_N(pressure_MPa: Array, engine: Engine) -> Array:
    """Return the force of the gas on the piston toward the crank axis, N.

    Raises:
        CranktopoError: the engine has no gas table.
    """
    if engine.gas is None:
        raise invalid("engine.gas", None, "must be given for a gas force")
    return (pressure_MPa - engine.gas.ambient_pressure_MPa) * math.pi / 4 * engine.bore_mm**2
