"""The web family of the re-model: parameters of outline, features and free dimensions, and their scene.

The free dimensions of the throw come after the parameters of the web.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.free_dimensions import (
    DIMENSIONS,
    DimensionName,
    free_range_mm,
    journal_of,
    own_dimension_mm,
    with_dimensions,
)
from cranktopo.design.schema import Scene
from cranktopo.throw.feature import least_shoulder_mm
from cranktopo.throw.fitted import CLEAR_MM, JOURNALS, LEAST_MM, FittedFeature, Frame, Named, Rule, wall_rule
from cranktopo.throw.journal import ASPECT
from cranktopo.throw.manufacturing_limits import ManufacturingLimits
from cranktopo.throw.profile import Flank, flank_through, largest_half_width_mm

DECIMALS = 2
"""Of the dimensions in a scene, mm and degrees; the constraints keep as much clear."""


@dataclass(frozen=True)
class Layout:
    """Parameters that a web of the family has.

    Attributes:
        stations: points of the profile, both round ends included.
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
        yield part, part.named(own)


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
    """Return lower and upper bounds of the web's parameters, (n,) each, mm or degrees."""
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
    found = {key: getattr(scene.web, key) for key in scene.web.single_keys}
    return {key: one.model_dump(exclude_none=True) for key, one in found.items() if one is not None}


def surroundings_of(flank: Flank) -> Frame:
    """Return what the features of an outline refer to."""
    return float(flank.points_mm[0, 1]), float(flank.points_mm[-1, 1]), largest_half_width_mm(flank)


def _rounded(table: Any) -> Any:
    if isinstance(table, dict):
        return {key: _rounded(value) for key, value in table.items()}
    if isinstance(table, list):
        return [_rounded(value) for value in table]
    return round(float(table), DECIMALS) + 0.0 if isinstance(table, float) else table


_LEAST_BORE, _FIRST_BORE = 0.05, 0.3
"""Over the journal's diameter: the least bore, as one that is there does not close; the first of a solid
journal."""


def free_dimensions(scene: Scene) -> tuple[DimensionName, ...]:
    """Return the dimensions that `[shape.free]` gives a range."""
    return tuple(name for name in DIMENSIONS if free_range_mm(scene, name))


def scene_at(scene: Scene, layout: Layout, values: Array) -> Scene:
    """Return the scene with the dimensions of a parameter vector, not checked; web and pitch stay.

    Without free dimensions it is the scene itself.
    """
    return with_dimensions(scene, dict(zip(layout.dimensions, layout.sizes(values), strict=True)))


def with_free(
    layout: Layout,
    values: Array,
    scene: Scene,
    names: tuple[DimensionName, ...],
    begun: Mapping[DimensionName, float] | None = None,
) -> tuple[Layout, Array]:
    """Return the same web with further free dimensions, which start as they are or were begun, mm.

    A solid journal gets a bore.
    """
    new = tuple(name for name in names if name not in layout.dimensions)
    free = replace(layout, dimensions=(*layout.dimensions, *new))
    starts = [_start(scene, name, (begun or {}).get(name)) for name in new]
    return free, np.concatenate([values, starts])


def with_part(layout: Layout, values: Array, part: FittedFeature, guess: Array) -> tuple[Layout, Array]:
    """Return the same web with one feature more."""
    web = values[: len(values) - len(layout.dimensions)]
    more = replace(layout, parts=(*layout.parts, part))
    return more, np.concatenate([web, guess, layout.sizes(values)])


def rounded_dimensions(scene: Scene, layout: Layout, values: Array) -> Array:
    """Return the parameters with the dimensions of the throw rounded to 0.01 mm, within their ranges."""
    result = np.array(values, dtype=np.float64)
    for k, name in enumerate(layout.dimensions, len(values) - len(layout.dimensions)):
        low, high = free_range_mm(scene, name) or (-np.inf, np.inf)
        result[k] = np.clip(round(float(values[k]), DECIMALS), low, high)
    return result


