"""Speeds at which a shaft is judged, and those that its engine only passes through."""

from __future__ import annotations

import numpy as np

from cranktopo.design.checks.engine import speed_range_rpm
from cranktopo.design.schema import Scene
from cranktopo.design.shaft import passed_through
from cranktopo.engine.analysis import analyse, at_speed, at_worst_speed, engine_of
from cranktopo.engine.vibration.barred import barred_key, ranges_words, too_near_words
from cranktopo.engine.vibration.vibrating_shaft import ranges_to_bar_rpm

_NEAR_RPM = 0.5
_STEPS = 5
"""Even speeds from the lowest to the highest: between two of them the safety of a shaft that does not vibrate
goes evenly, and the worst speed of one that does is added."""


def rated_speeds(scene: Scene, enabled: frozenset[str]) -> tuple[Scene, ...]:
    """Return the scene at the engine's speed, its overspeed and its `slow_speed_rpm`.

    Of a vibrating shaft also at its worst speed. Ascending, each speed once. The pull of the masses grows
    with the square of the speed.
    """
    slow = slow_speed_rpm(scene, enabled)
    found = {*engine_of(scene).own_speeds_rpm, *([] if slow is None else [slow])}
    if "torsional_vibration" in enabled:
        found.add(engine_of(at_worst_speed(scene, enabled)).speed_rpm)
    return tuple(at_speed(scene, rpm) for rpm in sorted(found))


def slow_speed_rpm(scene: Scene, enabled: frozenset[str]) -> float | None:
    """Return the speed below the engine's own at which gas less inertia pushes a web hardest, rpm.

    With one pressure for all speeds it is the lowest of the range that the scene states, by
    `shaft.speed_min_rpm` or `engine.gas.map`: there the masses take least off the gas. With a map it is that
    speed or one of the map. None where the scene states no lower speed, or no gas.
    """
    speeds = _stated_slower_rpm(scene)
    if len(speeds) < 2:
        return next(iter(speeds), None)

    def push_N(rpm: float) -> float:
        cycle = analyse(at_speed(scene, rpm), enabled - {"torsional_vibration"}).cycle
        return cycle.extreme("web_force_N")[0].value if cycle else 0.0

    return max(speeds, key=push_N)


def _stated_slower_rpm(scene: Scene) -> list[float]:
    """Return the lowest speed that the scene states and those of its gas map, below the engine's own."""
    engine = engine_of(scene)
    if engine.gas is None:
        return []
    known = [at.rpm for at in engine.gas.map]
    least = (scene.shaft.speed_min_rpm if scene.shaft else None) or min(known, default=engine.speed_rpm)
    return [rpm for rpm in sorted({least, *known}) if least <= rpm < engine.speed_rpm and runs_at(scene, rpm)]


def speeds_of_range(scene: Scene, enabled: frozenset[str]) -> tuple[Scene, ...]:
    """Return the scene at those speeds and at even ones over its range of speeds, ascending."""
    even = [rpm for rpm in np.linspace(*speed_range_rpm(scene), _STEPS).tolist() if runs_at(scene, rpm)]
    rated = {engine_of(at).speed_rpm for at in rated_speeds(scene, enabled)}
    return tuple(at_speed(scene, rpm) for rpm in sorted({*rated, *even}))


def runs_at(scene: Scene, speed_rpm: float) -> bool:
    """Tell whether the engine runs at a speed: `shaft.barred_rpm` has those that it only passes through."""
    barred = (scene.shaft.barred_rpm if scene.shaft else None) or ()
    return not passed_through(barred, np.array(speed_rpm))


def barred_remarks(scene: Scene, enabled: frozenset[str]) -> list[str]:
    """Return the speeds whose torques are not judged, and those that should be barred and are judged."""
    shaft = scene.shaft
    if shaft is None or "torsional_vibration" not in enabled:
        return []
    barred, above = shaft.barred_rpm or (), ranges_to_bar_rpm(scene, enabled)
    open_ = [ends for ends in above if not any(_holds(known, ends) for known in barred)]
    near = too_near_words(scene, [*barred, *open_])
    found = []
    if barred:
        ranges = ranges_words(barred)
        found.append(
            f"the engine only passes through {ranges} (shaft.barred_rpm): no torque there is judged."
        )
    if open_:
        key = barred_key(scene, open_)
        found.append(
            f"the shear stress is above shaft.permitted_shear_MPa = {shaft.permitted_shear_MPa:g} from "
            f"{ranges_words(open_)}, and these speeds are judged like all others"
            + (f"; an engine that only passes through them has {key}." if key else ".")
        )
    return [*found, *([f"{near}."] if near else [])]


def _holds(known: tuple[float, float], ends: tuple[float, float]) -> bool:
    return known[0] <= ends[0] + _NEAR_RPM and ends[1] - _NEAR_RPM <= known[1]
