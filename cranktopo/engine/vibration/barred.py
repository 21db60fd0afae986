"""Ranges of speed that the permitted shear stress bars: those that the engine runs in, and with a misfire."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.root import root
from cranktopo.design.schema import Scene
from cranktopo.engine.vibration.steady import Vibration

_END_RPM = 0.01
_HIGHEST = 0.8
"""Share of the rated speed above which IACS UR M53 (alternating torsional stresses) allows no barred range
with all cylinders firing."""


@dataclass(frozen=True)
class MisfireRange:
    """A range of speed above the permitted stress where one of these cylinders alone does not fire."""

    low_rpm: float
    high_rpm: float
    cylinders: tuple[int, ...]

    def joined(self, other: MisfireRange) -> MisfireRange:
        """Return the range from the lower begin to the higher end, with the cylinders of both."""
        cylinders = sorted({*self.cylinders, *other.cylinders})
        low, high = min(self.low_rpm, other.low_rpm), max(self.high_rpm, other.high_rpm)
        return MisfireRange(low, high, tuple(cylinders))


def ranges_above(
    response: Vibration, permitted_shear_MPa: float, at: Callable[[Array], Vibration]
) -> tuple[tuple[float, float], ...]:
    """Return the ranges of speed where the crankshaft's nominal shear stress is above the permitted, rpm.

    Args:
        response: over the whole range of speeds.
        at: the response at any speeds, with which the ends are found to 0.01 rpm.
    """
    speeds, over = response.speeds_rpm, response.shear_MPa - permitted_shear_MPa
    above = np.concatenate([[False], over > 0, [False]]).astype(int)
    starts, ends = (np.flatnonzero(np.diff(above) == step) for step in (1, -1))

    def end(inner: int, outer: int) -> float:
        if not 0 <= outer < len(speeds):
            return float(speeds[inner])
        if over[outer] == 0:
            return float(speeds[outer])
        low, high = sorted((float(speeds[inner]), float(speeds[outer])))

        def beyond(rpm: float) -> float:
            return float(at(np.array([rpm])).shear_MPa[0]) - permitted_shear_MPa

        return root(beyond, low, high, _END_RPM)

    both = zip(starts.tolist(), ends.tolist(), strict=True)
    return tuple((end(a, a - 1), end(b - 1, b)) for a, b in both)


def misfire_ranges(of_each: Iterable[MisfireRange]) -> tuple[MisfireRange, ...]:
    """Return the ranges of single misfires from the lowest speed on, those that overlap as one."""
    found: list[MisfireRange] = []
    for one in sorted(of_each, key=lambda one: (one.low_rpm, one.cylinders)):
        if found and one.low_rpm <= found[-1].high_rpm:
            found[-1] = found[-1].joined(one)
        else:
            found.append(one)
    return tuple(found)


def ranges_words(barred_rpm: Iterable[tuple[float, float]], between: str = " and ") -> str:
    """Return ranges in words, rounded to whole speeds outwards."""
    return between.join("{} to {} rpm".format(*_whole(ends)) for ends in barred_rpm)


def _whole(ends_rpm: tuple[float, float]) -> tuple[int, int]:
    """Return the ends of a range as whole speeds outside of it."""
    return math.floor(ends_rpm[0]), math.ceil(ends_rpm[1])


def barred_key(scene: Scene, ranges_rpm: Iterable[tuple[float, float]]) -> str:
    """Return the key of a design that has the engine only pass through these ranges.

    Those that hold a speed of the engine are left out, which cannot be passed through; empty without others.
    """
    own = scene.engine.own_speeds_rpm if scene.engine else ()
    keys = ", ".join(
        str(list(_whole(ends)))
        for ends in ranges_rpm
        if not any(ends[0] <= rpm <= ends[1] or _whole(ends)[0] < rpm < _whole(ends)[1] for rpm in own)
    )
    return f"shaft.barred_rpm = [{keys}]" if keys else ""


def too_near_words(scene: Scene, barred_rpm: Iterable[tuple[float, float]]) -> str:
    """Return which ranges lie too near the engine's speed for the class rule; empty where none does."""
    rated = scene.engine.speed_rpm if scene.engine else math.inf
    found = [one for one in barred_rpm if one[1] > _HIGHEST * rated]
    if not found:
        return ""
    return (
        f"the barred range from {ranges_words(found)} reaches above {_HIGHEST:g} of the engine's speed, "
        "where IACS UR M53 allows none with all cylinders firing"
    )


def runs_barred(scene: Scene, barred_rpm: Iterable[tuple[float, float]]) -> str:
    """Return in words which of the engine's speeds lies in a barred range; empty where none does."""
    engine, shaft = scene.engine, scene.shaft
    if engine is None or shaft is None:
        return ""
    ranges, speeds = tuple(barred_rpm), {"speed": engine.speed_rpm, "overspeed": engine.overspeed_rpm}
    found = [
        f"the engine's {name} of {rpm:g} rpm lies in the barred range from {ranges_words([(low, high)])}"
        for name, rpm in speeds.items()
        for low, high in ranges
        if rpm is not None and low <= rpm <= high
    ]
    if not found:
        return ""
    permitted = f"shaft.permitted_shear_MPa = {shaft.permitted_shear_MPa:g}"
    return f"{' and '.join(found)}: nominal shear stress above {permitted}"
