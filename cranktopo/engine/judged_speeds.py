"""Speeds at which a shaft on all its bearings is judged."""

from __future__ import annotations

import numpy as np

from cranktopo.design.checks.engine import speed_range_rpm
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import at_speed, at_worst_speed, engine_of

_STEPS = 5
"""Even speeds from the lowest to the highest: between two of them the safety of a shaft that does not vibrate
goes evenly, and the worst speed of one that does is added."""


def rated_speeds(scene: Scene, enabled: frozenset[str]) -> tuple[Scene, ...]:
    """Return the scene at the engine's speed and its overspeed, of a vibrating shaft also at its worst speed.

    Ascending, each speed once. The pull of the masses grows with the square of the speed.
    """
    engine = engine_of(scene)
    found = {engine.speed_rpm, engine.overspeed_rpm or engine.speed_rpm}
    if "torsional_vibration" in enabled:
        found.add(engine_of(at_worst_speed(scene, enabled)).speed_rpm)
    return tuple(at_speed(scene, rpm) for rpm in sorted(found))


def speeds_of_range(scene: Scene, enabled: frozenset[str]) -> tuple[Scene, ...]:
    """Return the scene at those speeds and at even ones over its range of speeds, ascending."""
    even = np.linspace(*speed_range_rpm(scene), _STEPS).tolist()
    rated = {engine_of(at).speed_rpm for at in rated_speeds(scene, enabled)}
    return tuple(at_speed(scene, rpm) for rpm in sorted({*rated, *even}))
