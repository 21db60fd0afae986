"""The cylinder pressure that acts over a range of speeds, in words."""

from __future__ import annotations

from collections.abc import Iterable

from cranktopo.design.schema import Scene
from cranktopo.engine.gas import mapped_curves


def pressure_words(scene: Scene, speeds_rpm: Iterable[float]) -> str:
    """Return what pressure acts at some speeds: one for all, or those of a map with their sources.

    Empty without gas, and where one pressure acts at the engine's own speed alone.
    """
    engine, speeds = scene.engine, tuple(speeds_rpm)
    if engine is None or engine.gas is None or not speeds:
        return ""
    if not engine.gas.map:
        if all(rpm == engine.speed_rpm for rpm in speeds):
            return ""
        return (
            f"The pressure is that of {engine.speed_rpm:.0f} rpm at every speed: with less load it is lower; "
            "[[engine.gas.map]] takes the pressure over speed."
        )
    mapped = mapped_curves(scene)
    entries = "; ".join(f"{rpm:g} rpm: {curve.source}" for rpm, curve in mapped)
    first, last = mapped[0][0], mapped[-1][0]
    inside = all(first <= rpm <= last for rpm in speeds)
    beyond = "" if inside else ", beyond its ends that of the nearest entry"
    between = ", in proportion between its entries" if len(mapped) > 1 else ""
    return f"The pressure is that of the map over speed{between}{beyond}: {entries}."
