"""Ranges of speed that the permitted shear stress bars: those that the engine runs in, and with a misfire."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from cranktopo.design.schema import Scene


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


def misfire_ranges(of_each: Iterable[MisfireRange]) -> tuple[MisfireRange, ...]:
    """Return the ranges of single misfires from the lowest speed on, those that overlap as one."""
    found: list[MisfireRange] = []
    for one in sorted(of_each, key=lambda one: (one.low_rpm, one.cylinders)):
        if found and one.low_rpm <= found[-1].high_rpm:
            found[-1] = found[-1].joined(one)
        else:
            found.append(one)
    return tuple(found)


def runs_barred(scene: Scene, barred_rpm: Iterable[tuple[float, float]]) -> str:
    """Return in words which of the engine's speeds lies in a barred range; empty where none does."""
    engine, shaft = scene.engine, scene.shaft
    if engine is None or shaft is None:
        return ""
    ranges, speeds = tuple(barred_rpm), {"speed": engine.speed_rpm, "overspeed": engine.overspeed_rpm}
    found = [
        f"the engine's {name} of {rpm:g} rpm lies in the barred range from {low:.0f} to {high:.0f} rpm"
        for name, rpm in speeds.items()
        for low, high in ranges
        if rpm is not None and low <= rpm <= high
    ]
    if not found:
        return ""
    permitted = f"shaft.permitted_shear_MPa = {shaft.permitted_shear_MPa:g}"
    return f"{' and '.join(found)}: nominal shear stress above {permitted}"
