"""Plots that follow the design: loads over the cycle, free forces by order, torque of the vibrating shaft."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import Cycle
from cranktopo.engine.balance.free_forces import free_forces
from cranktopo.engine.vibration.shaft_chain import estimated_chain
from cranktopo.engine.vibration.torque_harmonics import torque_harmonics
from cranktopo.engine.vibration.vibrating_shaft import vibrating_shaft
from cranktopo.tasks.bench.engine_loads import EngineLoads

_POINTS, _SPEEDS, _MODES = 180, 60, 3
_MOST_ORDER = 4
"""Free forces of higher orders are thousandths of the first."""
Plot = dict[str, Any]


def live_plots(loads: EngineLoads) -> list[Plot]:
    """Return cylinder pressure, MPa, and torques, N m, over the cycle, free forces and moments by order.

    Nothing without an engine that turns; only the forces where only peaks of the pressure are known.
    """
    if not loads.turns:
        return []
    cycle = loads.analysis.cycle
    return [*([_pressure(cycle), _torque(cycle)] if cycle else []), *_balance(loads)]


def _balance(loads: EngineLoads) -> list[Plot]:
    free = [one for one in free_forces(loads.masses) if one.order <= _MOST_ORDER]
    return [
        _bars("Free forces", "N", [(f"order {one.order}", one.force.largest) for one in free]),
        _bars("Free moments", "N m", [(f"order {one.order}", one.moment.largest) for one in free]),
    ]


def line_plots(loads: EngineLoads) -> list[Plot]:
    """Return the disks of the shaft line, kg m2, and springs between them, kN m/rad, from the free end."""
    if loads.scene.shaft is None or loads.scene.engine is None:
        return []
    found = estimated_chain(loads.scene)
    springs = [stiffness / 1e3 for stiffness in found.chain.stiffness_Nm_per_rad]
    return [
        _bars("Disks of the shaft line", "kg m2", zip(found.names, found.chain.inertia_kg_m2, strict=True)),
        _bars("Stiffness between the disks", "kN m/rad", zip(found.sections, springs, strict=True)),
    ]


def vibration_plots(scene: Scene) -> list[Plot]:
    """Return the torque that swings most in the crankshaft over speed, N m, and the Campbell diagram, Hz.

    Nothing without a shaft line, or where no pressure is known.
    """
    harmonics = torque_harmonics(scene) if scene.shaft is not None else None
    if harmonics is None:
        return []
    shaft = vibrating_shaft(scene, estimated_chain(scene), harmonics)
    low, high = shaft.range_rpm
    near = [one.speed_rpm for one in shaft.critical if one.major and low <= one.speed_rpm <= high]
    found = shaft.at(np.union1d(np.linspace(low, high, _SPEEDS), np.array(near)))
    section = found.worst.section
    torque = [_curve(found.shaft.sections[section], found.speeds_rpm, found.torque_amplitude_Nm[:, section])]
    if permitted_MPa := scene.shaft and scene.shaft.permitted_shear_MPa:
        torque.append(_level("permitted", shaft.range_rpm, permitted_MPa / found.shaft.shear_MPa(1.0)))
    frequencies = [mode.frequency_Hz for mode in shaft.modes[:_MODES]]
    orders = sorted({one.order for one in shaft.critical if one.major})
    return [
        _lines("Torque amplitude over speed", "N m", "speed, rpm", torque),
        _lines("Campbell diagram", "Hz", "speed, rpm", _campbell(shaft.range_rpm, frequencies, orders)),
    ]


def _campbell(
    range_rpm: tuple[float, float], frequencies: Sequence[float], orders: Sequence[float]
) -> list[dict[str, Any]]:
    """Return natural frequencies, and major orders as far as they meet these."""
    low, high = range_rpm
    top = 1.1 * max(frequencies)
    modes = [_level(f"{hz:.4g} Hz", range_rpm, hz) for hz in frequencies]
    met = [(order, min(high, 60 * top / order)) for order in orders if order * low / 60 < top]
    return modes + [
        _curve(f"order {n:g}", np.array([low, end]), n / 60 * np.array([low, end])) for n, end in met
    ]


def _level(name: str, ends: tuple[float, float], value: float) -> dict[str, Any]:
    return _curve(name, np.array(ends), np.full(2, value))


def _pressure(cycle: Cycle) -> Plot:
    curve = cycle.pressure
    pressure = _curve("cylinder", curve.angle_deg, curve.pressure_MPa)
    return _lines("Cylinder pressure", "MPa", "crank angle, deg", [pressure])


def _torque(cycle: Cycle) -> Plot:
    """Return the torque of the engine, and that of the section where it swings most."""
    torque, swing = cycle.torque, np.ptp(cycle.torque.sections_Nm, axis=1)
    most = int(swing.argmax())
    curves = [_curve("engine", torque.angle_deg, torque.engine_Nm)]
    curves.append(_curve(torque.section_names[most], torque.angle_deg, torque.sections_Nm[most]))
    return _lines("Torque", "N m", "crank angle, deg", curves)


def _lines(name: str, unit: str, across: str, curves: list[dict[str, Any]]) -> Plot:
    return {"name": name, "unit": unit, "across": across, "curves": curves}


def _bars(name: str, unit: str, bars: Iterable[tuple[str, float]]) -> Plot:
    return {"name": name, "unit": unit, "bars": [{"name": n, "value": float(f"{v:.6g}")} for n, v in bars]}


def _curve(name: str, x: Array, y: Array) -> dict[str, Any]:
    """Return a curve with fewer points, its ends and extremes among them."""
    kept = np.linspace(0, len(x) - 1, min(len(x), _POINTS)).round().astype(int)
    kept = np.union1d(kept, [int(y.argmax()), int(y.argmin())])
    return {"name": name, "points": np.round(np.column_stack([x[kept], y[kept]]), 4).tolist()}
