"""Loads of a design at one or several speeds, and the files of their curves."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cranktopo.base.errors import invalid
from cranktopo.base.files import replacing
from cranktopo.design.assumed import LOADS, THROW, VIBRATION, assumed_json, assumptions
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import analyse, at_speed
from cranktopo.engine.plan.planning import plan
from cranktopo.tasks.loads.plot import plot_loads
from cranktopo.tasks.loads.result import curve_columns, loads_json


def loads_at_speeds(scene: Scene, speeds_rpm: Sequence[float] | None = None) -> list[dict[str, Any]]:
    """One object of `loads --json` per speed; by default that of the scene's own speed."""
    found = []
    for at in _at_speeds(scene, speeds_rpm):
        effects = plan(at)
        assumed = assumed_json(assumptions(scene, (THROW, LOADS, VIBRATION)))
        found.append({**loads_json(at, effects.enabled), "effects": effects.as_json(), "assumed": assumed})
    return found


def write_load_curves(scene: Scene, path: Path, speeds_rpm: Sequence[float] | None = None) -> None:
    """Write all curves over the cycle as CSV, the speeds one below the other.

    Raises:
        CranktopoError: no gas data, or the file cannot be written.
    """
    tables = [curve_columns(analyse(at)) for at in _at_speeds(scene, speeds_rpm)]
    if not tables[0]:
        raise invalid("engine.gas", None, "must be given for curves over the cycle")
    values = np.concatenate([np.column_stack(list(table.values())) for table in tables])
    with replacing(path) as temporary:
        np.savetxt(temporary, values, fmt="%.8g", delimiter=",", header=",".join(tables[0]), comments="")


def plot_load_curves(scene: Scene, path: Path, speed_rpm: float | None = None) -> None:
    """Write the plot of the loads over the cycle (.png, .svg or .pdf).

    Raises:
        CranktopoError: no gas data, another ending, or the file cannot be written.
    """
    (at,) = _at_speeds(scene, None if speed_rpm is None else [speed_rpm])
    analysis = analyse(at)
    plot_loads(analysis, f"{scene.name}, {analysis.engine.speed_rpm:g} rpm", path)


def _at_speeds(scene: Scene, speeds_rpm: Sequence[float] | None) -> list[Scene]:
    return [scene] if speeds_rpm is None else [at_speed(scene, rpm) for rpm in speeds_rpm]
