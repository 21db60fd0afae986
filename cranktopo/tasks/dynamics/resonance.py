"""Speeds at which orders of the forces meet modes of the shaft that vibrates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import engine_of
from cranktopo.numerics.tetrahedra.rigid_motions import RZ
from cranktopo.numerics.turning_body import modes_at_rest
from cranktopo.tasks.modes.campbell import crossings, over_speed
from cranktopo.tasks.modes.kinds import energy_shares, kind_of
from cranktopo.tasks.modes.reduced_throw import ReducedThrow
from cranktopo.tasks.modes.shaft_model import ShaftModel, shaft_model
from cranktopo.tasks.shaft.assembly import Bearings

_MODES, _HARMONICS = 12, 48
"""That are looked at: a short shaft meets high orders of the gas."""
_SPEEDS = 9
"""Of the modes between which their frequencies are straight lines."""


@dataclass(frozen=True)
class OrderCrossing:
    """A speed at which an order meets a mode, by its number from the slowest."""

    speed_rpm: float
    order: float
    mode: int
    frequency_Hz: float
    kind: str


def crossings_of(
    throws: Sequence[ReducedThrow],
    scene: Scene,
    bearings: Bearings,
    spring_N_per_mm: float,
    range_rpm: tuple[float, float],
) -> list[OrderCrossing]:
    """Return where orders meet the first modes of a shaft between two speeds, the slowest first.

    Its last section turns evenly unless it drives something.
    """
    model = shaft_model(throws, scene, bearings, spring_N_per_mm)
    if scene.shaft is None or not scene.shaft.has_takeoff:
        model = _turning_evenly(model)
    rest = modes_at_rest(model.body)
    count = min(_MODES, len(rest.frequency_Hz) - rest.rigid)
    speeds = np.linspace(*range_rpm, _SPEEDS)
    moved = over_speed(model.body, rest, count, speeds.tolist())
    orders = np.arange(1.0, _HARMONICS + 1) * 360.0 / engine_of(scene).cycle_deg
    found = []
    for number in range(count):
        kind = kind_of(energy_shares(model.stations, rest.shape[:, rest.rigid + number]))
        found += [
            OrderCrossing(speed, order, number + 1, order * speed / 60, kind)
            for speed, order in crossings(speeds, moved.frequency_Hz[number], orders)
        ]
    return sorted(found, key=lambda one: (one.speed_rpm, one.order))


def _turning_evenly(model: ShaftModel) -> ShaftModel:
    """Return a shaft whose last section is held in rotation."""
    return model.held(np.flatnonzero(model.sections[-1].motion[RZ]).tolist())