def all_bounds(layout: Layout, scene: Scene, limits: ManufacturingLimits) -> tuple[Array, Array]:
    """Return lower and upper bounds of all parameters, (n,) each; those of features for the thickest web."""
    low, high = bounds(layout, _end_of_thickness(scene, layout, 1), limits)
    sizes = np.array([_range(scene, name) for name in layout.dimensions]).reshape(-1, 2)
    return np.concatenate([low, sizes[:, 0]]), np.concatenate([high, sizes[:, 1]])


def size_rules(layout: Layout, values: Array, scene: Scene, limits: ManufacturingLimits) -> list[Rule]:
    """Return rules on the dimensions of the throw, mm, kept where <= 0: walls of bores, feature depths."""
    sized, found = scene_at(scene, layout, values), list[Rule]()
    if any(name.endswith(("bore", "fillet", "axial")) for name in layout.dimensions):
        found += _bore_rules(sized, limits.min_wall_mm)
    if any("fillet" in name for name in layout.dimensions):
        found += _ellipse_rules(sized)
    if "web_thickness" in layout.dimensions:
        ends = (_end_of_thickness(scene, layout, end) for end in (0, 1))
        most, thinnest, thickest = (bounds(layout, of, limits)[1] for of in (sized, *ends))
        # The same rules at every thickness, its ends included: their slopes are differences.
        for k in np.flatnonzero(thinnest < thickest):
            found.append((f"room for {layout.names[k]} in the thickness of the web", values[k] - most[k]))
    return found


def _bore_rules(scene: Scene, wall_mm: float) -> Iterator[Rule]:
    """Yield the walls in each journal, between both bores, and from a bore to the other one's fillet."""
    (main, _), (pin, throw) = journals = scene.throw.journals
    shoulder, wall = least_shoulder_mm(scene.throw) + CLEAR_MM, wall_mm + CLEAR_MM
    for (journal, _), (other, _), name in zip(journals, journals[::-1], JOURNALS, strict=True):
        bore = journal.bore_radius_mm
        if bore:
            yield wall_rule(f"of the bored {name}", wall_mm), bore + wall - journal.radius_mm
            away = bore + other.clear_radius_mm + shoulder - throw
            yield f"the bore of the {name} stays clear of the other journal's fillet", away
    if main.bore_radius_mm and pin.bore_radius_mm:
        both = main.bore_radius_mm + pin.bore_radius_mm + wall - throw
        yield wall_rule("between both bores", wall_mm), both


def _ellipse_rules(scene: Scene) -> Iterator[Rule]:
    """Yield the rules that keep the ends of an elliptical fillet from nearly being a sharp edge."""
    for (journal, _), name in zip(scene.throw.journals, JOURNALS, strict=True):
        fillet, (low, high) = journal.fillet, ASPECT
        if journal.fillet_axial_mm is not None:
            shape = f"shape of the ellipse at the {name}"
            yield shape, low * fillet.radial_mm - fillet.axial_mm + CLEAR_MM
            yield shape, fillet.axial_mm - high * fillet.radial_mm + CLEAR_MM


def _end_of_thickness(scene: Scene, layout: Layout, end: int) -> Scene:
    """Return the scene with its least (0) or greatest (1) thickness; as it is where that is not free."""
    found = free_range_mm(scene, "web_thickness") if "web_thickness" in layout.dimensions else None
    return with_dimensions(scene, {"web_thickness": found[end]} if found else {})


def _range(scene: Scene, name: DimensionName) -> tuple[float, float]:
    found = free_range_mm(scene, name)
    assert found is not None
    if not name.endswith("bore"):
        return found
    return max(found[0], _LEAST_BORE * journal_of(scene, name).outer_diameter_mm), found[1]


def _start(scene: Scene, name: DimensionName, begun: float | None) -> float:
    """Return the dimension as it is; of a solid journal a first bore."""
    own = begun or own_dimension_mm(scene, name)
    first = own or _FIRST_BORE * journal_of(scene, name).outer_diameter_mm
    return float(np.clip(first, *_range(scene, name)))
