"""Throws far smaller or larger than usual are fitted at a usual size, and the web is scaled back.

Cells, spreads and least sizes of the fit are millimetres that suit journals of 42 to 84 mm. A fit is a matter
of shape alone, so any other throw is brought to that size first.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from cranktopo.design.halves import usual_scale
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.residual_regions import ResidualRegion
from cranktopo.throw.manufacturing_limits import ManufacturingLimits

_DIGITS = 6


def usual_limits(scene: Scene, **given: float | int | None) -> ManufacturingLimits:
    """Return manufacturing limits of a throw: those given, and the usual ones in proportion to it."""
    usual = scaled_limits(ManufacturingLimits(), 1 / usual_scale(scene))
    kept: dict[str, Any] = {key: value for key, value in given.items() if value is not None}
    return replace(usual, **kept)


def scaled_limits(limits: ManufacturingLimits, factor: float) -> ManufacturingLimits:
    """Return the limits with their lengths multiplied."""
    return ManufacturingLimits(**scaled_lengths(vars(limits), factor))


def scaled_throw(scene: Scene, factor: float) -> Scene:
    """Return the throw, web and material of a scene, all lengths multiplied; the rest is left out."""
    data = scene.model_dump(mode="json", include={"name", "throw", "web", "material"}, exclude_none=True)
    return scene_from_dict(scaled_lengths(data, factor), f"{scene.name}, scaled")


def scaled_region(region: ResidualRegion, factor: float) -> ResidualRegion:
    """Return a region with its place and volume multiplied accordingly."""
    lengths = scaled_lengths(vars(region), factor)
    return ResidualRegion(**{**lengths, "volume_mm3": region.volume_mm3 * factor**3})


def scaled_lengths(data: Any, factor: float, key: str = "") -> Any:
    """Return plain data with every value under a key that ends with `_mm` multiplied, kept to six digits."""
    if isinstance(data, dict):
        return {name: scaled_lengths(value, factor, name) for name, value in data.items()}
    if isinstance(data, (list, tuple)):
        return type(data)(scaled_lengths(value, factor, key) for value in data)
    if factor != 1 and isinstance(data, float) and key.endswith("_mm"):
        return float(f"{data * factor:.{_DIGITS}g}")
    return data
