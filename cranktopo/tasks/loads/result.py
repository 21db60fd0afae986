"""The load analysis as plain data: the JSON object of `loads --json` and the columns of its CSV."""

from __future__ import annotations

from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.clearance import clearance_text, clearances_mm
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import Cycle, LoadAnalysis, analyse
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.cases import load_cases
from cranktopo.engine.states import extreme_states

SCHEMA_VERSION = 1
EXTREMES = (
    "gas_force_N",
    "inertia_force_N",
    "small_end_force_N",
    "rod_force_N",
    "side_force_N",
    "tangential_force_N",
    "radial_force_N",
    "torque_Nm",
    "main_journal_force_N",
    "web_force_N",
    "crankpin_force_N",
)


def loads_json(scene: Scene, enabled: frozenset[str]) -> dict[str, Any]:
    """The loads of a scene at its engine's speed.

    Curves and extremes carry every mass; the load cases carry the effects that are enabled. Values that
    the scene does not tell are null.

    Raises:
        CranktopoError: gas data that cannot be used.
    """
    analysis = analyse(scene) if scene.engine else None
    cycle = analysis.cycle if analysis else None
    return {
        "schema_version": SCHEMA_VERSION,
        "design": scene.name,
        "speed_rpm": scene.engine.speed_rpm if scene.engine else None,
        "cycle_deg": scene.engine.cycle_deg if scene.engine else None,
        "rods_per_pin": scene.engine.rods_per_pin if scene.engine else None,
        "points": len(cycle.forces.angle_deg) if cycle else 0,
        "pressure_source": cycle.pressure.source if cycle else None,
        "extremes": _extremes(analysis),
        "engine_torque_Nm": _engine_torque(cycle),
        "indicated_work_per_cylinder_J": cycle.indicated_work_J if cycle else None,
        "series_difference_percent": cycle.series_difference_percent if cycle else None,
        "balance": throw_balance(scene).as_json(),
        "clearance": {"room_mm": clearances_mm(scene), "told": clearance_text(scene)},
        "load_cases": [case.as_json() for case in load_cases(scene, enabled)],
        "extreme_states": [state.as_json() for state in extreme_states(scene, enabled)],
    }


def curve_columns(analysis: LoadAnalysis) -> dict[str, Array]:
    """All curves of one speed as columns with units in their names."""
    cycle = analysis.cycle
    if cycle is None:
        return {}
    columns = {
        "speed_rpm": np.full_like(cycle.forces.angle_deg, analysis.engine.speed_rpm),
        "angle_deg": cycle.forces.angle_deg,
        "pressure_MPa": cycle.pressure.pressure_MPa,
        **cycle.forces.curves(),
    }
    for number, torque in enumerate(cycle.torque.passed_on_Nm, start=1):
        columns[f"torque_behind_throw_{number}_Nm"] = torque
    return columns


def _extremes(analysis: LoadAnalysis | None) -> dict[str, Any]:
    cycle = analysis.cycle if analysis else None
    nothing = {"value": None, "deg": None}
    result: dict[str, Any] = {name: {"max": dict(nothing), "min": dict(nothing)} for name in EXTREMES}
    if cycle is not None:
        found = cycle.extremes()
        result = {
            name: {"max": found[name][0].as_json(), "min": found[name][1].as_json()} for name in EXTREMES
        }
    elif analysis is not None:
        engine = analysis.engine
        result["gas_force_N"]["max"]["value"] = engine.max_gas_force_N
        result["torque_Nm"]["max"]["value"] = engine.max_torque_Nm
        result["torque_Nm"]["min"]["value"] = engine.min_torque_Nm
    return result


def _engine_torque(cycle: Cycle | None) -> dict[str, float | None]:
    if cycle is None:
        return {"mean": None, "max": None, "max_deg": None, "min": None, "min_deg": None}
    mean, high, low = cycle.engine_torque()
    return {
        "mean": mean,
        "max": high.value,
        "max_deg": high.deg,
        "min": low.value,
        "min_deg": low.deg,
    }
