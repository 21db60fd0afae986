"""The start of a search: a scene's web as a layout with values, and its free dimensions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.free_dimensions import (
    DIMENSIONS,
    DimensionName,
    free_range_mm,
    is_axial,
    is_of_counterweight,
    journal_of,
    own_dimension_mm,
)
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.simulated import Feature
from cranktopo.tasks.refit.family import free_dimensions, own_values, station_shares
from cranktopo.tasks.refit.parametric_web import reaches_mm
from cranktopo.tasks.refit.read_web import WebRead, read_web
from cranktopo.throw.fitted import FittedFeature
from cranktopo.throw.manufacturing_limits import ManufacturingLimits

STATIONS = 7
_SAME_MM = 1e-6


def outline_start(scene: Scene, limits: ManufacturingLimits, stations: int = STATIONS) -> Array:
    """Return ends and half-widths of the scene's own outline, clear of journals and bores, mm."""
    reaches = reaches_mm(scene, limits)
    low, high = scene.web.y_range_mm(scene.throw.radius_mm)
    low, high = min(low, *(y - r for y, r in reaches)), max(high, *(y + r for y, r in reaches))
    places = low + (high - low) * station_shares(stations)[1:-1]
    wide = scene.web.half_width_mm(scene.throw.radius_mm, places)
    for y, reach in reaches:
        wide = np.maximum(wide, np.sqrt(np.maximum(reach**2 - (places - y) ** 2, 0.0)))
    return np.concatenate([[low, high], wide])


def scene_start(scene: Scene, limits: ManufacturingLimits, begun: Scene | None = None) -> WebRead:
    """Return a web in the family: exactly where it is one of the family, else its outline sampled.

    Of the throw of another scene to begin with only the free dimensions are taken over.
    """
    found = _manufactured(read_web(begun or scene, outline_start(begun or scene, limits)), limits)
    if begun is None:
        return found
    other = {
        name: (own_dimension_mm(begun, name), own_dimension_mm(scene, name))
        for name in _own_dimensions(scene, begun)
        if abs(own_dimension_mm(begun, name) - own_dimension_mm(scene, name)) > _SAME_MM
    }
    free = {name: there for name, (there, _) in other.items() if free_range_mm(scene, name)}
    lost = [
        f"{name} = {there:g} mm, {own:g} mm in the design"
        for name, (there, own) in other.items()
        if name not in free
    ]
    return replace(found, left_out=(*found.left_out, *lost), sizes=free)


def _manufactured(web_read: WebRead, limits: ManufacturingLimits) -> WebRead:
    """Return a web with draft and corners of a workshop, without what cannot open its way."""
    stations, left_out = web_read.layout.stations, list(web_read.left_out)
    parts, values = list[FittedFeature](), [web_read.values[:stations]]
    for part, own in own_values(web_read.layout.parts, web_read.values[stations:]):
        manufactured = part.manufactured(limits)
        if manufactured is None:
            left_out.append(f"{part.title}, as the process opens from the {limits.workshop.opens} only")
            continue
        parts.append(manufactured)
        values.append(own)
    layout = replace(web_read.layout, parts=tuple(parts))
    return replace(web_read, layout=layout, values=np.concatenate(values), left_out=tuple(left_out))


def _own_dimensions(scene: Scene, begun: Scene) -> Iterator[DimensionName]:
    """Yield dimensions that may differ alone: the axial semi-axis of a round fillet follows its radius."""
    for name in DIMENSIONS:
        if is_of_counterweight(name) and None in (scene.web.counterweight, begun.web.counterweight):
            continue
        own = is_axial(name) and not all(journal_of(of, name).fillet.round for of in (scene, begun))
        if own or not is_axial(name) or free_range_mm(scene, name):
            yield name


def free_bores(scene: Scene) -> tuple[DimensionName, ...]:
    """Return bores that `[shape.free]` gives a range."""
    return tuple(name for name in free_dimensions(scene) if name.endswith("bore"))


def first_on_cells(scene: Scene, begun: Mapping[DimensionName, float]) -> tuple[DimensionName, ...]:
    """Return the free dimensions to begin with that cells know: bores and those of the counterweight.

    The bore of a solid journal is tried as a feature is. `begun` has those that are not the scene's.
    """
    there = (name for name in free_bores(scene) if begun.get(name, own_dimension_mm(scene, name)))
    return (*there, *_of_counterweight(scene))


def not_on_cells(scene: Scene) -> tuple[DimensionName, ...]:
    """Return the free dimensions that cells do not know: fillets, and the thickness of their grid."""
    of_elements = (*free_bores(scene), *_of_counterweight(scene))
    return tuple(name for name in free_dimensions(scene) if name not in of_elements)


def _of_counterweight(scene: Scene) -> tuple[DimensionName, ...]:
    return tuple(name for name in free_dimensions(scene) if is_of_counterweight(name))


def kept_features(scene: Scene) -> tuple[Feature, ...]:
    """Return the features that the evaluation keeps, whatever the plan says: fillets, and free bores."""
    return ("bores", "fillets") if free_bores(scene) else ("fillets",)
