"""Free dimensions of the throw as parameters of a layout, after those of the web: scene, bounds and rules."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

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
from cranktopo.tasks.refit.family import Layout, bounds
from cranktopo.throw.feature import least_shoulder_mm
from cranktopo.throw.fitted import CLEAR_MM, JOURNALS, FittedFeature, Rule, wall_rule
from cranktopo.throw.journal import ASPECT
from cranktopo.throw.manufacturing_limits import ManufacturingLimits

_DECIMALS = 2
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
    """Return the same web with further free dimensions, which start as they are; a solid journal gets a bore.

    Args:
        begun: other starts, mm.
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
        result[k] = np.clip(round(float(values[k]), _DECIMALS), low, high)
    return result


def all_bounds(layout: Layout, scene: Scene, limits: ManufacturingLimits) -> tuple[Array, Array]:
    """Lower and upper bounds of all parameters, (n,) each; those of features for the thickest web."""
    low, high = bounds(layout, _end_of_thickness(scene, layout, 1), limits)
    sizes = np.array([_range(scene, name) for name in layout.dimensions]).reshape(-1, 2)
    return np.concatenate([low, sizes[:, 0]]), np.concatenate([high, sizes[:, 1]])


def size_rules(layout: Layout, values: Array, scene: Scene, limits: ManufacturingLimits) -> list[Rule]:
    """Return rules on the dimensions of the throw, mm, kept where <= 0: walls of bores, depths of features.

    Args:
        scene: the design; its dimensions are those of the values.
    """
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
            away = bore + other.radius_mm + other.fillet_mm + shoulder - throw
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
    """Return the bounds of a dimension, mm."""
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
