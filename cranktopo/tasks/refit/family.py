"""The web family of the re-model: an outline and features with parameters, and the scene table they make."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.free_dimensions import DimensionName
from cranktopo.design.schema import Scene
from cranktopo.throw.fitted import LEAST_MM, FittedFeature, Frame, Named
from cranktopo.throw.manufacturing_limits import ManufacturingLimits
from cranktopo.throw.profile import Flank, flank_through, largest_half_width_mm

DECIMALS = 2
"""Of the dimensions in a scene, mm and degrees; the constraints keep as much clear."""


@dataclass(frozen=True)
class Layout:
    """Parameters that a web of the family has.

    Attributes:
        stations: points of the profile, both round ends included.
        parts: its features.
        dimensions: free dimensions of the throw; their values come after those of the features.
    """

    stations: int
    parts: tuple[FittedFeature, ...] = ()
    dimensions: tuple[DimensionName, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters in the order of the vector."""
        outline = ("y_low", "y_high", *(f"half_width_{i}" for i in range(1, self.stations - 1)))
        features = (f"{label}.{name}" for label, part in self._labelled() for name in part.names)
        return (*outline, *features, *self.dimensions)

    def sizes(self, values: Array) -> Array:
        """Return the values of the free dimensions out of a parameter vector, mm."""
        return values[len(values) - len(self.dimensions) :]

    def _labelled(self) -> Iterator[tuple[str, FittedFeature]]:
        """Return each feature with a label of its own: the second box pocket of a face is `box-pin-2`."""
        seen = Counter[str]()
        for part in self.parts:
            seen[part.label] += 1
            yield part.label if seen[part.label] == 1 else f"{part.label}-{seen[part.label]}", part


def parameter_unit(parameter: str) -> str:
    """Return the unit of a parameter by its name: degrees for a draft and an angle, else mm."""
    return "deg" if parameter.endswith(("draft", "angle")) else "mm"


def own_values(parts: tuple[FittedFeature, ...], values: Array) -> Iterator[tuple[FittedFeature, Array]]:
    """Return each feature with its values out of those of all features, mm or degrees."""
    first = 0
    for part in parts:
        count = len(part.names)
        yield part, values[first : first + count]
        first += count


def named_parts(parts: tuple[FittedFeature, ...], values: Array) -> Iterator[tuple[FittedFeature, Named]]:
    """Return each feature with its values by name."""
    for part, own in own_values(parts, values):
        yield part, dict(zip(part.names, own, strict=True))


def station_shares(stations: int) -> Array:
    """Return the places of the stations, 0 to 1: denser toward the ends, as Chebyshev's points."""
    return np.asarray((1 - np.cos(np.pi * np.arange(stations) / (stations - 1))) / 2)


def flank_of(layout: Layout, values: Any) -> Flank:
    """Return the outline of a parameter vector, mm or degrees; those of the features may be missing.

    Analytic in the values, so that a complex step differentiates it.
    """
    n = layout.stations
    low, high = values[0], values[1]
    stations = low + (high - low) * station_shares(n)
    zero = np.zeros(1)
    return flank_through(np.concatenate([zero, values[2:n], zero]), stations, (True, True))


def bounds(layout: Layout, scene: Scene, limits: ManufacturingLimits) -> tuple[Array, Array]:
    """Lower and upper bounds of the web's parameters, (n,) each, mm or degrees."""
    far = 4 * scene.throw.radius_mm
    pairs = [(-far, far)] * 2 + [(LEAST_MM / 2, far)] * (layout.stations - 2)
    pairs += [pair for part in layout.parts for pair in part.bounds(scene, limits)]
    low, high = np.array(pairs).T
    return low, high


def web_of(layout: Layout, values: Array, scene: Scene) -> dict[str, Any]:
    """Return the `[web]` table of a parameter vector, rounded to 0.01 mm, as plain data."""
    web = _rounded(exact_web_of(layout, values, scene))
    return {**web, "thickness_mm": scene.web.thickness_mm, **_unchanged(scene)}


def exact_web_of(layout: Layout, values: Array, scene: Scene) -> dict[str, Any]:
    """Return the `[web]` table of a parameter vector to the last digit, as plain data."""
    flank = flank_of(layout, np.asarray(values, dtype=np.float64))
    frame = surroundings_of(flank)
    features: dict[str, list[dict[str, Any]]] = {key: [] for key in scene.web.feature_keys}
    for part, named in named_parts(layout.parts, values[layout.stations :]):
        features[part.table] += part.tables(named, frame)
    return {
        "thickness_mm": scene.web.thickness_mm,
        "outline": "profile",
        "stations_mm": [float(y) for y in flank.points_mm[:, 1]],
        "half_widths_mm": [float(h) for h in flank.points_mm[:, 0]],
        **features,
        **_unchanged(scene),
    }


def _unchanged(scene: Scene) -> dict[str, Any]:
    """Return the scene's features that no fit to a body changes."""
    found = {key: getattr(scene.web, key) for key in scene.web.single_keys}
    return {key: one.model_dump(exclude_none=True) for key, one in found.items() if one is not None}


def surroundings_of(flank: Flank) -> Frame:
    """Return what the features of an outline refer to."""
    return float(flank.points_mm[0, 1]), float(flank.points_mm[-1, 1]), largest_half_width_mm(flank)


def _rounded(table: Any) -> Any:
    """Return the plain data with every number rounded to 0.01."""
    if isinstance(table, dict):
        return {key: _rounded(value) for key, value in table.items()}
    if isinstance(table, list):
        return [_rounded(value) for value in table]
    return round(float(table), DECIMALS) + 0.0 if isinstance(table, float) else table
