"""Loads of a design at one or several speeds, and the files of their curves."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from cranktopo.base.errors import invalid
from cranktopo.base.files import as_path, replacing
from cranktopo.base.notes import note
from cranktopo.design.assumed import LOADS, THROW, VIBRATION, Assumption, assumptions
from cranktopo.design.clearance import clearance_text, clearances_mm
from cranktopo.design.misfire import all_firing, misfire, misfire_words
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import analyse, at_speed
from cranktopo.engine.balance.crank import crank_mass
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.performance import mean_pressure_MPa, power_kW, pressure_warnings, pressure_words
from cranktopo.engine.plan.effect import PhysicsPlan
from cranktopo.engine.plan.planning import plan
from cranktopo.engine.rated_power import rated_power
from cranktopo.engine.states import extreme_states, load_cases
from cranktopo.tasks.loads.plot import plot_loads
from cranktopo.tasks.loads.result import (
    Loads,
    SeriesDifference,
    WebClearance,
    balance_of,
    curve_columns,
    engine_torque_of,
    extremes_of,
    piston_of,
    state_of,
)


def loads_at_speeds(scene: DesignLike, speeds_rpm: Sequence[float] | None = None) -> tuple[Loads, ...]:
    """Return the loads of a scene at each speed, by default at its own alone.

    Curves and extremes carry every mass; the load cases carry the effects that the plan has on. Where
    cylinders do not fire, the engine's torque and power are without them; forces of one throw and load cases
    are those of one that fires.

    Raises:
        CranktopoError: gas data that cannot be used.
    """
    scene = as_scene(scene)
    assumed = assumptions(scene, (THROW, LOADS, VIBRATION))
    pressure = pressure_words(scene, speeds_rpm or ())
    found = (_loads(at, plan(all_firing(at)), assumed) for at in _at_speeds(scene, speeds_rpm))
    return tuple(one.model_copy(update={"pressure": pressure}) for one in found)


def _loads(scene: Scene, effects: PhysicsPlan, assumed: tuple[Assumption, ...]) -> Loads:
    engine, analysis, radius = scene.engine, analyse(scene) if scene.engine else None, scene.throw.radius_mm
    cycle = analysis.cycle if analysis else None
    work, rated = cycle.indicated_work_J if cycle else 0.0, rated_power(scene)
    return Loads(
        design=scene.name,
        speed_rpm=engine.speed_rpm if engine else None,
        cycle_deg=engine.cycle_deg if engine else None,
        rods_per_pin=engine.rods_per_pin if engine else None,
        points=len(cycle.forces.angle_deg) if cycle else 0,
        pressure_source=cycle.pressure.source if cycle else None,
        extremes=extremes_of(analysis),
        engine_torque_Nm=engine_torque_of(cycle),
        indicated_work_per_cylinder_J=work if cycle else None,
        indicated_mean_pressure_MPa=mean_pressure_MPa(work, engine, radius) if cycle and engine else None,
        indicated_power_kW=power_kW(cycle.mean_work_J, engine) if cycle and engine else None,
        rated_power=rated.words if rated else None,
        misfire=misfire(scene) or None,
        silent=misfire_words(scene),
        piston=piston_of(analysis) if analysis else None,
        series_difference_percent=SeriesDifference(**cycle.series_difference_percent) if cycle else None,
        balance=balance_of(throw_balance(scene)),
        crank=crank_mass(scene),
        clearance=WebClearance(room_mm=clearances_mm(scene), told=clearance_text(scene)),
        load_cases=load_cases(scene, effects.enabled),
        extreme_states=tuple(state_of(state) for state in extreme_states(scene, effects.enabled)),
        effects=effects.effects,
        warnings=(*pressure_warnings(scene), *(rated.warnings if rated else ())),
        assumed=assumed,
    )


def write_load_curves(scene: DesignLike, path: Path | str, speeds_rpm: Sequence[float] | None = None) -> None:
    """Write all curves over the cycle as CSV, the speeds one below the other.

    Raises:
        CranktopoError: no gas data, or the file cannot be written.
    """
    path = as_path(path)
    scene = as_scene(scene)
    found = [analyse(at) for at in _at_speeds(scene, speeds_rpm)]
    tables = [curve_columns(analysis) for analysis in found]
    if not tables[0]:
        raise invalid("engine.gas", None, "must be given for curves over the cycle")
    values = np.concatenate([np.column_stack(list(table.values())) for table in tables])
    with replacing(path) as temporary:
        np.savetxt(temporary, values, fmt="%.8g", delimiter=",", header=",".join(tables[0]), comments="")
    places = sorted({analysis.cycle.place for analysis in found if analysis.cycle and analysis.cycle.place})
    if places:
        note(
            f"{path}: forces without a place in their name are those of {' or '.join(places)}, where the "
            "force on the web is largest; those of every web stand beside them"
        )


def plot_load_curves(scene: DesignLike, path: Path | str, speed_rpm: float | None = None) -> None:
    """Write the plot of the loads over the cycle (.png, .svg or .pdf).

    Raises:
        CranktopoError: no gas data, another ending, or the file cannot be written.
    """
    path = as_path(path)
    scene = as_scene(scene)
    (at,) = _at_speeds(scene, None if speed_rpm is None else [speed_rpm])
    analysis = analyse(at)
    plot_loads(analysis, f"{scene.name}, {analysis.engine.speed_rpm:g} rpm", path)


def _at_speeds(scene: Scene, speeds_rpm: Sequence[float] | None) -> list[Scene]:
    return [scene] if speeds_rpm is None else [at_speed(scene, rpm) for rpm in speeds_rpm]
