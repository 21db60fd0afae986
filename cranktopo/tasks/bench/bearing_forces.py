"""Forces on a main bearing and on a crankpin over the cycle, for a polar plot that follows a drag."""

from __future__ import annotations

from typing import Any

import numpy as np

from cranktopo.base.arrays import Complex
from cranktopo.engine.analysis import engine_of
from cranktopo.engine.balance.whole_engine import rod_force
from cranktopo.tasks.bench.engine_loads import EngineLoads

_POINTS = 144


def largest_bearing_force_N(loads: EngineLoads) -> float:
    """Return the largest force on a main bearing; raises CranktopoError without an engine that turns."""
    return loads.bearings.largest(loads.bearings.most_loaded)[0]


def polars(loads: EngineLoads) -> list[dict[str, Any]]:
    """Return the force on the most loaded main bearing, and that of one rod on its pin, over the cycle.

    Points are kN: of the bearing across the engine's plane of symmetry and along it, of the pin across its
    throw and along it.
    """
    if not loads.turns:
        return []
    found, (_, rod_N, _) = loads.bearings, rod_force(loads.scene, engine_of(loads.scene))
    most = found.most_loaded
    return [
        {"name": f"main bearing {most + 1}", "points": _points(found.load_N[most])},
        {"name": "crankpin, along its throw", "points": _points(rod_N)},
    ]


def _points(load_N: Complex) -> list[list[float]]:
    thinned = np.arange(0, len(load_N), max(1, len(load_N) // _POINTS))
    pick = load_N[np.union1d(thinned, np.abs(load_N).argmax())] / 1e3  # the largest is told beside it
    return np.round(np.column_stack([pick.imag, pick.real]), 3).tolist()
